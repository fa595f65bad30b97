#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "io/gltf/builder.h"
#include "io/gltf/files.h"
#include "io/gltf/glb_reader.h"
#include "io/gltf/lit_asset.h"
#include "lambake/bake/bake.h"
#include "lambake/core/bounds.h"
#include "lambake/io/gltf.h"

// Primitives that are written anew, as their vertices are others.
namespace lambake {
namespace {

using nlohmann::ordered_json;

TEST(GltfRewrite, CutMesh_InterpolatesEveryAttributeInTheFilesOwnSpace) {
  for (const char* name : {"gltf/CesiumMilkTruck.glb", "gltf/RiggedSimple.glb", "gltf/AnimatedMorphCube.glb",
                           "gltf/BoxMeshopt.glb", "gltf/PalmTree/PalmTree.gltf", "gltf/Box_Draco.glb"}) {
    SCOPED_TRACE(name);
    const SceneFile file = read_lit(meshes_folder() + name);
    const BakedColors baked = cut_first_triangle(file.scene);
    const std::string path = temporary_file("cut.glb");
    const WrittenColors written = write_gltf_file(path, file, baked, {});
    EXPECT_EQ(count_of(written.findings, "rewritten_primitives"), 1U);
    const Scene again = read_gltf_file(path, {}).scene;
    ASSERT_EQ(again.mesh.n_triangles(), file.scene.mesh.n_triangles() + 1);
    // Triangles of a primitive keep the order that baking gave them: the new one is the primitive's last.
    std::size_t n_found = 0;
    const glm::vec3 cut = baked.mesh->positions.back();
    const glm::uvec3 t = file.scene.mesh.triangles[0];
    const glm::vec3 normal =
        glm::normalize(0.75f * file.scene.mesh.normals[t[0]] + 0.25f * file.scene.mesh.normals[t[1]]);
    const float size = bounds_of(file.scene.mesh.positions).radius();
    for (std::size_t v = 0; v < again.mesh.n_vertices(); ++v) {
      const LinearRgb& c = again.mesh.colors[v];
      if (std::abs(c.r - 0.125f) > 1e-4f || std::abs(c.g - 0.25f) > 1e-4f || std::abs(c.b - 0.5f) > 1e-4f)
        continue;
      ++n_found;
      EXPECT_GT(glm::dot(again.mesh.normals[v], normal), 0.999f);
      EXPECT_LT(glm::distance(again.mesh.positions[v], cut), 1e-5f * size);
    }
    EXPECT_EQ(n_found, 1U);
  }
}

TEST(GltfRewrite, NamesAndExtrasOfAccessors_ComeBackWhereTheyAreWrittenAnew) {
  GltfBuilder builder;
  const ordered_json square = builder.add_primitive(builder.square());
  ordered_json& normals = builder.json["accessors"][square["attributes"]["NORMAL"].get<std::size_t>()];
  normals["name"] = "up", normals["extras"] = {{"by", 7}};
  const SceneFile file = read_lit(builder.write());
  const std::string path = temporary_file("names.glb");
  const WrittenColors written = write_gltf_file(path, file, cut_first_triangle(file.scene), {});
  EXPECT_EQ(count_of(written.findings, "rewritten_primitives"), 1U);
  const Glb glb = read_glb(path);
  const ordered_json& again = glb.json["accessors"][glb.attribute(0, 0, "NORMAL")];
  EXPECT_EQ(again["count"], 5);
  EXPECT_EQ(again["name"], "up");
  EXPECT_EQ(again["extras"], normals["extras"]);
}

/// Σ area × mean vertex colour over the triangles whose material emits nothing.
glm::dvec3 integral(const Mesh& mesh, const std::vector<Material>& materials,
                    const std::vector<LinearRgb>& colors) {
  glm::dvec3 sum(0);
  for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
    const glm::uvec3& t = mesh.triangles[f];
    if (!(materials[mesh.material_of(f)].emission == LinearRgb{0, 0, 0})) continue;
    const glm::dvec3 a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
    const double area = 0.5 * glm::length(glm::cross(b - a, c - a));
    for (int k = 0; k < 3; ++k) {
      const LinearRgb& color = colors[t[k]];
      sum += area / 3 * glm::dvec3(std::min(color.r, 1.0f), std::min(color.g, 1.0f), std::min(color.b, 1.0f));
    }
  }
  return sum;
}

TEST(GltfRewrite, MethodsThatCut_ReadAgain_ShowTheSameSurfaceAndColours) {
  for (const std::string& path :
       {std::string(LAMBAKE_SOURCE_DIR "/meshes/gallery.glb"),
        meshes_folder() + "gltf/PalmTree/PalmTree.gltf", meshes_folder() + "gltf/SimpleSparseAccessor.gltf"})
    for (const BakeMethod method : {BakeMethod::uniform, BakeMethod::adaptive}) {
      SCOPED_TRACE(path);
      const auto result = bake_file(path, {.method = method, .tolerance = 8.0 / 255}, {});
      const Scene again = read_gltf_file(result->path, {}).scene;
      const Mesh& mesh = mesh_of(result->in.scene, result->baked);
      // Unlit primitives stay as they are, uncut.
      const std::vector<Material>& materials = result->in.scene.materials;
      const auto count_lit = [&](const Mesh& of) {
        std::size_t n = 0;
        for (const std::uint32_t material : of.materials) n += materials[material].is_unlit ? 0 : 1;
        return n;
      };
      EXPECT_EQ(count_lit(again.mesh), count_lit(mesh));
      const glm::dvec3 want = integral(mesh, materials, result->baked.colors);
      const glm::dvec3 got = integral(again.mesh, again.materials, again.mesh.colors);
      EXPECT_LT(glm::length(want - got), 1e-4 * glm::length(want));
    }
}

/// Four vertices of a bent square with odd coordinates, and `offset` along x that its node takes back.
std::string bent_square(float offset) {
  GltfBuilder builder;
  nlohmann::ordered_json primitive = builder.square();
  primitive["attributes"]["POSITION"] = builder.add_floats(
      "VEC3", 4,
      {offset + 0.1f, 0.7f, 0, offset + 1.3f, 0.2f, 0.1f, offset, 1.9f, 0.3f, offset + 1.1f, 1.7f, 0});
  primitive["attributes"]["TEXCOORD_0"] =
      builder.add_floats("VEC2", 4, {100.1f, 7.3f, 101.7f, 7.9f, 100.9f, 8.1f, 101.3f, 9.7f});
  builder.add_primitive(primitive);
  builder.json["nodes"][0]["translation"] = {-offset, 0, 0};
  return builder.write("bent_square");
}

TEST(GltfRewrite, CutUponCut_IsRoundedOnceAsTheMeshIs) {
  const auto result = bake_file(bent_square(0), {.method = BakeMethod::uniform, .levels = 4}, {});
  const auto rows = [](const Mesh& mesh) {
    std::set<std::array<float, 5>> set;
    for (std::size_t v = 0; v < mesh.n_vertices(); ++v) {
      const glm::vec3& p = mesh.positions[v];
      const glm::vec2& uv = mesh.texcoords[0][v];
      set.insert({p.x, p.y, p.z, uv.x, uv.y});
    }
    return set;
  };
  const Mesh& mesh = mesh_of(result->in.scene, result->baked);
  EXPECT_EQ(rows(read_gltf_file(result->path, {}).scene.mesh), rows(mesh));
  EXPECT_EQ(rows(mesh).size(), 17U * 17U);
}

TEST(GltfRewrite, NodesThatRoundNothing_LeaveTheCertificateAsItIs) {
  const auto rounding = [](const std::vector<double>& matrix) {
    GltfBuilder builder;
    builder.add_primitive(builder.square());
    builder.json["nodes"][0]["matrix"] = matrix;
    return read_gltf_file(builder.write("placed"), {}).scene.mesh.cut_rounding_of(1);
  };
  EXPECT_EQ(rounding({0, -2, 0, 0, 0, 0, 0.25, 0, 1, 0, 0, 0, 0, 0, 0, 1}), 0);
  EXPECT_GT(rounding({0, -3, 0, 0, 0, 0, 0.25, 0, 1, 0, 0, 0, 0, 0, 0, 1}), 0);
  EXPECT_GT(rounding({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0.5, 1}), 0);
  EXPECT_GT(rounding({1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}), 0);
}

TEST(GltfRewrite, VerticesFarFromTheirNode_AreRoundedThere_AndSoIsTheCertificate) {
  const auto rounding = [](float offset) {
    return read_gltf_file(bent_square(offset), {}).scene.mesh.cut_rounding_of(1);
  };
  EXPECT_EQ(rounding(0), 0);           // The file has world space.
  EXPECT_GE(rounding(1e5f), 0x1p-8f);  // Half the step of float there.
  EXPECT_LE(rounding(1e5f), 0x1p-7f);
  const auto certificate = [](float offset) {
    SceneFile file = read_gltf_file(bent_square(offset), {});
    Light& lamp = file.scene.lights.emplace_back();
    lamp.type = LightType::point;
    lamp.position = {0.6f, 1, 0.5f};
    lamp.intensity = {0.1f, 0.1f, 0.1f};
    const BakedColors baked =
        bake(file.scene, {.method = BakeMethod::adaptive, .output = gltf_output(file, {})});
    EXPECT_EQ(count_of(baked.findings, "triangles_open_by_position") > 0, offset > 0);
    return baked.certificate->is_certified;
  };
  EXPECT_TRUE(certificate(0));
  EXPECT_FALSE(certificate(1e5f));
}

TEST(GltfRewrite, FaceColours_OfCopiesWithTheSameCuts_ShareTheirNewAttributes) {
  const auto result = bake_file(meshes_folder() + "gltf/SpheresScaledInstances/spheres_scaled_instances.gltf",
                                {.method = BakeMethod::face}, {});
  const Glb glb = read_glb(result->path);
  ASSERT_EQ(glb.json["meshes"].size(), 3U);  // One for each node that places it.
  for (std::size_t m = 1; m < 3; ++m) {
    EXPECT_EQ(glb.attribute(0, 0, "POSITION"), glb.attribute(m, 0, "POSITION"));
    EXPECT_EQ(glb.primitive(0, 0)["indices"], glb.primitive(m, 0)["indices"]);
    EXPECT_NE(glb.attribute(0, 0, "COLOR_0"), glb.attribute(m, 0, "COLOR_0"));
  }
}

}  // namespace
}  // namespace lambake
