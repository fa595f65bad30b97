#include "lambake/io/light_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <string_view>

#include "lambake/core/error.h"
#include "lambake/io/input_file.h"
#include "lambake/io/json_text.h"

namespace lambake {
namespace {

using nlohmann::json;

/// One light of the document, with the place for messages.
class LightReader {
 public:
  LightReader(const std::string& path, const json& object, std::size_t index)
      : path_(path), object_(object), where_(fmt::format("/lights/{}", index)) {
    if (!object.is_object()) fail("", "an object", object);
  }

  Light read() {
    const json* type = find("type");
    if (type == nullptr || !type->is_string()) fail("/type", "\"directional\", \"point\" or \"spot\"", type);
    const std::string& name = type->get_ref<const std::string&>();
    Light light;
    if (const json* label = find("name")) {
      if (!label->is_string()) fail("/name", "a string", label);
      light.name = *label;
    }
    const glm::vec3 color = vector("color", glm::vec3(1), 0);
    const float intensity = number("intensity", 1, 0);
    light.intensity = LinearRgb{color.r, color.g, color.b} * intensity;
    if (name == "directional") {
      light.type = LightType::directional;
      allow_only({"type", "name", "color", "intensity", "direction_to_light"});
      light.direction_to_light = direction("direction_to_light");
    } else if (name == "point" || name == "spot") {
      light.type = name == "point" ? LightType::point : LightType::spot;
      light.position = vector("position");
      light.decay = number("decay", 2, 0);
      light.range = number("range", 0, 0);
      if (light.type == LightType::point) {
        allow_only({"type", "name", "color", "intensity", "position", "decay", "range"});
      } else {
        allow_only({"type", "name", "color", "intensity", "position", "decay", "range", "direction",
                    "inner_cone_deg", "outer_cone_deg"});
        light.spot_direction = direction("direction");
        constexpr float rad = std::numbers::pi_v<float> / 180;
        light.inner_cone_rad = number("inner_cone_deg", 0, 0) * rad;
        light.outer_cone_rad = number("outer_cone_deg", 45, 0) * rad;
      }
    } else {
      fail("/type", "\"directional\", \"point\" or \"spot\"", type);
    }
    try {
      check_light(light, path_ + ": " + where_);
    } catch (const InvalidOption& error) {  // The number came from a file: its reading failed.
      throw IoError(path_, std::string(error.what()).substr(path_.size() + 2));
    }
    return light;
  }

 private:
  [[noreturn]] void fail(const std::string& key, const std::string& expected, const json& found) const {
    fail(key, expected, &found);
  }
  [[noreturn]] void fail(const std::string& key, const std::string& expected, const json* found) const {
    throw IoError(path_, fmt::format("{}{}: expected {}, found {}", where_, key, expected,
                                     found == nullptr ? "nothing" : shown(*found)));
  }
  const json* find(const char* key) const {
    const auto it = object_.find(key);
    return it == object_.end() ? nullptr : &*it;
  }
  float to_number(const json& value, const std::string& key, double minimum) const {
    const std::string expected =
        std::isinf(minimum) ? "a finite number" : fmt::format("a finite number of at least {}", minimum);
    if (!value.is_number()) fail("/" + key, expected, value);
    const float number = value.get<float>();
    if (!std::isfinite(number) || number < minimum) fail("/" + key, expected, value);
    return number;
  }
  float number(const char* key, float fallback, double minimum) const {
    const json* value = find(key);
    return value == nullptr ? fallback : to_number(*value, key, minimum);
  }
  glm::vec3 vector(const char* key, double minimum = -INFINITY) const {
    const json* value = find(key);
    if (value == nullptr || !value->is_array() || value->size() != 3)
      fail(fmt::format("/{}", key), "three numbers", value);
    glm::vec3 v;
    for (int c = 0; c < 3; ++c)
      v[c] = to_number((*value)[static_cast<std::size_t>(c)], fmt::format("{}/{}", key, c), minimum);
    return v;
  }
  glm::vec3 vector(const char* key, const glm::vec3& fallback, double minimum) const {
    return find(key) == nullptr ? fallback : vector(key, minimum);
  }
  glm::vec3 direction(const char* key) const {
    const glm::dvec3 v(vector(key));
    const double length = glm::length(v);
    if (!(length > 0)) fail(fmt::format("/{}", key), "a direction that is not zero", find(key));
    return glm::vec3(v / length);
  }
  void allow_only(std::initializer_list<std::string_view> keys) const {
    for (const auto& [key, value] : object_.items())
      if (std::find(keys.begin(), keys.end(), key) == keys.end())
        throw IoError(path_, fmt::format("{}: expected one of the keys {}, found {}", where_,
                                         fmt::join(keys, ", "), shown(json(key))));
  }

  const std::string& path_;
  const json& object_;
  std::string where_;
};

}  // namespace

std::vector<Light> read_light_file(const std::string& path) {
  const std::string text = read_bytes(path);
  check_depth(path, text);
  json document;
  std::vector<std::set<std::string>> keys;  // Of the objects around the place, from the outermost on.
  const auto check_key = [&](int, json::parse_event_t event, json& value) {
    if (event == json::parse_event_t::object_start) keys.emplace_back();
    if (event == json::parse_event_t::object_end) keys.pop_back();
    if (event == json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second)
      throw IoError(path, fmt::format("expected each key once in an object, found {} twice", shown(value)));
    return true;
  };
  try {
    document = json::parse(text, check_key);
  } catch (const json::exception& error) {
    throw_no_json(path, error.what());
  }
  if (!document.is_object() || !document.contains("lights") || !document["lights"].is_array())
    throw IoError(path, "expected {\"lights\": [...]}");
  for (const auto& [key, value] : document.items())
    if (key != "lights")
      throw IoError(path, fmt::format("expected no key but \"lights\", found {}", shown(json(key))));
  std::vector<Light> lights;
  for (std::size_t i = 0; i < document["lights"].size(); ++i)
    lights.push_back(LightReader(path, document["lights"][i], i).read());
  return lights;
}

}  // namespace lambake
