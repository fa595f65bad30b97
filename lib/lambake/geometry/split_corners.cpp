#include "lambake/geometry/split_corners.h"

namespace lambake {

std::uint32_t CornerSplitter::add_kind(std::uint32_t vertex, const Key& key, std::uint32_t last) {
  const auto kind = static_cast<std::uint32_t>(kinds_.size());
  if (last == none) {
    first_[vertex] = kind;
    kinds_.push_back({key, vertex, none});
  } else {
    kinds_[last].next = kind;
    kinds_.push_back({key, static_cast<std::uint32_t>(first_.size() + copied_.size()), none});
    copied_.push_back(vertex);
  }
  return kinds_[kind].id;
}

std::uint32_t CornerSplitter::add_further_kind(std::uint32_t vertex, const Key& key, std::uint64_t hash) {
  further_.emplace(hash, static_cast<std::uint32_t>(kinds_.size()));
  kinds_.push_back({key, static_cast<std::uint32_t>(first_.size() + copied_.size()), none});
  copied_.push_back(vertex);
  return kinds_.back().id;
}

}  // namespace lambake
