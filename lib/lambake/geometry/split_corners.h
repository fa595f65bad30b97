#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace lambake {

/// Gives each corner of a face a vertex whose attributes are its own: the first kind of corner at a vertex
/// keeps the vertex, every other kind gets a copy. Copies are numbered V, V + 1, … in the order they are
/// asked for.
class CornerSplitter {
 public:
  using Key = std::array<std::uint32_t, 4>;  ///< Whatever tells two kinds of corners apart.

  explicit CornerSplitter(std::size_t n_vertices) : first_(n_vertices, none) {
    kinds_.reserve(n_vertices);  // Most vertices have one.
  }

  /// The vertex of a corner at `vertex` (< V) of kind `key`. O(kinds at the vertex).
  /// @param is_same  whether two keys are of one kind, if other keys than equal ones are.
  template <typename IsSame = std::equal_to<Key>>
  std::uint32_t vertex_for(std::uint32_t vertex, const Key& key, IsSame&& is_same = {}) {
    std::uint32_t last = none;
    for (std::uint32_t k = first_[vertex]; k != none; k = kinds_[k].next) {
      if (is_same(kinds_[k].key, key)) return kinds_[k].id;
      last = k;
    }
    return add_kind(vertex, key, last);
  }

  /// The vertex of each copy; takes them away.
  std::vector<std::uint32_t> take_copies() { return std::move(copied_); }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;
  /// @param last  index of the vertex's last kind, or none.
  std::uint32_t add_kind(std::uint32_t vertex, const Key& key, std::uint32_t last);

  struct Kind {
    Key key;
    std::uint32_t id;    // The vertex or copy that this kind has.
    std::uint32_t next;  // Index of the vertex's next kind.
  };
  std::vector<std::uint32_t> first_;  // V: index of the vertex's first kind.
  std::vector<Kind> kinds_;
  std::vector<std::uint32_t> copied_;
};

}  // namespace lambake
