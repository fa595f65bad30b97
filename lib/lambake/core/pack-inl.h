// Included by each vector path: the guard lets it in once for each.
#if defined(LAMBAKE_CORE_PACK_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LAMBAKE_CORE_PACK_INL_H
#undef LAMBAKE_CORE_PACK_INL_H
#else
#define LAMBAKE_CORE_PACK_INL_H
#endif

#include <hwy/highway.h>

#include "lambake/core/pack.h"

HWY_BEFORE_NAMESPACE();
namespace lambake::HWY_NAMESPACE {

/// Moves the marked lanes of vectors of 32 bit to the front, in their order; what follows is anything.
///
/// Vectors of at most 8 lanes take their order from a table. Highway's own Compress, which wider ones take,
/// has the table on the stack where g++ copies it there each time: 10 times slower.
template <class Tag>
class Packing {
 public:
  HWY_INLINE Packing(Tag tag, hwy::HWY_NAMESPACE::Mask<Tag> mask) : mask_(mask) {
    if constexpr (has_table) {
      std::uint8_t bits[8] = {};
      hwy::HWY_NAMESPACE::StoreMaskBits(tag, mask, bits);
      order_ = packed_lanes[bits[0]].data();
    }
  }

  template <class V>
  HWY_INLINE V operator()(V v) const {
    namespace hn = hwy::HWY_NAMESPACE;
    const hn::DFromV<V> tag;
    if constexpr (has_table)
      return hn::TableLookupLanes(
          v, hn::IndicesFromVec(tag, hn::LoadU(hn::RebindToUnsigned<decltype(tag)>(), order_)));
    else
      return hn::Compress(v, hn::RebindMask(tag, mask_));
  }

 private:
  static constexpr bool has_table = hwy::HWY_NAMESPACE::MaxLanes(Tag()) <= 8;
  hwy::HWY_NAMESPACE::Mask<Tag> mask_;
  const std::uint32_t* order_ = nullptr;
};

}  // namespace lambake::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
