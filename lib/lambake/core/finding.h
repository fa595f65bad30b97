#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace lambake {

/// Something about the user's data that must not stay silent: repaired, dropped, kept though odd, or
/// not representable in an output. Told on standard error, in report.json and on the page.
struct Finding {
  std::string code;       ///< Stable key in snake_case, e.g. "zero_area_faces".
  std::size_t count = 0;  ///< How many; a finding of 0 is not made.
  std::string text;  ///< One sentence for people, without the count, e.g. "faces have no area; kept, unlit".
};

using Findings = std::vector<Finding>;

/// Appends the finding if there is anything to tell.
inline void add_finding(Findings& findings, std::string code, std::size_t count, std::string text) {
  if (count > 0) findings.push_back({std::move(code), count, std::move(text)});
}

}  // namespace lambake
