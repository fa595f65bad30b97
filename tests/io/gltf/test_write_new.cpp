#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "io/gltf/glb_reader.h"
#include "lambake/core/error.h"
#include "lambake/io/gltf.h"
#include "lambake/io/gltf/document.h"
#include "lambake/io/image_file.h"

namespace lambake {
namespace {

/// Two triangles of a unit square facing +z, and one colour per vertex.
struct Square {
  SceneFile file;
  BakedColors baked;

  Square() {
    Mesh& mesh = file.scene.mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0}};
    mesh.normals.assign(4, {0, 0, 1});
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    file.scene.materials.emplace_back();
    baked.colors = {{0, 0.25f, 0.5f}, {1, 1, 1}, {0.125f, 0, 0}, {0.75f, 0.5f, 0.25f}};
  }
  Glb write(const GltfWriteOptions& options = {}) {
    const std::string path = temporary_file("square.glb");
    written = write_gltf_file(path, file, baked, options);
    return read_glb(path);
  }
  WrittenColors written;
};

std::size_t count_of(const Findings& findings, const std::string& code) {
  for (const Finding& finding : findings)
    if (finding.code == code) return finding.count;
  return 0;
}

TEST(NewGltf, OpacitiesOfVertices_AreBlended_UnlessNothingWouldBeSeen) {
  const auto mode_of = [](const Glb& glb) { return glb.json["materials"][0].value("alphaMode", "OPAQUE"); };
  Square square;
  square.file.scene.materials[0].alpha_mode = AlphaMode::blend;
  square.file.scene.mesh.opacities = {1, 1, 1, 1};
  EXPECT_EQ(mode_of(square.write()), "OPAQUE");
  EXPECT_EQ(count_of(square.written.findings, "opacities_blended"), 0U);
  square.file.scene.mesh.opacities = {1, 0.5f, 0, 1};
  const Glb glb = square.write();
  EXPECT_EQ(mode_of(glb), "BLEND");
  EXPECT_EQ(glb.value<std::uint16_t>(glb.attribute(0, 0, "COLOR_0"), 1, 3), 32768);
  EXPECT_EQ(count_of(square.written.findings, "opacities_blended"), 2U);
  EXPECT_EQ(mode_of(square.write({.attribute = "_LIGHT"})), "OPAQUE");
  square.file.scene.mesh.opacities = {0, 0, 0, 0};
  EXPECT_EQ(mode_of(square.write()), "OPAQUE");
  EXPECT_EQ(count_of(square.written.findings, "opacities_not_shown"), 4U);
  square.file.scene.materials[0].alpha_mode = AlphaMode::mask;
  EXPECT_EQ(mode_of(square.write()), "MASK");
  square.file.scene.materials[0].alpha_mode = AlphaMode::opaque;
  square.file.scene.mesh.opacities = {1, 0.5f, 0, 1};
  EXPECT_EQ(mode_of(square.write()), "OPAQUE");
}

TEST(NewGltf, ObjectsOfTheFile_AreNodesWithTheirNames_AndShareMaterials) {
  Square square;
  SceneFile& file = square.file;
  file.scene.materials.resize(2);
  file.scene.materials[1].name = "second";
  file.scene.mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {2, 1, 0}, {3, 2, 0}};
  file.scene.mesh.materials = {0, 1, 1, 1};
  file.scene.mesh.source_faces = {0, 1, 1, 2};  // The face in the middle was a polygon.
  file.face_objects = {1, 1, 0};
  file.object_names = {"lid", "box"};
  const Glb glb = square.write();
  EXPECT_EQ(glb.json["scenes"][0]["nodes"], GltfJson({0, 1}));
  for (const auto& [i, name] : {std::pair{0, "lid"}, {1, "box"}}) {
    EXPECT_EQ(glb.json["nodes"][i], GltfJson({{"name", name}, {"mesh", i}}));
    EXPECT_EQ(glb.json["meshes"][i]["name"], name);
  }
  EXPECT_EQ(glb.json["materials"].size(), 2U);
  ASSERT_EQ(glb.json["meshes"][0]["primitives"].size(), 1U);
  ASSERT_EQ(glb.json["meshes"][1]["primitives"].size(), 2U);
  const auto material = [&](int mesh, int primitive) {
    return glb
        .json["materials"][glb.json["meshes"][mesh]["primitives"][primitive]["material"].get<std::size_t>()]
        .value("name", "");
  };
  EXPECT_EQ(material(0, 0), "second");
  EXPECT_EQ(material(1, 0), "");
  EXPECT_EQ(material(1, 1), "second");
  // The colours went along.
  EXPECT_EQ(glb.value<std::uint16_t>(glb.attribute(0, 0, "COLOR_0"), 0, 2), 32768);
  EXPECT_EQ(glb.value<std::uint16_t>(glb.attribute(0, 0, "COLOR_0"), 1, 0), 8192);
}

TEST(NewGltf, Square_EveryStorage_HoldsTheColoursWithinHalfAStep) {
  const struct {
    ColorStorage storage;
    int component_type;
    double half_step;
  } cases[] = {{ColorStorage::u8, 5121, 0.5 / 255},
               {ColorStorage::u16, 5123, 0.5 / 65535},
               {ColorStorage::f32, 5126, 0}};
  for (const auto& expected : cases) {
    Square square;
    const Glb glb = square.write({.color = expected.storage});
    const std::size_t color = glb.attribute(0, 0, "COLOR_0");
    EXPECT_EQ(glb.json["accessors"][color]["componentType"], expected.component_type);
    EXPECT_EQ(glb.json["accessors"][color].value("normalized", false), expected.half_step > 0);
    for (std::size_t v = 0; v < 4; ++v) {
      const LinearRgb& c = square.baked.colors[v];
      const float channels[] = {c.r, c.g, c.b};
      for (std::size_t k = 0; k < 3; ++k) {
        const double stored =
            expected.storage == ColorStorage::u8    ? glb.value<std::uint8_t>(color, v, k) / 255.0
            : expected.storage == ColorStorage::u16 ? glb.value<std::uint16_t>(color, v, k) / 65535.0
                                                    : static_cast<double>(glb.value<float>(color, v, k));
        EXPECT_NEAR(stored, channels[k], expected.half_step + 1e-7);
      }
    }
    EXPECT_EQ(square.written.clipped_vertices, 0U);
  }
}

TEST(NewGltf, Square_Default_HasBoundsNormalsIndicesAndAnUnlitMaterial) {
  Square square;
  const Glb glb = square.write();
  const auto& position = glb.json["accessors"][glb.attribute(0, 0, "POSITION")];
  EXPECT_EQ(position["min"], (nlohmann::ordered_json{0.0, 0.0, 0.0}));
  EXPECT_EQ(position["max"], (nlohmann::ordered_json{1.0, 2.0, 0.0}));
  EXPECT_EQ(glb.value<float>(glb.attribute(0, 0, "NORMAL"), 3, 2), 1.0f);
  EXPECT_EQ(glb.value<std::uint16_t>(glb.primitive(0, 0)["indices"], 5, 0), 3);
  EXPECT_TRUE(glb.json["materials"][0]["extensions"]["KHR_materials_unlit"].is_object());
  EXPECT_EQ(glb.json["extensionsUsed"], nlohmann::ordered_json::array({"KHR_materials_unlit"}));
  const Glb lit = square.write({.mark_unlit = false});
  EXPECT_FALSE(lit.json["materials"][0].contains("extensions"));
  EXPECT_FALSE(lit.json.contains("extensionsUsed"));
}

TEST(NewGltf, BaseColourAndEmission_NoTexture_AreInTheVertexColour) {
  Square square;
  square.file.scene.materials[0].base_color = {0.5f, 0.25f, 1};
  square.file.scene.materials[0].emission = {0.125f, 0, 0};
  const Glb glb = square.write({.color = ColorStorage::f32});
  const std::size_t color = glb.attribute(0, 0, "COLOR_0");
  EXPECT_FLOAT_EQ(glb.value<float>(color, 3, 0), 0.75f * 0.5f + 0.125f);
  EXPECT_FLOAT_EQ(glb.value<float>(color, 3, 1), 0.5f * 0.25f);
  EXPECT_FALSE(glb.json["materials"][0]["pbrMetallicRoughness"].contains("baseColorFactor"));
}

TEST(NewGltf, EmissionBehindNoBaseColour_IsInTheVertexColour_AndNoneOfUnlitMaterials) {
  Square square;
  Material& material = square.file.scene.materials[0];
  material.base_color = {0, 0.5f, 1};
  material.emission = {0.75f, 0, 0.125f};
  const Glb glb = square.write({.color = ColorStorage::f32});
  EXPECT_EQ(glb.value<float>(glb.attribute(0, 0, "COLOR_0"), 3, 0), 0.75f);
  EXPECT_EQ(glb.value<float>(glb.attribute(0, 0, "COLOR_0"), 3, 1), 0.25f);
  EXPECT_EQ(count_of(square.written.findings, "emission_not_written"), 0U);
  material.is_unlit = true;
  const Glb unlit = square.write({.color = ColorStorage::f32});
  EXPECT_EQ(unlit.value<float>(unlit.attribute(0, 0, "COLOR_0"), 3, 0), 0);
  EXPECT_EQ(unlit.value<float>(unlit.attribute(0, 0, "COLOR_0"), 3, 2), 0.25f);
}

TEST(NewGltf, ColoursAboveOne_AreCountedAndClippedInCOLOR_0Alone) {
  Square square;
  for (LinearRgb& color : square.baked.colors) color = color * 2.0f;
  const Glb glb = square.write({.color = ColorStorage::f32});
  const std::size_t color = glb.attribute(0, 0, "COLOR_0");
  EXPECT_FLOAT_EQ(glb.value<float>(color, 2, 0), 0.25f);
  EXPECT_FLOAT_EQ(glb.value<float>(color, 1, 0), 1.0f);
  EXPECT_EQ(square.written.clipped_vertices, 2U);  // (1,1,1) and (0.75, 0.5, 0.25).
  EXPECT_EQ(count_of(square.written.findings, "clipped_vertices"), 2U);

  const Glb light = square.write({.color = ColorStorage::f32, .attribute = "_LIGHT"});
  EXPECT_FLOAT_EQ(light.value<float>(light.attribute(0, 0, "_LIGHT"), 1, 0), 2.0f);
  EXPECT_EQ(square.written.clipped_vertices, 0U);
}

TEST(NewGltf, SeveralMaterials_OnePrimitiveEach_HasOnlyItsVertices) {
  Square square;
  square.file.scene.materials.resize(3);
  square.file.scene.mesh.materials = {2, 0};
  const Glb glb = square.write();
  ASSERT_EQ(glb.json["meshes"][0]["primitives"].size(), 2U);
  EXPECT_EQ(glb.json["materials"].size(), 2U);
  EXPECT_EQ(glb.count(glb.attribute(0, 0, "POSITION")), 3U);
  EXPECT_EQ(glb.count(glb.attribute(0, 1, "COLOR_0")), 3U);
  // The triangle (0, 2, 3) of material 0 comes first; its last vertex is (0, 2, 0).
  EXPECT_EQ(glb.value<float>(glb.attribute(0, 0, "POSITION"), 2, 0), 0.0f);
  EXPECT_EQ(glb.value<float>(glb.attribute(0, 0, "POSITION"), 2, 1), 2.0f);
}

TEST(NewGltf, NonFiniteVertex_IsLeftOutWithItsFacesAndCounted) {
  Square square;
  square.file.scene.mesh.positions[3].y = std::numeric_limits<float>::quiet_NaN();
  const Glb glb = square.write();
  EXPECT_EQ(glb.count(glb.attribute(0, 0, "POSITION")), 3U);
  EXPECT_EQ(glb.count(glb.primitive(0, 0)["indices"]), 3U);
  EXPECT_EQ(count_of(square.written.findings, "faces_left_out"), 1U);
}

TEST(NewGltf, NothingFinite_ThrowsAndWritesNothing) {
  Square square;
  square.file.scene.mesh.positions[0].x = std::numeric_limits<float>::infinity();
  const std::string path = temporary_file("none.glb");
  EXPECT_THROW(write_gltf_file(path, square.file, square.baked, {}), InvalidScene);
  EXPECT_FALSE(std::filesystem::exists(path));
}

/// The bytes of the one image of a square with this texture, and its type.
std::pair<std::string, std::string> image_written(const Image& image) {
  Square square;
  square.file.scene.mesh.texcoords[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  square.file.scene.images.push_back(image);
  square.file.scene.textures.emplace_back();
  square.file.scene.materials[0].base_color_texture = 0;
  const Glb glb = square.write();
  const auto& written = glb.json["images"][0];
  const auto& view = glb.json["bufferViews"][written["bufferView"].get<std::size_t>()];
  return {glb.bin.substr(view["byteOffset"], view["byteLength"]), written["mimeType"]};
}

TEST(NewGltf, TextureOfAFile_KeepsItsBytes_AnotherBecomesPng) {
  const std::string path = LAMBAKE_SOURCE_DIR "/tests/io/grey188.jpg";
  EXPECT_EQ(image_written(read_image(path)), std::make_pair(read_bytes(path), std::string("image/jpeg")));
  const auto [bytes, type] = image_written({1, 1, {glm::vec4(1)}});
  EXPECT_EQ(bytes.substr(0, 4), "\x89PNG");
  EXPECT_EQ(type, "image/png");
}

// glTF forbids it (Khronos' validator: MESH_PRIMITIVE_TOO_FEW_TEXCOORDS); pictures take it for white.
TEST(NewGltf, TextureWithoutTexcoords_IsNotWritten) {
  Square square;
  square.file.scene.images.push_back({1, 1, {glm::vec4(0.5f)}});
  square.file.scene.textures.emplace_back();
  square.file.scene.materials[0].base_color_texture = 0;
  const Glb glb = square.write();
  EXPECT_FALSE(glb.json["materials"][0]["pbrMetallicRoughness"].contains("baseColorTexture"));
  EXPECT_FALSE(glb.json.contains("images"));
  EXPECT_FALSE(glb.primitive(0, 0)["attributes"].contains("TEXCOORD_0"));
}

TEST(NewGltf, ManyVertices_TakeIndicesOf32Bit) {
  Square square;
  square.file.scene.mesh.positions.resize(65536, {0, 0, 0});
  square.file.scene.mesh.normals.resize(65536, {0, 0, 1});
  square.baked.colors.resize(65536);
  square.file.scene.mesh.triangles.push_back({0, 1, 65535});
  const Glb glb = square.write();
  const std::size_t indices = glb.primitive(0, 0)["indices"];
  EXPECT_EQ(glb.json["accessors"][indices]["componentType"], 5125);
  EXPECT_EQ(glb.value<std::uint32_t>(indices, 8, 0), 65535U);
}

TEST(NewGltf, GltfExtension_PutsTheBytesIntoABinBeside) {
  Square square;
  const std::string path = temporary_file("a b.gltf");
  write_gltf_file(path, square.file, square.baked, {});
  const auto json = nlohmann::ordered_json::parse(read_bytes(path));
  const std::string uri = json["buffers"][0]["uri"];
  EXPECT_NE(uri.find("a%20b.bin"), std::string::npos);
  const std::string bin = std::filesystem::path(path).replace_extension(".bin").string();
  EXPECT_EQ(std::filesystem::file_size(bin), json["buffers"][0]["byteLength"].get<std::size_t>());
}

TEST(GlbSize, PastFourGiB_IsRefusedAndTheOtherContainerOffered) {
  const std::uint64_t limit = 0xFFFFFFFF;
  EXPECT_NO_THROW(check_glb_size("x.glb", 1000, limit - 1100));
  try {
    check_glb_size("x.glb", 1000, limit);
    FAIL() << "accepted";
  } catch (const IoError& error) {
    EXPECT_NE(std::string(error.what()).find(".gltf"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace lambake
