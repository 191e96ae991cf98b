#pragma once

#include <cstdint>

namespace raymeter {

/// Rays per packet, at most.
inline constexpr int kMaxPacket = 64;

/// Closest: keeps the nearest hit, ties to the smaller id. Any: the first one found blocks the ray, which is dead then.
enum class Query : std::uint8_t { closest, any };

/// Columns of `count` rays: origin, direction (not normalised: t is in its units), closed interval [t_min, t_max].
/// Each column may be read kMaxPacket elements past its end.
struct RayView {
  const float* org[3];
  const float* dir[3];
  const float* t_min;
  const float* t_max;
  std::int32_t count;
};

/// Columns of `count` nearest hits. A miss is t = inf, prim = -1. u, v are the barycentrics of a triangle's vertices 1 and 2, else 0.
struct HitView {
  float* t;
  std::int32_t* prim;
  float* u;
  float* v;
  std::int32_t count;
};

}  // namespace raymeter
