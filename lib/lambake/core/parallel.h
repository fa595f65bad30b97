#pragma once

#include <cstddef>
#include <functional>

namespace lambake {

/// Calls `body(begin, end)` over [0, n) in blocks of `block` (the last one shorter), in parallel.
/// The blocks are the same whatever the number of threads, so a sum kept per block and added in the
/// order of the blocks has the same bits on every machine. Exceptions of the body reach the caller.
void parallel_blocks(std::size_t n, std::size_t block,
                     const std::function<void(std::size_t, std::size_t)>& body);

/// Limits every later parallel loop to `n_threads`; 0 means all that the machine has.
void set_thread_count(std::size_t n_threads);

/// The number of threads that parallel loops use now.
std::size_t thread_count();

}  // namespace lambake
