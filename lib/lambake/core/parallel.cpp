#include "lambake/core/parallel.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <memory>

namespace lambake {
namespace {
std::unique_ptr<tbb::global_control> thread_limit;  // NOLINT: tbb's limit is process-wide by design
}

void parallel_blocks(std::size_t n, std::size_t block,
                     const std::function<void(std::size_t, std::size_t)>& body) {
  const std::size_t n_blocks = (n + block - 1) / block;
  if (n_blocks <= 1) {
    if (n > 0) body(0, n);
    return;
  }
  tbb::parallel_for(std::size_t{0}, n_blocks,
                    [&](std::size_t i) { body(i * block, std::min(n, (i + 1) * block)); });
}

void set_thread_count(std::size_t n_threads) {
  thread_limit.reset();
  if (n_threads > 0)
    thread_limit =
        std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, n_threads);
}

std::size_t thread_count() {
  return std::min<std::size_t>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism),
      std::max(1, tbb::info::default_concurrency()));
}

}  // namespace lambake
