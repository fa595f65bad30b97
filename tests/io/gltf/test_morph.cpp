#include <gtest/gtest.h>

#include "io/gltf/builder.h"
#include "io/gltf/lit_asset.h"

// Morph targets of vertex colours and texture coordinates.
namespace lambake {
namespace {

/// The square with colours, texture coordinates and one target of both, weighted by a half.
struct MorphedSquare : GltfBuilder {
  MorphedSquare() {
    auto& primitive = add_primitive(square());
    primitive["attributes"]["COLOR_0"] =
        add_floats("VEC3", 4, {0, 0.5f, 1, 0, 0.5f, 1, 0, 0.5f, 1, 0, 0.5f, 1});
    primitive["attributes"]["TEXCOORD_0"] = add_floats("VEC2", 4, {0, 0, 1, 0, 0, 1, 1, 1});
    // A target's colours may have opacities though the primitive's have none.
    std::vector<float> offsets;
    for (int i = 0; i < 4; ++i) offsets.insert(offsets.end(), {0.5f, -0.25f, 1, -1});
    primitive["targets"] = {{{"COLOR_0", add_floats("VEC4", 4, offsets)},
                             {"TEXCOORD_0", add_floats("VEC2", 4, std::vector<float>(8, 0.5f))}}};
    json["meshes"][0]["weights"] = {0.5};
  }
  nlohmann::ordered_json& primitive() { return json["meshes"][0]["primitives"][0]; }
};

TEST(GltfMorph, ColoursAndTextureCoordinates_AreThoseOfTheWeights) {
  const Mesh mesh = read_gltf_file(MorphedSquare().write(), {}).scene.mesh;
  ASSERT_EQ(mesh.colors.size(), 4U);
  for (std::size_t v = 0; v < 4; ++v) {
    EXPECT_EQ(mesh.colors[v], (LinearRgb{0.25f, 0.375f, 1})) << v;  // 1.5 is clamped.
    EXPECT_EQ(mesh.texcoords[0][v], glm::vec2(mesh.positions[v]) + 0.25f) << v;
  }
}

TEST(GltfMorph, WeightsOfTheNode_ComeBeforeThoseOfTheMesh) {
  MorphedSquare square;
  square.json["nodes"][0]["weights"] = {0};
  const Mesh mesh = read_gltf_file(square.write(), {}).scene.mesh;
  EXPECT_EQ(mesh.colors[0], (LinearRgb{0, 0.5f, 1}));
  EXPECT_EQ(mesh.texcoords[0][3], glm::vec2(1, 1));
}

TEST(GltfMorph, Opacities_AreThoseOfTheWeights) {
  MorphedSquare square;
  square.primitive()["attributes"]["COLOR_0"] = square.add_floats("VEC4", 4, std::vector<float>(16, 1));
  const Mesh mesh = read_gltf_file(square.write(), {}).scene.mesh;
  ASSERT_EQ(mesh.opacities.size(), 4U);
  EXPECT_EQ(mesh.opacities[2], 0.5f);
}

/// Writes with the light in an attribute.
Glb written(const std::string& path, const std::string& attribute, WrittenColors& told,
            BakeMethod method = BakeMethod::sample) {
  const SceneFile file = read_lit(path);
  const std::string out = temporary_file("out.glb");
  told = write_gltf_file(out, file, bake(file.scene, {.method = method}), {.attribute = attribute});
  return read_glb(out);
}

// A viewer would add the target's colours to the baked ones, which have them already.
TEST(GltfMorph, BakedColours_AreNotMorphedAgain) {
  for (const BakeMethod method : {BakeMethod::sample, BakeMethod::face}) {
    WrittenColors told;
    const Glb glb = written(MorphedSquare().write(), "COLOR_0", told, method);
    ASSERT_EQ(glb.primitive(0, 0)["targets"].size(), 1U);
    const auto& target = glb.primitive(0, 0)["targets"][0];
    EXPECT_FALSE(target.contains("COLOR_0"));
    EXPECT_TRUE(target.contains("TEXCOORD_0"));
    EXPECT_EQ(count_of(told.findings, "morphed_colors_left_out"), 1U);
  }
}

TEST(GltfMorph, TargetOfColoursAlone_StaysATarget) {
  MorphedSquare square;
  square.primitive()["targets"][0].erase("TEXCOORD_0");
  WrittenColors told;
  const Glb glb = written(square.write(), "COLOR_0", told);
  ASSERT_EQ(glb.primitive(0, 0)["targets"].size(), 1U);  // As many as there are weights.
  const auto& target = glb.primitive(0, 0)["targets"][0];
  ASSERT_EQ(target.size(), 1U);  // Without one it is not valid.
  const auto& zeros = glb.json["accessors"][target["POSITION"].get<std::size_t>()];
  EXPECT_FALSE(zeros.contains("bufferView"));
  EXPECT_EQ(zeros["count"], 4);
  EXPECT_NO_THROW(read_gltf_file(temporary_file("out.glb"), {}));
}

TEST(GltfMorph, ColoursBesideALightOfItsOwn_AreKept) {
  WrittenColors told;
  const Glb glb = written(MorphedSquare().write(), "_LIGHT", told);
  EXPECT_TRUE(glb.primitive(0, 0)["targets"][0].contains("COLOR_0"));
  EXPECT_EQ(count_of(told.findings, "morphed_colors_left_out"), 0U);
}

}  // namespace
}  // namespace lambake
