#pragma once

// One ray against primitives in lanes: what it meets, and the nearest of that.

#include "core/ray/ray_packet.h"
#include "core/stats/policy.h"

namespace raymeter {

/// One ray and a register of a leaf's primitives: lane i is primitive `first` + i of the leaf.
template <class L>
struct LeafHits {
  SurfaceHit<L> surface;
  std::uint32_t closer;  ///< lanes that the ray meets inside its interval
  std::int32_t first;
};

/// The nearest hit that one ray has, in a form of its own.
struct RayHit {
  float t;
  std::int32_t prim;
  float u;
  float v;
};

/// `hit` becomes the nearest, ties to the smaller id; `prim` are the leaf's ids, `before` the hit that the leaf found.
template <class L, class Stats>
[[gnu::always_inline]] inline void take_nearest(const LeafHits<L>& found, const std::int32_t* prim_of_leaf, const RayHit& before, RayHit& hit,
                                                Stats stats) noexcept {
  using Float = typename L::Float;
  if (found.closer == 0) return;
  alignas(64) float t[L::kWidth], u[L::kWidth], v[L::kWidth];
  L::store(t, found.surface.t);
  L::store(u, found.surface.u + Float(0.0f));
  L::store(v, found.surface.v + Float(0.0f));
  std::uint32_t counted = 0;
  for (std::uint32_t left = found.closer; left != 0; left &= left - 1) {
    const int lane = __builtin_ctz(left);
    const std::int32_t prim = prim_of_leaf[found.first + lane];
    if (t[lane] == before.t && prim >= before.prim) continue;
    counted |= 1u << lane;
    if (t[lane] < hit.t || (t[lane] == hit.t && prim < hit.prim)) hit = {t[lane] + 0.0f, prim, u[lane], v[lane]};
  }
  if (counted != 0) stats.template count<Event::prim_hit, L>(L::mask(counted));
}

}  // namespace raymeter
