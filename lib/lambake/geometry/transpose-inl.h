/// From four numbers of each thing, one thing behind the other, to vectors of the first number, the second, …
/// of many things. Included by each vector path: the guard lets it in once for each.
#if defined(LAMBAKE_GEOMETRY_TRANSPOSE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LAMBAKE_GEOMETRY_TRANSPOSE_INL_H
#undef LAMBAKE_GEOMETRY_TRANSPOSE_INL_H
#else
#define LAMBAKE_GEOMETRY_TRANSPOSE_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using F = hn::Vec<Floats>;

#if HWY_TARGET != HWY_SCALAR
struct FourVectors {
  F a, b, c, d;
};

/// Each quarter of 16 bytes is transposed by itself, so that nothing moves between the quarters: where
/// vectors are of several things in turn, of their first numbers those of things 0, 4, 8 and 12 come first
/// (of two quarters things 0, 2, 4 and 6), then those of 1, 5, 9 and 13. The same is the way back.
HWY_INLINE FourVectors transposed(const FourVectors& v) {
  const Floats f;
  const hn::RepartitionToWide<Floats> pairs;
  const auto low_ab = hn::BitCast(pairs, hn::InterleaveLower(f, v.a, v.b)),
             low_cd = hn::BitCast(pairs, hn::InterleaveLower(f, v.c, v.d)),
             high_ab = hn::BitCast(pairs, hn::InterleaveUpper(f, v.a, v.b)),
             high_cd = hn::BitCast(pairs, hn::InterleaveUpper(f, v.c, v.d));
  return {hn::BitCast(f, hn::InterleaveLower(pairs, low_ab, low_cd)),
          hn::BitCast(f, hn::InterleaveUpper(pairs, low_ab, low_cd)),
          hn::BitCast(f, hn::InterleaveLower(pairs, high_ab, high_cd)),
          hn::BitCast(f, hn::InterleaveUpper(pairs, high_ab, high_cd))};
}
#endif

}  // namespace
}  // namespace lambake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
