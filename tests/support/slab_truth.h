#pragma once

// Whether rays really meet a convex volume between pairs of parallel planes, or a ball; exact, by the numbers of the oracle.

#include <optional>
#include <vector>

#include "core/ray/ray_batch.h"
#include "experiments/verify/true_hits.h"

namespace raymeter::test {

/// All x with low <= normal . (x - origin) <= high.
struct Slab {
  float normal[3];
  float origin[3];
  float low, high;
};

/// t >= 0, the ray's ends are not looked at.
inline bool truly_meets(const Ray& ray, const std::vector<Slab>& slabs) {
  using namespace verify;
  return decide(Arithmetic::filtered, [&]<class N>() {
    const Vec<N> org = vec<N>(ray.org), dir = vec<N>(ray.dir);
    N near(0.0);
    std::optional<N> far;
    for (const Slab& slab : slabs) {
      const Vec<N> normal = vec<N>(slab.normal);
      const N height = dot(normal, org - vec<N>(slab.origin)), slope = dot(normal, dir);
      const N below = N(double{slab.low}) - height, above = N(double{slab.high}) - height;
      if (sign(slope) == 0) {
        if (sign(below) > 0 || sign(above) < 0) return false;
        continue;
      }
      const N first = (sign(slope) > 0 ? below : above) / slope, last = (sign(slope) > 0 ? above : below) / slope;
      near = larger(near, first);
      far = far ? smaller(*far, last) : last;
    }
    return !far || sign(N(*far - near)) >= 0;
  });
}

inline bool truly_meets_ball(const Ray& ray, const float (&center)[3], float radius) {
  using namespace verify;
  return decide(Arithmetic::filtered, [&]<class N>() {
    const Vec<N> from = vec<N>(ray.org) - vec<N>(center), dir = vec<N>(ray.dir);
    const Vec<N> moment = cross(from, dir);
    const N radius2 = N(double{radius}) * N(double{radius});
    if (sign(N(radius2 * dot(dir, dir) - dot(moment, moment))) < 0) return false;
    return sign(dot(from, dir)) <= 0 || sign(N(radius2 - dot(from, from))) >= 0;
  });
}

}  // namespace raymeter::test
