#include "lambake/core/version.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "lambake/core/parallel.h"
#include "lambake/core/vector_path.h"

namespace lambake {

std::string version() {
  return LAMBAKE_VERSION;
}

std::string build_info() {
  return fmt::format(
      "build: {}\ncompiler: {}\nflags: {}\nvector path: {} (this machine runs {})\nthreads: {}\n",
      LAMBAKE_BUILD_TYPE, LAMBAKE_COMPILER, LAMBAKE_FLAGS, vector_path(), fmt::join(vector_paths(), ", "),
      thread_count());
}

}  // namespace lambake
