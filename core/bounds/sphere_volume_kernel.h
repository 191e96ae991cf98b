#pragma once

// Rays against a bounding sphere. As for spheres that are primitives, all is measured at the closest approach (Haines et al. 2019), where nothing cancels.
//
// No false misses, u = kUnitRoundoff, F = org - centre, r the radius: a hit P is within r + 32 u |P - org| of the centre (kSurfaceError), and
// |P - org| <= |F| + r up to roundings, so within r1 = r + 34 u (|F| + r). The radius of the test is r2 = r + 64 u (|F|_1 + r): its square leaves more than
// 60 u (|F| + r) r1 for the errors of the vector across (4 roundings of |F|, and 10 of |F| along the ray, which count in second order) and of the squares
// (3 roundings of r2^2). The interval about the closest approach grows by 16 u (|F|_1 + r) more for the errors along the ray; dir is at least as long as 1.
// Overflow to infinity: where the vector across overflows the sphere is missed; an infinite r2 gives a NaN, which means that nothing is known.
// Underflow: r2 is at least 2^-60, whose square is a normal number.

#include "core/bounds/volume_test_kernel.h"

namespace raymeter {

template <class L>
struct VolumeRays<SphereLayout, L> {
  static constexpr bool kSigned = false;
  void prepare(const SphereLayout::Shared&, const RayPacket<L>&) noexcept {}
};

template <class L, bool kUniform>
struct VolumeTest<SphereLayout, L, kUniform> {
  using Float = typename L::Float;
  Float center[3];
  Float radius;

  [[gnu::always_inline]] VolumeTest(const SphereLayout::Shared&, const float* data, std::int32_t) noexcept
      : center{Float(data[0]), Float(data[1]), Float(data[2])}, radius(data[3]) {}

  [[nodiscard]] [[gnu::always_inline]] SlabInterval<L> line(const RayPacket<L>& ray, const VolumeRays<SphereLayout, L>&) const noexcept {
    const Float f[3] = {ray.org[0] - center[0], ray.org[1] - center[1], ray.org[2] - center[2]};
    const Float size = L::abs(f[0]) + L::abs(f[1]) + (L::abs(f[2]) + radius);
    const Float grown = L::mul_add(size, Float(64 * kUnitRoundoff), L::max(radius, Float(0x1p-60f)));
    const Float closest = -L::mul_add(f[2], ray.dir[2], L::mul_add(f[1], ray.dir[1], f[0] * ray.dir[0])) * ray.inv_length2;
    Float across2(0.0f);
    for (int a = 0; a < 3; ++a) {
      const Float across = L::mul_add(closest, ray.dir[a], f[a]);
      across2 = L::mul_add(across, across, across2);
    }
    const Float chord2 = grown * grown - across2;
    const Float half = L::mul_add(size, Float(16 * kUnitRoundoff), L::sqrt(chord2 * ray.inv_length2));
    return {L::select(chord2 < Float(0.0f), Float(kInfinity), closest - half), closest + half};
  }
};

}  // namespace raymeter
