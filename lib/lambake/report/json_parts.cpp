#include "lambake/report/json_parts.h"

namespace lambake {

nlohmann::ordered_json findings_json(const Findings& findings) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Finding& f : findings) json.push_back({{"code", f.code}, {"count", f.count}, {"text", f.text}});
  return json;
}

nlohmann::ordered_json seconds_json(const std::vector<std::pair<std::string, double>>& stages) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const auto& [stage, seconds] : stages) json[stage] = json.value(stage, 0.0) + seconds;
  return json;
}

nlohmann::ordered_json trials_json(const std::vector<MethodTrial>& trials) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const MethodTrial& t : trials)
    json.push_back({{"method", name_of(t.method)},
                    {"vertices", t.n_vertices},
                    {"triangles", t.n_triangles},
                    {"bytes", t.bytes},
                    {"seconds", t.seconds},
                    {"rmse", t.rmse},
                    {"max_sampled", t.max_found},
                    {"max_bound", t.max_bound},
                    {"certified", t.is_certified}});
  return json;
}

std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace lambake
