#include "lambake/core/finding.h"

#include <utility>

namespace lambake {

std::string in_number(std::size_t n, std::string text) {
  for (std::size_t open = text.find('['); open != std::string::npos; open = text.find('[', open + 1)) {
    const std::size_t close = text.find(']', open), bar = text.find('|', open);
    if (close == std::string::npos || bar > close) continue;  // No choice: [0,1].
    const std::string chosen =
        n == 1 ? text.substr(open + 1, bar - open - 1) : text.substr(bar + 1, close - bar - 1);
    text.replace(open, close + 1 - open, chosen);
  }
  return text;
}

void add_finding(Findings& findings, std::string code, std::size_t count, std::string text) {
  if (count > 0) findings.push_back({std::move(code), count, in_number(count, std::move(text))});
}

}  // namespace lambake
