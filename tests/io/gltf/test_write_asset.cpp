#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <regex>
#include <set>

#include "io/gltf/builder.h"
#include "io/gltf/files.h"
#include "io/gltf/glb_reader.h"
#include "io/gltf/lit_asset.h"
#include "lambake/bake/bake.h"
#include "lambake/core/bounds.h"
#include "lambake/core/error.h"
#include "lambake/io/gltf.h"

namespace lambake {
namespace {

using nlohmann::json, nlohmann::ordered_json;

/// The JSON of a .gltf or .glb.
json json_of(const std::string& path) {
  const std::string bytes = read_bytes(path);
  return bytes.substr(0, 4) == "glTF" ? json(read_glb(path).json) : json::parse(bytes);
}

/// What baking may change in a document, as paths of a JSON patch.
bool is_expected_change(const std::string& operation, const std::string& path, bool has_rewritten) {
  static const std::regex appended("/(accessors|bufferViews|meshes|materials|extensionsUsed)(/-|/[0-9]+)?"),
      colour("/meshes/[0-9]+/primitives/[0-9]+/(attributes/COLOR_0|material)"), placed("/nodes/[0-9]+/mesh"),
      unlit("/materials/[0-9]+/extensions(/KHR_materials_unlit)?"),
      merged("/buffers/[0-9]+(/uri|/byteLength)?|/bufferViews/[0-9]+/(buffer|byteOffset)"),
      embedded("/images/[0-9]+/(uri|mimeType|bufferView)"),
      rewritten(
          "/meshes/[0-9]+/primitives/[0-9]+/"
          "(indices|mode|(attributes|targets/[0-9]+)/[A-Z_0-9]+)|/(accessors|bufferViews)/.*"
          "|/animations/[0-9]+/samplers/[0-9]+/(input|output)|/skins/[0-9]+/inverseBindMatrices");
  return (operation == "add" && std::regex_match(path, appended)) || std::regex_match(path, colour) ||
         std::regex_match(path, placed) || (operation == "add" && std::regex_match(path, unlit)) ||
         std::regex_match(path, merged) || std::regex_match(path, embedded) ||
         (has_rewritten && std::regex_match(path, rewritten));
}

TEST(GltfAsset, EveryRealFile_ComesBackWithNothingButLightAdded) {
  for (const ManifestRow& row : gltf_rows()) {
    SCOPED_TRACE(row.path);
    const auto result = bake_file(meshes_folder() + row.path, {}, {});
    if (!result) continue;
    const json before = json_of(meshes_folder() + row.path), after = json_of(result->path);
    const bool has_rewritten = count_of(result->written.findings, "rewritten_primitives") > 0 ||
                               count_of(result->written.findings, "vertex_colors_multiplied") > 0;
    for (const json& change : json::diff(before, after))
      EXPECT_TRUE(is_expected_change(change["op"], change["path"], has_rewritten)) << change.dump();
  }
}

// Columns of matrices begin at multiples of 4 bytes.
TEST(GltfAsset, SmallMatrices_AreWrittenAnewWithTheirPadding) {
  struct Layout {
    int component_type;
    std::size_t component_bytes;
    const char* type;
    std::size_t n_columns, column_bytes;
  };
  for (const Layout& layout : {Layout{5121, 1, "MAT2", 2, 4}, Layout{5121, 1, "MAT3", 3, 4},
                               Layout{5123, 2, "MAT3", 3, 8}, Layout{5121, 1, "MAT4", 4, 4}}) {
    SCOPED_TRACE(layout.type);
    const std::size_t stride = layout.n_columns * layout.column_bytes;
    const std::size_t n_used = layout.n_columns * layout.component_bytes;  // Bytes of a column.
    std::vector<unsigned char> bytes(4 * stride, 0xEE);
    for (std::size_t i = 0; i < bytes.size(); ++i)
      if (i % layout.column_bytes < n_used) bytes[i] = static_cast<unsigned char>(i);
    // What pads the last column need not be there.
    bytes.resize(bytes.size() - (layout.column_bytes - n_used));
    GltfBuilder builder;
    ordered_json square = builder.square();
    square["attributes"]["_M"] = builder.add(layout.component_type, layout.type, 4, bytes);
    square["attributes"].erase("NORMAL");
    square["attributes"]["POSITION"] = builder.add_floats("VEC3", 4, {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1});
    builder.add_primitive(square);
    const auto result = bake_file(builder.write(), {.method = BakeMethod::face}, {});
    const Glb glb = read_glb(result->path);
    ASSERT_EQ(count_of(result->written.findings, "rewritten_primitives"), 1U);
    const ordered_json& accessor = glb.json["accessors"][glb.attribute(0, 0, "_M")];
    const ordered_json& view = glb.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    EXPECT_EQ(accessor["type"], layout.type);
    ASSERT_EQ(view["byteLength"], 6 * stride);
    for (std::size_t i = 0; i < 6 * stride; ++i) {
      const std::size_t vertex = std::vector<std::size_t>{0, 1, 2, 1, 3, 2}[i / stride];
      if (i % layout.column_bytes >= n_used) continue;
      const char found = glb.bin[view["byteOffset"].get<std::size_t>() + i];
      EXPECT_EQ(static_cast<unsigned char>(found), bytes[vertex * stride + i % stride]) << i;
    }
  }
}

/// Two squares; the first has a variant of each other material, the second has the last material.
std::string write_variants(GltfBuilder& builder) {
  ordered_json first = builder.square(), second = builder.square();
  first["material"] = 0;
  first["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {0}}},
                                                               {{"material", 2}, {"variants", {1}}}};
  second["material"] = 2;
  second["mode"] = 1;  // Lines are not lit.
  builder.add_primitive(first), builder.add_primitive(second);
  builder.json["materials"] = {{{"name", "a"}}, {{"name", "b"}}, {{"name", "c"}}};
  builder.json["extensionsUsed"] = {"KHR_materials_variants"};
  builder.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "x"}}, {{"name", "y"}}};
  return builder.write();
}

TEST(GltfAsset, MaterialsOfVariants_AreMarkedLikeThePrimitivesOwn) {
  GltfBuilder builder;
  const auto result = bake_file(write_variants(builder), {}, {});
  const Glb glb = read_glb(result->path);
  const auto is_unlit = [&](const ordered_json& index) {
    const ordered_json& material = glb.json["materials"][index.get<std::size_t>()];
    return material.contains("extensions") && material["extensions"].contains("KHR_materials_unlit");
  };
  const ordered_json& mappings = glb.primitive(0, 0)["extensions"]["KHR_materials_variants"]["mappings"];
  EXPECT_TRUE(is_unlit(glb.primitive(0, 0)["material"]));
  EXPECT_TRUE(is_unlit(mappings[0]["material"]));
  EXPECT_TRUE(is_unlit(mappings[1]["material"]));
  EXPECT_EQ(mappings[1]["material"], 3);  // A copy: the lines keep theirs.
  EXPECT_EQ(glb.json["materials"][3]["name"], "c");
  EXPECT_EQ(glb.primitive(0, 1)["material"], 2);
  EXPECT_FALSE(is_unlit(2));
  EXPECT_EQ(count_of(result->written.findings, "material_variants"), 1U);
}

TEST(GltfAsset, VariantOfAMaterialThatIsNotThere_IsRefused) {
  GltfBuilder builder;
  write_variants(builder);
  builder.json["materials"].erase(2);
  builder.json["meshes"][0]["primitives"].erase(1);
  EXPECT_THROW(read_gltf_file(builder.write(), {}), IoError);
}

/// An accessor with the bytes of its views in the place of their numbers.
json resolved(const Glb& glb, std::size_t accessor) {
  json result = glb.json["accessors"].at(accessor);
  const auto bytes_of = [&](const json& index) {
    const auto& view = glb.json["bufferViews"].at(index.get<std::size_t>());
    const std::string bytes = glb.bin.substr(view.value("byteOffset", 0U), view["byteLength"]);
    return json::binary({bytes.begin(), bytes.end()});
  };
  if (result.contains("bufferView")) result["bufferView"] = bytes_of(result["bufferView"]);
  if (result.contains("sparse"))
    for (const char* part : {"indices", "values"})
      result["sparse"][part]["bufferView"] = bytes_of(result["sparse"][part]["bufferView"]);
  return result;
}

/// What a document has besides meshes that refers to bytes: animations, skins, images.
std::vector<json> resolved_rest(const Glb& glb) {
  std::vector<json> rest;
  for (const auto& animation : glb.json.value("animations", json::array()))
    for (const json& sampler : animation["samplers"])
      for (const char* end : {"input", "output"}) rest.push_back(resolved(glb, sampler[end]));
  for (const json& skin : glb.json.value("skins", json::array()))
    if (skin.contains("inverseBindMatrices")) rest.push_back(resolved(glb, skin["inverseBindMatrices"]));
  for (const json& image : glb.json.value("images", json::array()))
    if (image.contains("bufferView")) {
      const auto& view = glb.json["bufferViews"].at(image["bufferView"].get<std::size_t>());
      rest.emplace_back(glb.bin.substr(view.value("byteOffset", 0U), view["byteLength"]));
    }
  return rest;
}

/// Accessors that no mesh, animation or skin names.
std::size_t n_spare_accessors(const json& document) {
  std::set<std::size_t> named;
  const auto add = [&](const json& object, const char* key) {
    if (object.contains(key)) named.insert(object[key].get<std::size_t>());
  };
  for (const json& mesh : document.value("meshes", json::array()))
    for (const json& primitive : mesh["primitives"]) {
      for (const json& index : primitive["attributes"]) named.insert(index.get<std::size_t>());
      for (const json& target : primitive.value("targets", json::array()))
        for (const json& index : target) named.insert(index.get<std::size_t>());
      add(primitive, "indices");
    }
  for (const json& animation : document.value("animations", json::array()))
    for (const json& sampler : animation["samplers"]) add(sampler, "input"), add(sampler, "output");
  for (const json& skin : document.value("skins", json::array())) add(skin, "inverseBindMatrices");
  return document.value("accessors", json::array()).size() - named.size();
}

// The face method writes lit primitives anew; what lies behind the bytes that it drops moves.
TEST(GltfAsset, EveryRealFileWrittenAnew_KeepsTheRestAndDropsWhatItReplaced) {
  std::size_t n_smaller = 0;
  for (const ManifestRow& row : gltf_rows()) {
    SCOPED_TRACE(row.path);
    const auto plain = bake_file(meshes_folder() + row.path, {}, {});
    if (!plain) continue;
    const std::vector<json> rest = resolved_rest(read_glb(plain->path));
    const auto anew = bake_file(meshes_folder() + row.path, {.method = BakeMethod::face}, {});
    const Glb after = read_glb(anew->path);
    EXPECT_EQ(resolved_rest(after), rest);
    if (count_of(anew->written.findings, "rewritten_primitives") == 0) continue;
    const json source = json_of(meshes_folder() + row.path);
    // An extension that nobody knows may use what nothing else does.
    if (source.dump().find("NV_") != std::string::npos) {
      EXPECT_GT(n_spare_accessors(json(after.json)), n_spare_accessors(source));
      continue;
    }
    EXPECT_LE(n_spare_accessors(json(after.json)), n_spare_accessors(source));
    ++n_smaller;
  }
  EXPECT_GE(n_smaller, 20U);
}

TEST(GltfAsset, EveryRealFile_ReadAgain_ShowsTheBakedColours) {
  for (const ManifestRow& row : gltf_rows()) {
    SCOPED_TRACE(row.path);
    for (const BakeMethod method : {BakeMethod::sample, BakeMethod::face}) {
      const auto result = bake_file(meshes_folder() + row.path, {.method = method}, {});
      if (!result) continue;
      const Scene again = read_gltf_file(result->path, {}).scene;
      const Scene& scene = result->in.scene;
      const Mesh& mesh = mesh_of(scene, result->baked);
      ASSERT_EQ(again.mesh.n_triangles(), mesh.n_triangles());
      for (std::size_t f = 0; f < mesh.n_triangles(); ++f) {
        const Material& material = scene.materials[mesh.material_of(f)];
        const Material& shown = again.materials[again.mesh.material_of(f)];
        ASSERT_TRUE(shown.is_unlit);
        ASSERT_TRUE(shown.base_color == material.base_color);
        ASSERT_EQ(shown.base_color_texture == no_texture, material.base_color_texture == no_texture);
        for (int c = 0; c < 3; ++c) {
          const std::uint32_t v = mesh.triangles[f][c], w = again.mesh.triangles[f][c];
          ASSERT_LT(glm::distance(mesh.positions[v], again.mesh.positions[w]),
                    1e-5f * glm::length(mesh.positions[v]) + 1e-6f);
          if (!(material.emission == LinearRgb{0, 0, 0})) continue;
          const LinearRgb& want = result->baked.colors[v];
          const LinearRgb got = again.mesh.colors.empty() ? LinearRgb{1, 1, 1} : again.mesh.colors[w];
          const auto near = [](float a, float b) { return std::abs(std::min(a, 1.0f) - b) <= 0.51f / 65535; };
          ASSERT_TRUE(near(want.r, got.r) && near(want.g, got.g) && near(want.b, got.b))
              << "triangle " << f << ": " << want.r << ' ' << want.g << ' ' << want.b << ", found " << got.r
              << ' ' << got.g << ' ' << got.b;
        }
      }
    }
  }
}

TEST(GltfAsset, MeshOfTwoNodes_HasTwoCopiesThatDifferInColourAlone) {
  const auto result = bake_file(meshes_folder() + "gltf/SimpleMeshes.gltf", {}, {});
  const Glb glb = read_glb(result->path);
  ASSERT_EQ(glb.json["meshes"].size(), 2U);
  EXPECT_NE(glb.json["nodes"][0]["mesh"], glb.json["nodes"][1]["mesh"]);
  auto first = glb.primitive(0, 0), second = glb.primitive(1, 0);
  EXPECT_NE(first["attributes"]["COLOR_0"], second["attributes"]["COLOR_0"]);
  first["attributes"].erase("COLOR_0"), second["attributes"].erase("COLOR_0");
  EXPECT_EQ(first, second);
}

TEST(GltfAsset, OtherAttribute_HoldsLightAlone_AndLeavesColoursAndMaterials) {
  const std::string path = meshes_folder() + "gltf/BoxVertexColors.glb";
  const auto result =
      bake_file(path, {}, {.color = ColorStorage::f32, .mark_unlit = false, .attribute = "_LIGHT"});
  const Glb before = read_glb(path), after = read_glb(result->path);
  EXPECT_EQ(before.json["materials"], after.json["materials"]);
  EXPECT_EQ(before.attribute(0, 0, "COLOR_0"), after.attribute(0, 0, "COLOR_0"));
  const std::size_t light = after.attribute(0, 0, "_LIGHT");
  for (std::size_t i = 0; i < after.count(light); ++i) {
    const LinearRgb& base = result->in.scene.mesh.colors[i];
    const LinearRgb& color = result->baked.colors[i];
    EXPECT_NEAR(after.value<float>(light, i, 0) * base.r, color.r, 1e-6);
    EXPECT_NEAR(after.value<float>(light, i, 1) * base.g, color.g, 1e-6);
  }
}

TEST(GltfAsset, VertexColoursThatLightReplaces_LeaveNoBytes) {
  const auto result = bake_file(meshes_folder() + "gltf/BoxVertexColors.glb", {}, {});
  const Glb before = read_glb(meshes_folder() + "gltf/BoxVertexColors.glb"), after = read_glb(result->path);
  EXPECT_EQ(after.json["accessors"].size(), before.json["accessors"].size());
  EXPECT_EQ(n_spare_accessors(json(after.json)), 0U);
  EXPECT_EQ(before.count(before.attribute(0, 0, "COLOR_0")), 24U);
  EXPECT_EQ(after.bin.size(), before.bin.size() - 24 * 16 + 24 * 8);  // Floats before, 16 bits after.
}

// A viewer takes the stream's colours where the extension names them.
TEST(GltfAsset, ColoursInADracoStream_AreNotNamedAnyMore) {
  Glb glb = read_glb(meshes_folder() + "gltf/Box_Draco.glb");
  ordered_json& primitive = glb.json["meshes"][0]["primitives"][0];
  ordered_json& packed = primitive["extensions"]["KHR_draco_mesh_compression"]["attributes"];
  ordered_json accessor = glb.json["accessors"][glb.attribute(0, 0, "NORMAL")];
  packed["COLOR_0"] = packed["NORMAL"];  // As good as any.
  primitive["attributes"]["COLOR_0"] = glb.json["accessors"].size();
  glb.json["accessors"].push_back(accessor);
  const std::string path = temporary_file("in.gltf");
  write_bytes(path + ".bin", glb.bin);
  glb.json["buffers"][0]["uri"] = std::filesystem::path(path + ".bin").filename().string();
  write_bytes(path, glb.json.dump());
  const auto result = bake_file(path, {}, {});
  const Glb after = read_glb(result->path);
  const ordered_json& left = after.primitive(0, 0)["extensions"]["KHR_draco_mesh_compression"]["attributes"];
  EXPECT_FALSE(left.contains("COLOR_0"));
  EXPECT_TRUE(left.contains("NORMAL"));
  EXPECT_TRUE(after.primitive(0, 0)["attributes"].contains("COLOR_0"));
}

TEST(GltfAsset, Draco_StaysCompressedWithColoursBeside_AndUnpacksWhereFacesSplit) {
  const std::string path = meshes_folder() + "gltf/Box_Draco.glb";
  const Glb kept = read_glb(bake_file(path, {}, {})->path);
  EXPECT_TRUE(kept.primitive(0, 0)["extensions"].contains("KHR_draco_mesh_compression"));
  EXPECT_EQ(kept.json["extensionsRequired"], json::array({"KHR_draco_mesh_compression"}));
  const Glb split = read_glb(bake_file(path, {.method = BakeMethod::face}, {})->path);
  // A box has one colour per face on vertices of their own: only where two triangles of a vertex differ must
  // it be rewritten; either way both files read alike, which the round trip above holds.
  EXPECT_EQ(split.json.contains("extensionsRequired"), split.primitive(0, 0).contains("extensions"));
}

TEST(GltfAsset, AttributeOfAnotherMeaning_IsRefused) {
  const SceneFile file = read_lit(meshes_folder() + "gltf/box01.glb");
  EXPECT_THROW(write_gltf_file(temporary_file("x.glb"), file, bake(file.scene, {}), {.attribute = "NORMAL"}),
               InvalidOption);
}

}  // namespace
}  // namespace lambake
