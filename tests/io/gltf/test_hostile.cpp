#include <gtest/gtest.h>

#include <functional>

#include "io/gltf/files.h"
#include "io/gltf/glb_reader.h"
#include "io/gltf/triangle.h"
#include "lambake/bake/bake.h"
#include "lambake/core/error.h"
#include "lambake/io/gltf.h"

namespace lambake {
namespace {

using nlohmann::ordered_json;

struct Case {
  const char* name;
  std::function<void(ordered_json&)> spoil;
  int exit_code;
  const char* place;  ///< That the message names.
};

TEST(HostileGltf, SoundTriangle_IsRead) {
  EXPECT_EQ(outcome_of(triangle().dump()), std::make_pair(std::string(), 0));
}

TEST(HostileGltf, EachSpoiltPart_IsRefusedInOneLineThatNamesIt) {
  const std::vector<Case> cases{
      {"attribute of another count",
       [](auto& j) {
         j["accessors"].push_back(
             {{"bufferView", 0}, {"componentType", 5126}, {"count", 2}, {"type", "SCALAR"}});
         j["meshes"][0]["primitives"][0]["attributes"]["_ID"] = 2;
       },
       3, "meshes[0].primitives[0]._ID"},
      // Its members are named, not numbered.
      {"glTF 1.0", [](auto& j) { j["asset"]["version"] = "1.0", j["scene"] = "default"; }, 3,
       "asset.version: expected \"2.0\", found \"1.0\""},
      {"accessor past its view", [](auto& j) { j["accessors"][0]["count"] = 4; }, 3, "accessors[0]"},
      {"accessor offset that wraps", [](auto& j) { j["accessors"][0]["byteOffset"] = 0xFFFFFFFFFFFFFFF0U; },
       3, ""},
      {"count that wraps", [](auto& j) { j["accessors"][0]["count"] = 0x1555555555555556U; }, 3, ""},
      {"view past its buffer", [](auto& j) { j["bufferViews"][1]["byteLength"] = 7; }, 3, "bufferViews[1]"},
      {"view length of 1e300", [](auto& j) { j["bufferViews"][1]["byteLength"] = 1e300; }, 3, ""},
      {"stride below the element", [](auto& j) { j["bufferViews"][0]["byteStride"] = 4; }, 3, "accessors[0]"},
      {"wrong component type", [](auto& j) { j["accessors"][0]["componentType"] = 5127; }, 3, ""},
      {"indices of floats",
       [](auto& j) {
         j["accessors"][1]["componentType"] = 5126;
         j["accessors"][1]["count"] = 1;
       },
       3, "indices"},
      {"positions of two components", [](auto& j) { j["accessors"][0]["type"] = "VEC2"; }, 3, "POSITION"},
      {"index out of range", [](auto& j) { j["accessors"][0]["count"] = 2; }, 3, "indices[2]"},
      {"accessor that is not there",
       [](auto& j) { j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 9; }, 3, "POSITION"},
      {"negative accessor", [](auto& j) { j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = -5; },
       3, "POSITION"},
      {"mesh that is not there", [](auto& j) { j["nodes"][0]["mesh"] = 1; }, 3, "nodes[0].mesh"},
      {"material that is not there", [](auto& j) { j["meshes"][0]["primitives"][0]["material"] = 0; }, 3,
       "material"},
      {"root that is not there", [](auto& j) { j["scenes"][0]["nodes"][0] = 1; }, 3, "scenes[0]"},
      {"default scene that is not there", [](auto& j) { j["scene"] = 1; }, 3, "scene"},
      {"child that is not there", [](auto& j) { j["nodes"][0]["children"] = {7}; }, 3, "nodes[0].children"},
      {"node that is its own child", [](auto& j) { j["nodes"][0]["children"] = {0}; }, 3, "nodes"},
      {"cycle of two",
       [](auto& j) {
         j["nodes"][0]["children"] = {1};
         j["nodes"].push_back({{"children", {0}}});
       },
       3, "cycle"},
      {"node of two parents",
       [](auto& j) {
         j["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
         j["scenes"][0]["nodes"] = {0, 1};
       },
       3, "nodes[2]"},
      {"matrix of 15 numbers", [](auto& j) { j["nodes"][0]["matrix"] = std::vector<double>(15, 1); }, 3,
       "nodes[0].matrix"},
      {"number past float",
       [](auto& j) {
         j["nodes"][0]["translation"] = {1e300, 0, 0};
       },
       3, "nodes[0].translation"},
      {"joints that are signed",
       [](auto& j) {
         j["accessors"].push_back({{"componentType", 5122}, {"count", 3}, {"type", "VEC4"}});
         j["accessors"].push_back({{"componentType", 5126}, {"count", 3}, {"type", "VEC4"}});
         j["meshes"][0]["primitives"][0]["attributes"].update({{"JOINTS_0", 2}, {"WEIGHTS_0", 3}});
         j["skins"] = {{{"joints", {0}}}};
         j["nodes"][0]["skin"] = 0;
       },
       3, "JOINTS_0"},
      {"joints that are normalized",
       [](auto& j) {
         j["accessors"].push_back(
             {{"componentType", 5121}, {"count", 3}, {"type", "VEC4"}, {"normalized", true}});
         j["accessors"].push_back({{"componentType", 5126}, {"count", 3}, {"type", "VEC4"}});
         j["meshes"][0]["primitives"][0]["attributes"].update({{"JOINTS_0", 2}, {"WEIGHTS_0", 3}});
         j["skins"] = {{{"joints", {0}}}};
         j["nodes"][0]["skin"] = 0;
       },
       3, "JOINTS_0"},
      {"matrices whose product overflows",
       [](auto& j) {
         j["nodes"] = {{{"children", {1}}, {"scale", {1e30, 1, 1}}}, {{"mesh", 0}, {"scale", {1e30, 1, 1}}}};
       },
       4, "nodes[1]"},
      {"missing buffer file", [](auto& j) { j["buffers"][0]["uri"] = "not there.bin"; }, 3, "not there.bin"},
      {"buffer that is a folder", [](auto& j) { j["buffers"][0]["uri"] = "."; }, 3, ""},
      {"buffer shorter than it says", [](auto& j) { j["buffers"][0]["byteLength"] = 43; }, 3, "buffers[0]"},
      {"buffer of 4e18 bytes", [](auto& j) { j["buffers"][0]["byteLength"] = 4000000000000000000U; }, 3,
       "buffers[0]"},
      {"buffer without a name", [](auto& j) { j["buffers"][0].erase("uri"); }, 3, "buffers[0].uri"},
      {"image that does not decode",
       [](auto& j) {
         j["images"] = {{{"bufferView", 0}, {"mimeType", "image/png"}}};
         j["textures"] = {{{"source", 0}}};
         j["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
       },
       3, "images[0]"},
      {"image file that is not there",
       [](auto& j) {
         j["images"] = {{{"uri", "nowhere.png"}}};
         j["textures"] = {{{"source", 0}}};
         j["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
       },
       3, "images[0]"},
      {"light without a direction",
       [](auto& j) {
         j["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "directional"}}};
         j["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
         j["nodes"][0]["scale"] = {1, 1, 0};
       },
       4, "nodes[0]"},
      {"light that is not there",
       [](auto& j) { j["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 3; }, 3, "nodes[0]"},
      {"light of negative intensity",
       [](auto& j) {
         j["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", -1}}};
         j["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
       },
       3, "lights[0]"},
      {"cone without an inside",
       [](auto& j) {
         j["extensions"]["KHR_lights_punctual"]["lights"] = {
             {{"type", "spot"}, {"spot", {{"innerConeAngle", 1}, {"outerConeAngle", 0.5}}}}};
         j["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
       },
       3, "lights[0]"},
      {"camera of 0 degrees",
       [](auto& j) {
         j["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0}, {"znear", 0.1}}}}};
         j["nodes"][0]["camera"] = 0;
       },
       3, "cameras[0]"},
      {"zeros without end",
       [](auto& j) {
         j["accessors"][0].erase("bufferView");
         j["accessors"][0]["count"] = 4000000000U;
       },
       3, "accessors[0]"},
      {"sparse index out of range",
       [](auto& j) {
         j["accessors"][0]["sparse"] = {{"count", 3},
                                        {"indices", {{"bufferView", 0}, {"componentType", 5125}}},
                                        {"values", {{"bufferView", 0}}}};
       },
       3, "accessors[0]"},
      {"more sparse values than elements",
       [](auto& j) {
         j["accessors"][0]["sparse"] = {{"count", 400},
                                        {"indices", {{"bufferView", 1}, {"componentType", 5121}}},
                                        {"values", {{"bufferView", 0}}}};
       },
       3, "accessors[0]"},
      {"joint that is not there",
       [](auto& j) {
         j["skins"] = {{{"joints", {5}}}};
         j["nodes"][0]["skin"] = 0;
       },
       3, "skins[0]"},
      {"meshopt count that its bytes cannot hold",
       [](auto& j) {
         j["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                                         {"byteLength", 36},
                                                                         {"byteStride", 12},
                                                                         {"mode", "ATTRIBUTES"},
                                                                         {"count", 3000000000U}};
       },
       3, "EXT_meshopt_compression"},
      {"meshopt stream of garbage",
       [](auto& j) {
         j["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {
             {"buffer", 0}, {"byteLength", 36}, {"byteStride", 12}, {"mode", "ATTRIBUTES"}, {"count", 3}};
       },
       3, "EXT_meshopt_compression"},
      {"Draco stream of garbage",
       [](auto& j) {
         j["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
             {"bufferView", 0}, {"attributes", {{"POSITION", 0}}}};
       },
       3, "Draco"},
      {"unknown extension that is required", [](auto& j) { j["extensionsRequired"] = {"XYZ_secret"}; }, 3,
       "XYZ_secret"},
      {"glTF 1.0", [](auto& j) { j["asset"]["version"] = "1.0"; }, 3, "asset.version"},
      {"a later version that is needed", [](auto& j) { j["asset"]["minVersion"] = "2.1"; }, 3,
       "asset.minVersion"},
      {"no asset", [](auto& j) { j.erase("asset"); }, 3, "asset.version"},
      {"arrays that are numbers", [](auto& j) { j["accessors"] = 3; }, 3, ""},
      {"meshes that are strings",
       [](auto& j) {
         j["meshes"] = {"a", "b"};
       },
       3, ""},
      {"no triangles", [](auto& j) { j["meshes"][0]["primitives"][0]["mode"] = 0; }, 4, "triangles"},
      {"no nodes",
       [](auto& j) {
         j.erase("nodes");
         j["scenes"][0].erase("nodes");
       },
       4, "triangles"},
  };
  for (const Case& each : cases) {
    SCOPED_TRACE(each.name);
    ordered_json json = triangle();
    each.spoil(json);
    const auto [message, exit_code] = outcome_of(json.dump());
    EXPECT_EQ(exit_code, each.exit_code) << message;
    EXPECT_NE(message.find(each.place), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_NE(message.find("bad.gltf"), std::string::npos) << message;
  }
}

/// The triangle with a member of every kind that lambake reads; whole numbers are written as such, others
/// with a point.
ordered_json lit_triangle() {
  ordered_json json = triangle();
  json.update(ordered_json::parse(R"({
    "scenes": [{"name": "s", "nodes": [0, 1, 2]}],
    "nodes": [{"name": "n", "mesh": 0, "translation": [0.5, 0.5, 0.5], "rotation": [0.5, 0.5, 0.5, 0.5],
               "scale": [0.5, 0.5, 0.5], "weights": [0.5]},
              {"extensions": {"KHR_lights_punctual": {"light": 0}}},
              {"camera": 0, "children": [3, 4]},
              {"camera": 1},
              {"matrix": [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]}],
    "cameras": [{"name": "c", "type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.5, "zfar": 9.5}},
                {"type": "orthographic", "orthographic": {"xmag": 0.5, "ymag": 0.5, "znear": 0.5, "zfar": 9.5}}],
    "extensions": {"KHR_lights_punctual": {"lights": [
      {"name": "l", "type": "spot", "color": [0.5, 0.5, 0.5], "intensity": 0.5, "range": 0.5,
       "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}}]}},
    "extensionsUsed": ["KHR_lights_punctual"],
    "meshes": [{"name": "m", "weights": [0.5], "primitives": [
      {"attributes": {"POSITION": 0}, "targets": [{"POSITION": 0}], "indices": 1, "mode": 4, "material": 0}]}],
    "materials": [{"name": "m", "alphaCutoff": 0.5, "alphaMode": "MASK", "doubleSided": false,
      "emissiveFactor": [0.5, 0.5, 0.5],
      "emissiveTexture": {"index": 0, "texCoord": 0},
      "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 0.5],
        "baseColorTexture": {"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform":
          {"offset": [0.5, 0.5], "rotation": 0.5, "scale": [0.5, 0.5], "texCoord": 1}}}},
      "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 0.5}}}],
    "textures": [{"source": 0, "sampler": 0}],
    "samplers": [{"magFilter": 9728, "wrapS": 10497, "wrapT": 10497}],
    "images": [{"mimeType": "image/png", "uri": "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="}]
  })"));
  json["accessors"][0].update({{"byteOffset", 0}, {"normalized", false}});
  return json;
}

/// How messages write a place: nodes[0].mesh for /nodes/0/mesh.
std::string place_of(const ordered_json::json_pointer& pointer) {
  if (pointer.empty()) return "";
  const std::string& key = pointer.back();
  const std::string before = place_of(pointer.parent_pointer());
  if (std::isdigit(key[0]) != 0) return before + "[" + key + "]";
  return before.empty() ? key : before + "." + key;
}

TEST(HostileGltf, EachMemberOfAnotherType_IsRefusedByItsPlace) {
  const ordered_json sound = lit_triangle();
  ASSERT_EQ(outcome_of(sound.dump()), std::make_pair(std::string(), 0));
  std::vector<ordered_json::json_pointer> places;
  const std::function<void(const ordered_json::json_pointer&)> collect = [&](const auto& place) {
    const ordered_json& value = sound.at(place);
    if (!place.empty()) places.push_back(place);
    if (value.is_object())
      for (const auto& [key, unused] : value.items()) collect(place / key);
    if (value.is_array())
      for (std::size_t i = 0; i < value.size(); ++i) collect(place / i);
  };
  collect(ordered_json::json_pointer());
  ASSERT_GT(places.size(), 150U);
  const std::vector<ordered_json> others{"x", 1.5, -7, true, {1, 2}, {{"a", 1}}};
  for (const auto& place : places)
    for (const ordered_json& other : others) {
      const ordered_json& value = sound.at(place);
      const bool is_whole = value.is_number_unsigned();
      if (is_whole ? other.is_number_unsigned()
                   : value.type() == other.type() || (value.is_number() && other.is_number()))
        continue;
      SCOPED_TRACE(place.to_string() + " " + other.dump());
      ordered_json json = sound;
      json.at(place) = other;
      const auto [message, exit_code] = outcome_of(json.dump());
      EXPECT_EQ(exit_code, 3) << message;
      // Of the numbers of a vector, the vector is named.
      EXPECT_NE(message.find(place_of(value.is_number() ? place.parent_pointer() : place)), std::string::npos)
          << message;
    }
}

// Indices are ints in tinygltf: 2^32 + i would be read as i, and 2^32 - 1 as none.
TEST(HostileGltf, WholeNumbersPast31Bits_AreRefusedByTheirPlace) {
  ordered_json sound = lit_triangle();
  sound["skins"] = {{{"joints", {0}}, {"inverseBindMatrices", 0}}};
  std::vector<ordered_json::json_pointer> places;
  const std::function<void(const ordered_json::json_pointer&)> collect = [&](const auto& place) {
    const ordered_json& value = sound.at(place);
    if (value.is_number_unsigned()) places.push_back(place);
    if (value.is_object())
      for (const auto& [key, unused] : value.items()) collect(place / key);
    if (value.is_array())
      for (std::size_t i = 0; i < value.size(); ++i) collect(place / i);
  };
  collect(ordered_json::json_pointer());
  ASSERT_GT(places.size(), 35U);
  for (const auto& place : places)
    for (const std::uint64_t number :
         {std::uint64_t{1} << 31, (std::uint64_t{1} << 32) - 1,
          (std::uint64_t{1} << 32) + sound.at(place).get<std::uint64_t>(), ~std::uint64_t{0}}) {
      SCOPED_TRACE(place.to_string() + " " + std::to_string(number));
      ordered_json json = sound;
      json.at(place) = number;
      const auto [message, exit_code] = outcome_of(json.dump());
      EXPECT_EQ(exit_code, 3) << message;
      // Of a size that is past its file, what holds it is named.
      const bool is_size = place.back() == "count" || place.back().starts_with("byte");
      EXPECT_NE(message.find(place_of(is_size ? place.parent_pointer() : place)), std::string::npos)
          << message;
    }
}

// tinygltf finds the buffers, which are in memory, under names of ours.
TEST(HostileGltf, ImagesWithTheNamesOfBuffers_AreFilesLikeOthers) {
  for (const char* name :
       {"lambake-buffer-0", "lambake-buffer-7", "lambake-buffer-100000000", "lambake-buffer-",
        "lambake-buffer-x", "lambake-buffer-0x", "lambake-buffer-99999999999999999999999"}) {
    ordered_json json = triangle();
    json["images"] = {{{"uri", name}}};
    json["textures"] = {{{"source", 0}}};
    json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    json["meshes"][0]["primitives"][0]["material"] = 0;
    const auto [message, exit_code] = outcome_of(json.dump());
    EXPECT_NE(exit_code, 5) << name << ": " << message;
  }
}

TEST(HostileGltf, TreeOf10000Levels_IsRead) {
  ordered_json json = triangle();
  constexpr int n = 10000;
  json["nodes"] = ordered_json::array();
  for (int i = 0; i + 1 < n; ++i) json["nodes"].push_back({{"children", {i + 1}}});
  json["nodes"].push_back({{"mesh", 0}, {"translation", {0, 0, 1}}});
  EXPECT_EQ(outcome_of(json.dump()), std::make_pair(std::string(), 0));
}

TEST(HostileGltf, FlippedBytesAnywhere_NeverEndOtherwiseThanInAnError) {
  for (const char* name : {"gltf/BoxMeshopt.glb", "gltf/Box_Draco.glb", "gltf/RiggedSimple.glb"}) {
    const std::string bytes = read_bytes(meshes_folder() + name);
    for (std::size_t at = 12; at < bytes.size(); at += 1 + at % 7) {
      std::string spoilt = bytes;
      spoilt[at] = static_cast<char>(spoilt[at] ^ (1 << (at % 8)));
      EXPECT_NO_THROW(outcome_of(spoilt, "x.glb")) << name << " byte " << at;
    }
  }
}

TEST(HostileGltf, BadRealFiles_AreRefused) {
  for (const char* name : {"buffer_not_found.gltf", "integer-out-of-bounds.gltf",
                           "invalid-primitive-indices.gltf", "invalid_magic.glb", "truncated_chunk_data.glb"})
    EXPECT_THROW(read_gltf_file(meshes_folder() + "bad/" + name, {}), IoError) << name;
}

}  // namespace
}  // namespace lambake
