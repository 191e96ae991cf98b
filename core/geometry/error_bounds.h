#pragma once

// The conservative contract in numbers. Every primitive kernel promises that the point P = org + t dir of a hit that it accepts (dir and org as given, t as
// returned, arithmetic exact) lies, on each axis, no further outside the primitive's exact bounding box than
//     kPrimitiveError * (|P - org| + magnitude)        with |P - org| along that axis and magnitude the largest |coordinate| of the box on it,
// and every volume and cell is made or tested so that it cannot cull such a hit: built boxes grow by kBoundsPadding * magnitude, and slab intervals by
// kSlabPadding relative to t. Then pruning never changes an answer. The kernels say why they keep the promise.

namespace raymeter {

inline constexpr float kUnitRoundoff = 0x1p-24f;
/// A hit's distance outside its primitive's box, relative: 8 roundings.
inline constexpr float kPrimitiveError = 8 * kUnitRoundoff;
/// Growth of a built volume relative to its magnitude; twice the error, since the slab test's own rounding is to be covered too.
inline constexpr float kBoundsPadding = 16 * kUnitRoundoff;
/// Growth of a slab interval [t_near, t_far] relative to its ends.
inline constexpr float kSlabPadding = 16 * kUnitRoundoff;

}  // namespace raymeter
