#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "lambake/core/finding.h"
#include "lambake/measure/select.h"

/// Parts of several JSON documents; internal to report and tool. Numbers that are not finite, which JSON has
/// not, become null as text: the schemas say what that means for each key.
namespace lambake {

nlohmann::ordered_json findings_json(const Findings& findings);
/// Of stages in order; what one of them took several times is added up.
nlohmann::ordered_json seconds_json(const std::vector<std::pair<std::string, double>>& stages);
nlohmann::ordered_json trials_json(const std::vector<MethodTrial>& trials);

/// Indented. Names of files and lights need not be UTF-8: other bytes become U+FFFD.
std::string json_text(const nlohmann::ordered_json& json);

}  // namespace lambake
