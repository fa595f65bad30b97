#include "thresholds.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>

#include "console.h"
#include "lambake/core/error.h"
#include "lambake/report/report.h"
#include "options.h"

namespace lambake::tool {
namespace {

Threshold parse_threshold(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw InvalidOption(fmt::format("--fail-above: expected METRIC=VALUE, found \"{}\"", text));
  return {text.substr(0, equals), parse_quotient("--fail-above", text.substr(equals + 1))};
}

/// Whether null stands for infinity, which JSON does not have, rather than for nothing.
bool can_be_infinite(const std::string& path) {
  return path.starts_with("surface.") || path.starts_with("trials.");
}

/// The number that a path names, or null if there is none.
const nlohmann::ordered_json* find_number(const nlohmann::ordered_json& report, const std::string& path) {
  const nlohmann::ordered_json* value = &report;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const std::string_view name = std::string_view(path).substr(begin, end - begin);
    std::size_t i = 0;
    const char* const name_end = name.data() + name.size();
    if (value->is_object() && value->contains(name))
      value = &value->at(name);
    else if (const auto number = std::from_chars(name.data(), name_end, i);
             value->is_array() && number.ec == std::errc() && number.ptr == name_end && i < value->size())
      value = &value->at(i);
    else
      return nullptr;
    begin = end + 1;
  }
  return value->is_number() || (value->is_null() && can_be_infinite(path)) ? value : nullptr;
}

/// Errors on screen lie in [0,1]: a larger threshold was meant in steps of 1/255.
bool is_error_on_screen(const std::string& metric) {
  for (const char* of : {"image.display.", "surface.display."})
    for (const char* name : {"rmse", "mae", "mean", "max", "p99", "max_sampled", "max_bound"})
      if (metric == std::string(of) + name) return true;
  return false;
}

[[noreturn]] void fail_without(const std::string& metric) {
  throw InvalidOption(fmt::format("--fail-above: report.json has no number \"{}\"", metric));
}

/// A report with what only some have.
nlohmann::ordered_json fullest_report() {
  Comparison all;
  all.image_linear.pixels = all.image_display.pixels = 1;
  all.max_bound_linear = all.max_bound_display = 0;
  all.surface_display.worst.resize(1);
  all.light_shares.resize(1);
  all.trials.resize(1);
  return nlohmann::ordered_json::parse(report_json(all));
}

}  // namespace

std::vector<Threshold> parse_thresholds(const std::vector<std::string>& texts) {
  std::vector<Threshold> thresholds;
  for (const std::string& text : texts) thresholds.push_back(parse_threshold(text));
  const nlohmann::ordered_json report = fullest_report();
  for (Threshold& threshold : thresholds) {
    const std::string on_screen = "image.display." + threshold.metric;
    if (threshold.metric.find('.') == std::string::npos && find_number(report, on_screen) != nullptr)
      threshold.metric = on_screen;
    if (threshold.metric.ends_with("psnr_db"))
      throw InvalidOption("--fail-above psnr_db: expected an error; more of this is better, take rmse");
    if (find_number(report, threshold.metric) == nullptr) fail_without(threshold.metric);
    if (threshold.value > 1 && is_error_on_screen(threshold.metric))
      throw InvalidOption(
          fmt::format("--fail-above {}: expected a value of at most 1, where the brightest is 1, found {} "
                      "(in steps: {}/255)",
                      threshold.metric, threshold.value, threshold.value));
  }
  return thresholds;
}

int check_thresholds(const std::vector<Threshold>& thresholds, const nlohmann::ordered_json& report) {
  int exit_code = 0;
  for (const Threshold& threshold : thresholds) {
    const bool is_of_picture = threshold.metric.starts_with("image.");
    if (is_of_picture && report["image"]["display"]["pixels"] == 0) {
      print_error(fmt::format("lambake: {} has no value, as the picture shows nothing of the model\n",
                              threshold.metric));
      exit_code = 1;
      continue;
    }
    const auto* const value = find_number(report, threshold.metric);
    if (value == nullptr) fail_without(threshold.metric);
    double found = value->is_null() ? INFINITY : value->get<double>();
    if (threshold.metric.ends_with(".mean")) found = std::abs(found);  // Too dark is as bad as too bright.
    if (!(found > threshold.value)) continue;
    print_error(fmt::format("lambake: {} is {}, above {}\n", threshold.metric, found, threshold.value));
    exit_code = 1;
  }
  return exit_code;
}

}  // namespace lambake::tool
