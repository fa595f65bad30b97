#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

/// --fail-above METRIC=VALUE.
namespace lambake::tool {

struct Threshold {
  std::string metric;  ///< Dotted path into report.json.
  double value = 0;
};

/// @param texts  "METRIC=VALUE"; a metric without dots is of image.display if that has it.
/// @throws InvalidOption if no report can have such a number. To be asked before any work.
std::vector<Threshold> parse_thresholds(const std::vector<std::string>& texts);

/// Says what was exceeded; returns the exit code.
int check_thresholds(const std::vector<Threshold>& thresholds, const nlohmann::ordered_json& report);

}  // namespace lambake::tool
