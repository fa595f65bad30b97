#include "json_text.h"

namespace lambake::tool {

nlohmann::ordered_json findings_json(const Findings& findings) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Finding& f : findings) json.push_back({{"code", f.code}, {"count", f.count}, {"text", f.text}});
  return json;
}

nlohmann::ordered_json seconds_json(const Stopwatch& stopwatch) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const auto& [stage, seconds] : stopwatch.seconds()) json[stage] = seconds;
  return json;
}

std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace lambake::tool
