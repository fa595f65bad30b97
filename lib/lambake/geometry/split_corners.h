#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lambake {

/// Gives each corner of a face a vertex whose attributes are its own: the first kind of corner at a vertex
/// keeps the vertex, every other kind gets a copy. Copies are numbered V, V + 1, … in the order they are
/// asked for.
class CornerSplitter {
 public:
  using Key = std::array<std::uint32_t, 3>;  ///< Whatever tells two kinds of corners apart.

  explicit CornerSplitter(std::size_t n_vertices) : first_(n_vertices, none) {}

  /// The vertex of a corner at `vertex` (< V) of kind `key`. O(kinds at the vertex).
  std::uint32_t vertex_for(std::uint32_t vertex, const Key& key);

  /// A further copy of `vertex` (< V) that no kind of corner gets.
  std::uint32_t add_copy(std::uint32_t vertex);

  /// The vertex of each copy.
  const std::vector<std::uint32_t>& copies() const { return copied_; }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;
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
