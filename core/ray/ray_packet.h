#pragma once

#include <cstdint>

#include "core/ray/views.h"
#include "core/simd/lanes.h"

namespace raymeter {

inline constexpr float kInfinity = __builtin_inff();
inline constexpr float kLargest = 0x1.fffffep127f;
/// The hit id of a lane that has met nothing yet: larger than every primitive, so that ties go to the smaller id.
inline constexpr std::int32_t kNoPrim = 0x7FFFFFFF;

/// One register's worth of rays with what every test needs of them, made once. `shear` and `axis` serve the tests in ray space:
/// axis k[2] is the one of the largest |dir|, k[0] and k[1] follow it cyclically; x' = x_k0 - shear[0] x_k2, y' = x_k1 - shear[1] x_k2, z' = shear[2] x_k2,
/// all after the origin has been subtracted (Woop, Benthin, Wald 2013).
template <class L>
struct RayPacket {
  using Float = typename L::Float;
  using Mask = typename L::Mask;

  Float org[3];
  Float dir[3];      ///< scaled by a power of two so that the largest component is in [1, 2): no square or product of it leaves the range; see dir_unit
  Float t_unit;      ///< that power of two: the ray's own t is t_unit times the packet's, exactly
  Float inv_dir[3];  ///< 1 / dir; infinite where dir is 0, with its sign
  Mask negative[3];  ///< sign bit of dir
  Float t_min;
  Float slab_slack;   ///< absolute growth of slab intervals: relative growth shrinks them where t < 0, which matters only if t_min < 0
  Float inv_length2;  ///< 1 / (dir . dir), in (1/12, 1]
  Float shear[3];
  Float shear_org[3];   ///< org along k[0], k[1], k[2]
  Mask axis_is_y;       ///< k[2] == 1
  Mask axis_is_z;       ///< k[2] == 2
  std::int32_t axis;    ///< k[2] where it is the same in all lanes, else -1
  std::int32_t octant;  ///< sign bits of dir where they are the same in all lanes, else -1
};

/// The power of two in the largest component of RayPacket::dir: 1, but down to 2^-23 of directions that are denormal, since a larger t_unit has no float.
template <class L>
inline typename L::Float dir_unit(const RayPacket<L>& ray) noexcept {
  return L::power_of_two(L::max(L::max(L::abs(ray.dir[0]), L::abs(ray.dir[1])), L::abs(ray.dir[2])));
}

/// The nearest hit so far, in the packet's t. It holds the end of the ray's interval until something is met; a dead lane has t = -inf, which no test can get
/// below.
template <class L>
struct HitPacket {
  typename L::Float t;
  typename L::Int prim;
  typename L::Float u;
  typename L::Float v;
};

/// What a primitive test found: lanes that meet the primitive, where, and the barycentrics.
template <class L>
struct SurfaceHit {
  typename L::Mask meets;
  typename L::Float t;
  typename L::Float u;
  typename L::Float v;
};

/// Lanes whose hit `candidate` improves: inside [t_min, hit.t], and on equal t the smaller id.
template <class L>
inline typename L::Mask improves(const RayPacket<L>& ray, const HitPacket<L>& hit, const SurfaceHit<L>& candidate, std::int32_t prim) noexcept {
  return candidate.meets & (candidate.t >= ray.t_min) & ((candidate.t < hit.t) | ((candidate.t == hit.t) & L::less(typename L::Int(prim), hit.prim)));
}

/// The only place where a hit changes.
template <Query Q, class L>
inline void update(HitPacket<L>& hit, typename L::Mask closer, const SurfaceHit<L>& found, std::int32_t prim) noexcept {
  using Float = typename L::Float;
  hit.prim = L::select(closer, typename L::Int(prim), hit.prim);
  if constexpr (Q == Query::any) {
    hit.t = L::select(closer, Float(-kInfinity), hit.t);
  } else {
    hit.t = L::select(closer, found.t + Float(0.0f), hit.t);  // + 0 turns -0 into +0
    hit.u = L::select(closer, found.u + Float(0.0f), hit.u);
    hit.v = L::select(closer, found.v + Float(0.0f), hit.v);
  }
}

}  // namespace raymeter
