#include "lambake/geometry/split_corners.h"

namespace lambake {

std::uint32_t CornerSplitter::vertex_for(std::uint32_t vertex, const Key& key) {
  std::uint32_t last = none;
  for (std::uint32_t k = first_[vertex]; k != none; k = kinds_[k].next) {
    if (kinds_[k].key == key) return kinds_[k].id;
    last = k;
  }
  const auto kind = static_cast<std::uint32_t>(kinds_.size());
  if (last == none) {
    first_[vertex] = kind;
    kinds_.push_back({key, vertex, none});
  } else {
    kinds_[last].next = kind;
    kinds_.push_back({key, add_copy(vertex), none});
  }
  return kinds_[kind].id;
}

std::uint32_t CornerSplitter::add_copy(std::uint32_t vertex) {
  copied_.push_back(vertex);
  return static_cast<std::uint32_t>(first_.size() + copied_.size() - 1);
}

}  // namespace lambake
