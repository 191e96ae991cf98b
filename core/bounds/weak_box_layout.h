#pragma once

#include <cstdint>

#include "core/bounds/volume_layout.h"
#include "core/geometry/unit_triangle_layout.h"
#include "core/geometry/weak_tests.h"

namespace raymeter {

enum class BoxTest : std::uint8_t { padded, grown, unpadded, fma, quotient };

/// How box tests come by 1 / d, once a packet: the quotient, the processor's estimate after one of Newton's steps, or the estimate alone.
enum class Reciprocal : std::uint8_t { divide, newton, estimate };

/// As AabbLayout, for other tests of the same boxes and of what is in them.
template <BoxTest B>
struct WeakBoxLayout {
  static constexpr std::int32_t kFloats = 6;
  struct Shared {
    AabbLayout::Shared boxes;
    TriangleTest triangle;
    float triangle_epsilon;  ///< of the sum of a triangle's weights
    SphereTest sphere;
    Reciprocal reciprocal;
    float shrink, grow;  ///< grown, quotient: factors of the ends of slab intervals, 1 -+ the padding
    UnitTriangleView unit_triangles;
  };
};

}  // namespace raymeter
