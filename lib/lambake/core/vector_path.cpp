#include "lambake/core/vector_path.h"

#include <hwy/highway.h>

#include <cstdint>

#include "lambake/core/error.h"

namespace lambake {
namespace {

std::vector<std::int64_t> runnable_targets() {
  std::vector<std::int64_t> targets;
  for (std::int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1)
    targets.push_back(left & -left);  // Highway gives better targets lower bits
  return targets;
}

}  // namespace

std::vector<std::string> vector_paths() {
  std::vector<std::string> names;
  for (const std::int64_t target : runnable_targets()) names.emplace_back(hwy::TargetName(target));
  return names;
}

std::string vector_path() {
  return vector_paths().front();
}

void choose_vector_path(const std::string& name) {
  hwy::SetSupportedTargetsForTest(0);
  for (const std::int64_t target : runnable_targets()) {
    if (!name.empty() && name != hwy::TargetName(target)) continue;
    if (!name.empty()) hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return;
  }
  throw InvalidOption("vector path: this machine has no " + name);
}

}  // namespace lambake
