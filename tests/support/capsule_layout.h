#pragma once

#include <cstdint>

namespace raymeter::test {

/// A fifth kind of bounding volume, to show what one takes: all points within a radius of a segment that is parallel to an axis of the world.
/// centre, half length of the segment, radius, number of the axis.
struct CapsuleLayout {
  static constexpr std::int32_t kFloats = 6;
  struct Shared {};
};

}  // namespace raymeter::test
