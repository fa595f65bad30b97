#include "fuzz/allocation_watch.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<std::size_t> largest = 0;  // NOLINT: operator new has nowhere else to tell it
}

// The library is linked statically, so its allocations come here too.
void* operator new(std::size_t size) {
  std::size_t known = largest;
  while (size > known && !largest.compare_exchange_weak(known, size)) {
  }
  if (void* p = std::malloc(size)) return p;  // NOLINT
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept {
  std::free(p);  // NOLINT
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);  // NOLINT
}

namespace lambake {

std::size_t largest_allocation() {
  return largest;
}
void reset_largest_allocation() {
  largest = 0;
}

}  // namespace lambake
