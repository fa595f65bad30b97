#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "io/gltf/builder.h"
#include "io/gltf/files.h"
#include "io/gltf/glb_reader.h"
#include "io/gltf/lit_asset.h"
#include "lambake/bake/bake.h"
#include "lambake/core/error.h"
#include "lambake/io/gltf.h"
#include "lambake/io/image_file.h"

namespace lambake {
namespace {

using nlohmann::ordered_json;

TEST(GltfMaterials, DefaultMaterial_IsThereWhereAPrimitiveHasNone) {
  for (const bool has_other : {false, true}) {
    GltfBuilder builder;
    ordered_json square = builder.square();
    square["material"] = 0;
    builder.add_primitive(square);
    builder.json["materials"] = {{{"name", "a"}}};
    if (has_other) {
      square.erase("material");
      builder.add_primitive(square);
    }
    const Scene scene = read_gltf_file(builder.write(), {}).scene;
    ASSERT_EQ(scene.materials.size(), has_other ? 2U : 1U);
    EXPECT_EQ(scene.materials[0].name, "a");
    EXPECT_EQ(scene.mesh.material_of(0), 0U);
    EXPECT_EQ(scene.mesh.material_of(scene.mesh.n_triangles() - 1), has_other ? 1U : 0U);
  }
}

TEST(GltfMaterials, TextureTransform_TurnsAgainstTheClock_WhereVPointsDown) {
  const std::string folder = meshes_folder() + "gltf/Duck/";
  ordered_json json = ordered_json::parse(read_bytes(folder + "Duck.gltf"));
  json["buffers"][0]["uri"] = folder + "Duck0.bin";
  std::filesystem::copy_file(folder + "DuckCM.png", temporary_file("duck.png"),
                             std::filesystem::copy_options::overwrite_existing);
  json["images"][0]["uri"] = std::filesystem::path(temporary_file("duck.png")).filename().string();
  json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
      {"offset", {0.25, 0.5}}, {"rotation", std::numbers::pi / 2}, {"scale", {2, 3}}};
  const std::string path = temporary_file("turned.gltf");
  write_bytes(path, json.dump());
  const Scene scene = read_gltf_file(path, {}).scene;
  const glm::vec3 uv = scene.textures[0].transform * glm::vec3(0.1f, 0.2f, 1);
  EXPECT_NEAR(uv.x, 0.25 + 3 * 0.2, 1e-6);
  EXPECT_NEAR(uv.y, 0.5 - 2 * 0.1, 1e-6);
}

TEST(GltfMaterials, ImageNames_AreUrisWhosePlusIsAPlus) {
  const std::string folder = meshes_folder() + "gltf/Duck/";
  ordered_json json = ordered_json::parse(read_bytes(folder + "Duck.gltf"));
  json["buffers"][0]["uri"] = folder + "Duck0.bin";
  std::filesystem::copy_file(folder + "DuckCM.png", temporary_file("a+b 100%.png"),
                             std::filesystem::copy_options::overwrite_existing);
  const std::string prefix = std::filesystem::path(temporary_file("")).filename().string();
  const std::string path = temporary_file("plus.gltf");
  for (const char* uri : {"a+b 100%.png", "a+b%20100%25.png", "a%2Bb%20100%25.png", "%61+b 100%.png"}) {
    json["images"][0]["uri"] = prefix + uri;
    write_bytes(path, json.dump());
    EXPECT_EQ(read_gltf_file(path, {}).scene.images.at(0).width, 512U) << uri;
  }
  json["images"][0]["uri"] = "no+where.png";
  write_bytes(path, json.dump());
  try {
    read_gltf_file(path, {});
    FAIL();
  } catch (const IoError& error) {
    EXPECT_NE(std::string(error.what()).find("\"no+where.png\""), std::string::npos) << error.what();
  }
}

/// A square with a material of the given picture, as `name` in the material or in its base colour.
void add_textured_square(GltfBuilder& builder, const char* name, const LinearRgb& color, bool has_texcoords) {
  const std::string png = encode_png({1, 1, {color}});
  ordered_json square = builder.square();
  if (has_texcoords)
    square["attributes"]["TEXCOORD_0"] = builder.add_floats("VEC2", 4, {0, 0, 1, 0, 0, 1, 1, 1});
  const std::size_t bytes =
      builder.add(5121, "SCALAR", png.size(), std::vector<unsigned char>(png.begin(), png.end()));
  builder.json["images"] = {
      {{"bufferView", builder.json["accessors"][bytes]["bufferView"]}, {"mimeType", "image/png"}}};
  builder.json["textures"] = {{{"source", 0}}};
  builder.json["materials"] = {
      {{"pbrMetallicRoughness", ordered_json::object()}, {"emissiveFactor", {1, 0.5, 1}}}};
  ordered_json& material = builder.json["materials"][0];
  const bool is_emission = std::string(name) == "emissiveTexture";
  (is_emission ? material : material["pbrMetallicRoughness"])[name] = {{"index", 0}};
  square["material"] = 0;
  builder.add_primitive(square);
}

TEST(GltfMaterials, EmissionBehindABlackTexture_IsNone) {
  for (const float level : {0.0f, 0.5f}) {
    GltfBuilder builder;
    add_textured_square(builder, "emissiveTexture", {level, 0, 0}, true);
    SceneFile file = read_lit(builder.write());
    EXPECT_EQ(has_emission(file.scene.materials[0]), level > 0);
    for (const GltfWriteOptions& options : {GltfWriteOptions{}, GltfWriteOptions{.mark_unlit = false}})
      EXPECT_EQ(gltf_output(file, options).gaps.size(), level > 0 && options.mark_unlit ? 1U : 0U);
    const WrittenColors written = write_gltf_file(temporary_file("out.glb"), file, bake(file.scene, {}), {});
    EXPECT_EQ(count_of(written.findings, "emission_not_written"), level > 0 ? 4U : 0U);
    // Another emission than that of the file would stay there.
    file.scene.materials[0].emission = {0.25f, 0, 0};
    EXPECT_FALSE(gltf_output(file, {.mark_unlit = false}).gaps.empty());
  }
}

// Viewers differ in what they show there.
TEST(GltfMaterials, TexturesWithoutTexcoords_AreTold_AndNotCertified) {
  GltfBuilder builder;
  add_textured_square(builder, "baseColorTexture", {0.5f, 0, 0}, false);
  builder.json["materials"][0].erase("emissiveFactor");
  const SceneFile none = read_lit(builder.write());
  EXPECT_EQ(count_of(none.findings, "textures_without_texcoords"), 1U);
  EXPECT_EQ(none.scene.materials[0].base_color_texture, no_texture);
  EXPECT_EQ(gltf_output(none, {}).gaps.size(), 1U);
  // The material comes back as it was.
  write_gltf_file(temporary_file("out.glb"), none, bake(none.scene, {}), {});
  EXPECT_EQ(read_glb(temporary_file("out.glb")).json["materials"][0]["pbrMetallicRoughness"],
            builder.json["materials"][0]["pbrMetallicRoughness"]);
  // Another primitive of the material has some.
  ordered_json square = builder.square();
  square["attributes"]["TEXCOORD_0"] = builder.add_floats("VEC2", 4, {0, 0, 1, 0, 0, 1, 1, 1});
  square["material"] = 0;
  builder.add_primitive(square);
  const SceneFile mixed = read_lit(builder.write());
  EXPECT_EQ(count_of(mixed.findings, "textures_without_texcoords"), 1U);
  EXPECT_EQ(mixed.scene.materials[0].base_color_texture, 0U);
  EXPECT_EQ(gltf_output(mixed, {}).gaps.size(), 1U);
  // All have.
  builder.json["meshes"][0]["primitives"].erase(0);
  const SceneFile all = read_lit(builder.write());
  EXPECT_EQ(count_of(all.findings, "textures_without_texcoords"), 0U);
  EXPECT_TRUE(gltf_output(all, {}).gaps.empty());
}

/// A WebP of one pixel, without loss: 255, 0, 0.
const std::string red_webp = [] {
  constexpr unsigned char bytes[] = {'R',  'I',  'F',  'F',  22,   0,    0,    0,    'W',  'E',
                                     'B',  'P',  'V',  'P',  '8',  'L',  10,   0,    0,    0,
                                     0x2f, 0x00, 0x00, 0x00, 0x00, 0x88, 0xfe, 0x47, 0xff, 0x03};
  return std::string(std::begin(bytes), std::end(bytes));
}();

TEST(GltfMaterials, SourceOfTheWebpExtension_IsReadAndKept) {
  for (const bool is_beside : {false, true}) {
    GltfBuilder builder;
    add_textured_square(builder, "baseColorTexture", {0, 0, 1}, true);
    builder.json["materials"][0].erase("emissiveFactor");
    builder.json["extensionsUsed"] = builder.json["extensionsRequired"] = {"EXT_texture_webp"};
    builder.json["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}}};
    if (is_beside) {
      write_bytes(temporary_file("red.webp"), red_webp);
      const std::string name = std::filesystem::path(temporary_file("red.webp")).filename().string();
      builder.json["images"].push_back({{"uri", name}});
    } else {
      const std::size_t bytes = builder.add(5121, "SCALAR", red_webp.size(),
                                            std::vector<unsigned char>(red_webp.begin(), red_webp.end()));
      builder.json["images"].push_back(
          {{"bufferView", builder.json["accessors"][bytes]["bufferView"]}, {"mimeType", "image/webp"}});
    }
    const SceneFile file = read_lit(builder.write());
    EXPECT_EQ(file.findings.size(), 0U);
    ASSERT_EQ(file.scene.images.size(), 1U);
    EXPECT_EQ(file.scene.images[0].pixel(0), glm::vec4(1, 0, 0, 1));
    const WrittenColors written = write_gltf_file(temporary_file("out.glb"), file, bake(file.scene, {}), {});
    EXPECT_EQ(count_of(written.findings, "images_not_embedded"), 0U);
    const Glb glb = read_glb(temporary_file("out.glb"));
    EXPECT_EQ(glb.json["textures"], builder.json["textures"]);
    EXPECT_EQ(glb.json["extensionsRequired"], builder.json["extensionsRequired"]);
    EXPECT_EQ(glb.json["images"][1]["mimeType"], "image/webp");
    EXPECT_EQ(read_gltf_file(temporary_file("out.glb"), {}).scene.images[0].pixel(0), glm::vec4(1, 0, 0, 1));
    // Where it does not decode there may be another.
    builder.json.erase("extensionsRequired");
    write_bytes(temporary_file("red.webp"), "RIFF");
    builder.json["images"][1] = {{"uri", "data:image/webp;base64,UklGRg=="}};
    EXPECT_THROW(read_gltf_file(builder.write(), {}), IoError);
    builder.json["textures"][0]["source"] = 0;
    EXPECT_EQ(read_gltf_file(builder.write(), {}).scene.images[0].pixel(0), glm::vec4(0, 0, 1, 1));
  }
}

}  // namespace
}  // namespace lambake
