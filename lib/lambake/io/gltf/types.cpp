#include "lambake/io/gltf/types.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string_view>
#include <variant>
#include <vector>

#include "lambake/core/error.h"
#include "lambake/io/json_text.h"

namespace lambake {
namespace {

/// `size` is a whole number of bytes or elements, held to the file elsewhere; `whole` any other, which
/// tinygltf keeps as an int.
enum class Type { whole, size, number, numbers, boolean, string, object };

constexpr std::uint64_t largest_whole = std::numeric_limits<int>::max();

struct Member {
  std::string_view place;  ///< Keys; [] is each element of an array and {} each member of an object.
  Type type;
  std::size_t n = 0;  ///< Length of `numbers`.
};

// clang-format off
constexpr Member members[] = {
    {"asset/minVersion", Type::string},
    {"extensionsUsed/[]", Type::string},
    {"extensionsRequired/[]", Type::string},
    {"scene", Type::whole},
    {"scenes/[]/name", Type::string},
    {"scenes/[]/nodes/[]", Type::whole},

    {"nodes/[]/name", Type::string},
    {"nodes/[]/camera", Type::whole},
    {"nodes/[]/children/[]", Type::whole},
    {"nodes/[]/matrix", Type::numbers, 16},
    {"nodes/[]/mesh", Type::whole},
    {"nodes/[]/rotation", Type::numbers, 4},
    {"nodes/[]/scale", Type::numbers, 3},
    {"nodes/[]/skin", Type::whole},
    {"nodes/[]/translation", Type::numbers, 3},
    {"nodes/[]/weights/[]", Type::number},
    {"nodes/[]/extensions/KHR_lights_punctual/light", Type::whole},
    {"skins/[]/inverseBindMatrices", Type::whole},
    {"skins/[]/joints/[]", Type::whole},

    {"meshes/[]/name", Type::string},
    {"meshes/[]/weights/[]", Type::number},
    {"meshes/[]/primitives/[]/attributes/{}", Type::whole},
    {"meshes/[]/primitives/[]/indices", Type::whole},
    {"meshes/[]/primitives/[]/material", Type::whole},
    {"meshes/[]/primitives/[]/mode", Type::whole},
    {"meshes/[]/primitives/[]/targets/[]/{}", Type::whole},
    {"meshes/[]/primitives/[]/extensions/KHR_materials_variants/mappings/[]/material", Type::whole},
    {"meshes/[]/primitives/[]/extensions/KHR_draco_mesh_compression/bufferView", Type::whole},
    {"meshes/[]/primitives/[]/extensions/KHR_draco_mesh_compression/attributes/{}", Type::whole},

    {"accessors/[]/bufferView", Type::whole},
    {"accessors/[]/byteOffset", Type::size},
    {"accessors/[]/componentType", Type::whole},
    {"accessors/[]/count", Type::size},
    {"accessors/[]/normalized", Type::boolean},
    {"accessors/[]/type", Type::string},
    {"accessors/[]/sparse/count", Type::whole},
    {"accessors/[]/sparse/indices/bufferView", Type::whole},
    {"accessors/[]/sparse/indices/byteOffset", Type::whole},
    {"accessors/[]/sparse/indices/componentType", Type::whole},
    {"accessors/[]/sparse/values/bufferView", Type::whole},
    {"accessors/[]/sparse/values/byteOffset", Type::whole},
    {"bufferViews/[]/buffer", Type::whole},
    {"bufferViews/[]/byteLength", Type::size},
    {"bufferViews/[]/byteOffset", Type::size},
    {"bufferViews/[]/byteStride", Type::whole},
    {"bufferViews/[]/extensions/EXT_meshopt_compression/buffer", Type::whole},
    {"bufferViews/[]/extensions/EXT_meshopt_compression/byteLength", Type::size},
    {"bufferViews/[]/extensions/EXT_meshopt_compression/byteOffset", Type::size},
    {"bufferViews/[]/extensions/EXT_meshopt_compression/byteStride", Type::whole},
    {"bufferViews/[]/extensions/EXT_meshopt_compression/count", Type::size},
    {"bufferViews/[]/extensions/EXT_meshopt_compression/filter", Type::string},
    {"bufferViews/[]/extensions/EXT_meshopt_compression/mode", Type::string},
    {"buffers/[]/byteLength", Type::size},
    {"buffers/[]/uri", Type::string},

    {"materials/[]/name", Type::string},
    {"materials/[]/alphaCutoff", Type::number},
    {"materials/[]/alphaMode", Type::string},
    {"materials/[]/doubleSided", Type::boolean},
    {"materials/[]/emissiveFactor", Type::numbers, 3},
    {"materials/[]/emissiveTexture/index", Type::whole},
    {"materials/[]/emissiveTexture/texCoord", Type::whole},
    {"materials/[]/emissiveTexture/extensions/KHR_texture_transform/offset", Type::numbers, 2},
    {"materials/[]/emissiveTexture/extensions/KHR_texture_transform/rotation", Type::number},
    {"materials/[]/emissiveTexture/extensions/KHR_texture_transform/scale", Type::numbers, 2},
    {"materials/[]/emissiveTexture/extensions/KHR_texture_transform/texCoord", Type::whole},
    {"materials/[]/pbrMetallicRoughness/baseColorFactor", Type::numbers, 4},
    {"materials/[]/pbrMetallicRoughness/baseColorTexture/index", Type::whole},
    {"materials/[]/pbrMetallicRoughness/baseColorTexture/texCoord", Type::whole},
    {"materials/[]/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/offset", Type::numbers, 2},
    {"materials/[]/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/rotation", Type::number},
    {"materials/[]/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/scale", Type::numbers, 2},
    {"materials/[]/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/texCoord", Type::whole},
    {"materials/[]/extensions/KHR_materials_emissive_strength/emissiveStrength", Type::number},
    {"materials/[]/extensions/KHR_materials_unlit", Type::object},
    {"textures/[]/sampler", Type::whole},
    {"textures/[]/source", Type::whole},
    {"textures/[]/extensions/EXT_texture_webp/source", Type::whole},
    {"samplers/[]/magFilter", Type::whole},
    {"samplers/[]/wrapS", Type::whole},
    {"samplers/[]/wrapT", Type::whole},
    {"images/[]/bufferView", Type::whole},
    {"images/[]/mimeType", Type::string},
    {"images/[]/uri", Type::string},

    {"cameras/[]/name", Type::string},
    {"cameras/[]/type", Type::string},
    {"cameras/[]/orthographic/xmag", Type::number},
    {"cameras/[]/orthographic/ymag", Type::number},
    {"cameras/[]/orthographic/zfar", Type::number},
    {"cameras/[]/orthographic/znear", Type::number},
    {"cameras/[]/perspective/yfov", Type::number},
    {"cameras/[]/perspective/zfar", Type::number},
    {"cameras/[]/perspective/znear", Type::number},
    {"extensions/KHR_lights_punctual/lights/[]/name", Type::string},
    {"extensions/KHR_lights_punctual/lights/[]/color", Type::numbers, 3},
    {"extensions/KHR_lights_punctual/lights/[]/intensity", Type::number},
    {"extensions/KHR_lights_punctual/lights/[]/range", Type::number},
    {"extensions/KHR_lights_punctual/lights/[]/spot/innerConeAngle", Type::number},
    {"extensions/KHR_lights_punctual/lights/[]/spot/outerConeAngle", Type::number},
    {"extensions/KHR_lights_punctual/lights/[]/type", Type::string},
};
// clang-format on

class TypeCheck {
 public:
  explicit TypeCheck(const std::string& path) : path_(path) {}

  /// @param place  of the member, from `json` on.
  void check(const GltfJson& json, std::string_view place, const Member& member) {
    if (place.empty()) return check_value(json, member);
    const std::size_t end = std::min(place.find('/'), place.size());
    const std::string_view key = place.substr(0, end);
    const std::string_view rest = place.substr(std::min(end + 1, place.size()));
    if (key == "[]") {
      expect(json.is_array(), "an array", json);
      for (std::size_t i = 0; i < json.size(); ++i) check_at(i, json[i], rest, member);
    } else {
      expect(json.is_object(), "an object", json);
      if (key == "{}") {
        for (const auto& [name, value] : json.items()) check_at(name, value, rest, member);
      } else if (const auto found = json.find(key); found != json.end() && !found->is_null()) {
        check_at(key, *found, rest, member);
      }
    }
  }

 private:
  using Step = std::variant<std::string_view, std::size_t>;

  void check_at(Step step, const GltfJson& json, std::string_view rest, const Member& member) {
    where_.push_back(step);
    check(json, rest, member);
    where_.pop_back();
  }

  void check_value(const GltfJson& json, const Member& member) const {
    switch (member.type) {
      case Type::whole:
        expect(json.is_number_unsigned(), "a whole number of at least 0", json);
        return expect(json.get<std::uint64_t>() <= largest_whole, "a whole number below 2^31", json);
      case Type::size:
        return expect(json.is_number_unsigned(), "a whole number of at least 0", json);
      case Type::number:
        return expect(json.is_number(), "a number", json);
      case Type::numbers:
        return expect(
            json.is_array() && json.size() == member.n &&
                std::all_of(json.begin(), json.end(), [](const GltfJson& x) { return x.is_number(); }),
            fmt::format("{} numbers", member.n), json);
      case Type::boolean:
        return expect(json.is_boolean(), "true or false", json);
      case Type::string:
        return expect(json.is_string(), "a string", json);
      case Type::object:
        return expect(json.is_object(), "an object", json);
    }
  }

  void expect(bool holds, const std::string& expected, const GltfJson& found) const {
    if (holds) return;
    std::string where;
    for (const Step& step : where_)
      if (const auto* key = std::get_if<std::string_view>(&step))
        where += fmt::format("{}{}", where.empty() ? "" : ".", *key);
      else
        where += fmt::format("[{}]", std::get<std::size_t>(step));
    throw IoError(path_, fmt::format("{}: expected {}, found {}", where, expected, shown(found)));
  }

  const std::string& path_;
  std::vector<Step> where_;
};

}  // namespace

void check_gltf_types(const std::string& path, const GltfJson& json) {
  for (const Member& member : members) TypeCheck(path).check(json, member.place, member);
}

}  // namespace lambake
