#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "lambake/core/hash.h"

namespace lambake {

/// Gives each corner of a face a vertex whose attributes are its own: the first kind of corner at a vertex
/// keeps the vertex, every other kind gets a copy. Copies are numbered V, V + 1, … in the order they are
/// asked for.
class CornerSplitter {
 public:
  using Key = std::array<std::uint32_t, 4>;  ///< Whatever tells two kinds of corners apart.

  /// Equal keys are of one kind.
  struct Equal {
    bool operator()(const Key& a, const Key& b) const { return a == b; }
    std::uint64_t hash(const Key& key) const {
      std::uint64_t h = 0;
      for (const std::uint32_t word : key) h = mixed(h, word);
      return h;
    }
  };

  explicit CornerSplitter(std::size_t n_vertices) : first_(n_vertices, none) {
    kinds_.reserve(n_vertices);  // Most vertices have one.
  }

  /// The vertex of a corner at `vertex` (< V) of kind `key`.
  /// @param is_same  whether two keys are of one kind; its `hash` is alike for those that are.
  template <typename IsSame = Equal>
  std::uint32_t vertex_for(std::uint32_t vertex, const Key& key, const IsSame& is_same = {}) {
    std::uint32_t last = none;
    std::size_t n = 0;
    for (std::uint32_t k = first_[vertex]; k != none; k = kinds_[k].next, ++n) {
      if (is_same(kinds_[k].key, key)) return kinds_[k].id;
      last = k;
    }
    if (n < longest_chain) return add_kind(vertex, key, last);
    const std::uint64_t hash = mixed(is_same.hash(key), vertex);
    const auto [begin, end] = further_.equal_range(hash);
    for (auto it = begin; it != end; ++it) {
      const Kind& kind = kinds_[it->second];
      if (vertex_of_copy(kind.id) == vertex && is_same(kind.key, key)) return kind.id;
    }
    return add_further_kind(vertex, key, hash);
  }

  /// The vertex of each copy; takes them away.
  std::vector<std::uint32_t> take_copies() { return std::move(copied_); }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;
  static constexpr std::size_t longest_chain = 32;
  /// @param last  index of the vertex's last kind, or none.
  std::uint32_t add_kind(std::uint32_t vertex, const Key& key, std::uint32_t last);

  std::uint32_t add_further_kind(std::uint32_t vertex, const Key& key, std::uint64_t hash);
  std::uint32_t vertex_of_copy(std::uint32_t id) const { return copied_[id - first_.size()]; }

  struct Kind {
    Key key;
    std::uint32_t id;    // The vertex or copy that this kind has.
    std::uint32_t next;  // Index of the vertex's next kind.
  };
  std::vector<std::uint32_t> first_;  // V: index of the vertex's first kind.
  std::vector<Kind> kinds_;
  std::unordered_multimap<std::uint64_t, std::uint32_t> further_;  // Kinds beyond those of a chain, by hash.
  std::vector<std::uint32_t> copied_;
};

}  // namespace lambake
