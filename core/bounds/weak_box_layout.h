#pragma once

#include <cstdint>

#include "core/bounds/volume_layout.h"
#include "core/geometry/weak_tests.h"

namespace raymeter {

enum class BoxTest : std::uint8_t { padded, unpadded, fma };

/// As AabbLayout, for other tests of the same boxes and of what is in them.
template <BoxTest B>
struct WeakBoxLayout {
  static constexpr std::int32_t kFloats = 6;
  struct Shared {
    AabbLayout::Shared boxes;
    TriangleTest triangle;
    SphereTest sphere;
  };
};

}  // namespace raymeter
