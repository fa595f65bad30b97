#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "console.h"

namespace lambake::tool {

nlohmann::ordered_json findings_json(const Findings& findings);
nlohmann::ordered_json seconds_json(const Stopwatch& stopwatch);

/// Indented; bytes that are no UTF-8 (from file names) become U+FFFD.
std::string json_text(const nlohmann::ordered_json& json);

}  // namespace lambake::tool
