#pragma once

#include <cstdint>

namespace raymeter {

// The data of one bounding volume as kernels read it, `kFloats` floats (0: a number known at run time), and what all volumes of a structure share.

/// min x y z, max x y z.
struct AabbLayout {
  static constexpr std::int32_t kFloats = 6;
  struct Shared {
    float reach;  ///< the largest |coordinate| of a box
  };
};

/// centre, radius.
struct SphereLayout {
  static constexpr std::int32_t kFloats = 4;
  struct Shared {};
};

/// centre, three axes, half widths along them, and the sum of these.
struct ObbLayout {
  static constexpr std::int32_t kFloats = 16;
  struct Shared {};
};

/// min, max of each slab in turn.
struct KdopLayout {
  static constexpr std::int32_t kFloats = 0;
  static constexpr std::int32_t kMaxSlabs = 13;
  struct Shared {
    std::int32_t count;  ///< slabs
    float direction[kMaxSlabs][3];
    float length[kMaxSlabs];  ///< of the directions, rounded up
    float origin[3];          ///< slabs are measured from here
    float radius;             ///< all that can be hit is no further from there
  };
};

}  // namespace raymeter
