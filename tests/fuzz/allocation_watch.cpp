#include "fuzz/allocation_watch.h"

#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>

namespace {
// NOLINTBEGIN: operator new has nowhere else to tell it
std::atomic<std::size_t> largest = 0, live = 0, live_at_reset = 0, peak = 0;
// NOLINTEND

void raise(std::atomic<std::size_t>& to, std::size_t value) {
  std::size_t known = to;
  while (value > known && !to.compare_exchange_weak(known, value)) {
  }
}
void release(void* p) {
  live -= malloc_usable_size(p);
  std::free(p);  // NOLINT
}
}  // namespace

// The library is linked statically, so its allocations come here too.
void* operator new(std::size_t size) {
  raise(largest, size);
  if (void* p = std::malloc(size)) {  // NOLINT
    raise(peak, live += malloc_usable_size(p));
    return p;
  }
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept {
  release(p);
}
void operator delete(void* p, std::size_t) noexcept {
  release(p);
}

namespace lambake {

std::size_t largest_allocation() {
  return largest;
}
void reset_largest_allocation() {
  largest = 0;
}

std::size_t peak_of_allocations() {
  return peak - live_at_reset;
}
void reset_peak_of_allocations() {
  live_at_reset = peak = live.load();
}

}  // namespace lambake
