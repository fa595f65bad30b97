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

/// `text` with each "[one|many]" as `n` of them need it: "vert[ex is|ices are] in no face".
std::string in_number(std::size_t n, std::string text);

/// Appends the finding if there is anything to tell. @param text  in the form of in_number().
void add_finding(Findings& findings, std::string code, std::size_t count, std::string text);

}  // namespace lambake
