#include "lambake/geometry/split_corners.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>

namespace lambake {
namespace {

TEST(CornerSplitter, AnyNumberOfKindsAtAVertex_EachHasItsOwnCopy) {
  constexpr std::uint32_t n_vertices = 3, n_kinds = 500;
  CornerSplitter splitter(n_vertices);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> ids;
  std::uint32_t n_ids = n_vertices;
  for (int pass = 0; pass < 2; ++pass)
    for (std::uint32_t kind = 0; kind < n_kinds; ++kind)
      for (std::uint32_t v = 0; v < n_vertices; ++v) {
        const std::uint32_t id = splitter.vertex_for(v, {kind, 1, 2, 3});
        // The first keeps the vertex, copies are numbered as they are asked for.
        const auto [place, is_new] = ids.try_emplace({v, kind}, kind == 0 ? v : n_ids);
        n_ids += is_new && kind > 0;
        EXPECT_EQ(id, place->second) << v << " " << kind;
      }
  const std::vector<std::uint32_t> copies = splitter.take_copies();
  ASSERT_EQ(copies.size(), n_vertices * (n_kinds - 1));
  for (std::uint32_t i = 0; i < copies.size(); ++i) EXPECT_EQ(copies[i], i % n_vertices);
}

/// Keys of one kind if their first words are alike in all but the last bit.
struct Halved {
  bool operator()(const CornerSplitter::Key& a, const CornerSplitter::Key& b) const {
    return a[0] / 2 == b[0] / 2;
  }
  std::uint64_t hash(const CornerSplitter::Key& key) const { return key[0] / 8; }  // Some kinds share one.
};

TEST(CornerSplitter, KeysThatAreOfOneKind_ShareAVertex_EvenWhereHashesMeet) {
  CornerSplitter splitter(1);
  for (std::uint32_t i = 0; i < 400; ++i)
    EXPECT_EQ(splitter.vertex_for(0, {i, 0, 0, 0}, Halved{}), i / 2) << i;
}

}  // namespace
}  // namespace lambake
