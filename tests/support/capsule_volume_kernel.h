#pragma once

// Rays against a capsule: the cylinder about its axis, cut off where its caps end. As for spheres, the radius grows by 64 u (|F|_1 + r + h), F = org - centre,
// which is more than hits and arithmetic may be off (core/bounds/sphere_volume_kernel.h); rays along the axis are told nothing by the cylinder.

#include "core/bounds/volume_test_kernel.h"
#include "tests/support/capsule_layout.h"

namespace raymeter {

template <class L>
struct VolumeRays<test::CapsuleLayout, L> {
  static constexpr bool kSigned = false;
  void prepare(const test::CapsuleLayout::Shared&, const RayPacket<L>&) noexcept {}
};

template <class L, bool kUniform>
struct VolumeTest<test::CapsuleLayout, L, kUniform> {
  using Float = typename L::Float;
  const float* capsule;

  VolumeTest(const test::CapsuleLayout::Shared&, const float* data, std::int32_t) noexcept : capsule(data) {}

  [[nodiscard]] SlabInterval<L> line(const RayPacket<L>& ray, const VolumeRays<test::CapsuleLayout, L>&) const noexcept {
    const auto along = static_cast<std::int32_t>(capsule[5]);
    const std::int32_t y = (along + 1) % 3, z = (along + 2) % 3;
    const Float f[3] = {ray.org[0] - Float(capsule[0]), ray.org[1] - Float(capsule[1]), ray.org[2] - Float(capsule[2])};
    const Float half(capsule[3]), radius(capsule[4]);
    const Float size = L::abs(f[0]) + L::abs(f[1]) + L::abs(f[2]) + radius + half;
    const Float grown = L::mul_add(size, Float(64 * kUnitRoundoff), radius);

    const Float reach = half + grown;
    const Float enter = (L::select(ray.negative[along], reach, -reach) - f[along]) * ray.inv_dir[along];
    const Float leave = (L::select(ray.negative[along], -reach, reach) - f[along]) * ray.inv_dir[along];

    const Float speed2 = L::mul_add(ray.dir[z], ray.dir[z], ray.dir[y] * ray.dir[y]);
    const Float closest = -L::mul_add(f[z], ray.dir[z], f[y] * ray.dir[y]) / speed2;
    const Float across_y = L::mul_add(closest, ray.dir[y], f[y]), across_z = L::mul_add(closest, ray.dir[z], f[z]);
    const Float chord2 = grown * grown - L::mul_add(across_z, across_z, across_y * across_y);
    const Float half_chord = (L::sqrt(L::max(chord2, Float(0.0f))) + Float(16 * kUnitRoundoff) * size) / L::sqrt(speed2);
    const auto lengthwise = speed2 < Float(0x1p-40f);
    const Float first = L::select(lengthwise, Float(-kInfinity), L::select(chord2 < Float(0.0f), Float(kInfinity), closest - half_chord));
    const Float last = L::select(lengthwise, Float(kInfinity), closest + half_chord);
    return {L::max(enter, first), L::min(leave, last)};
  }
};

}  // namespace raymeter
