#pragma once

// One ray against the triangles of a block, triangles in lanes, by the test of core/geometry/triangle_kernel.h. Where lanes can be permuted the block's
// vertices are brought into the ray's space once, and from there to the triangles that share them.

#include "accel/bvh/single_ray_kernel.h"
#include "core/geometry/triangle_kernel.h"
#include "core/simd/shuffle_kernel.h"

namespace raymeter {

/// What a ray has met.
struct SingleHit {
  float t;  ///< the end of its interval until something is met; -inf once any hit has ended it
  std::int32_t prim = kNoPrim;
  float u = 0;
  float v = 0;
};

/// What brings vertices into a ray's space, as shear() of RayPacket.
template <class L>
struct RayAtVertices {
  using Float = typename L::Float;
  Float shear[3];
  Float org[3];
  int axis[3];  ///< across, across, along

  RayAtVertices(const RayColumns<L>& rays, int lane) noexcept {
    constexpr int next[5] = {0, 1, 2, 0, 1};
    for (int i = 0; i < 3; ++i) {
      axis[i] = next[rays.axis(lane) + (i + 1) % 3];
      org[i] = Float(rays.org[axis[i]][lane]);
      shear[i] = Float(rays.shear[i][lane]);
    }
  }
  [[gnu::always_inline]] ShearedVertex<L> see(Float p, Float q, Float r) const noexcept {
    const Float depth = r - org[2];
    return {L::neg_mul_add(shear[0], depth, p - org[0]), L::neg_mul_add(shear[1], depth, q - org[1]), shear[2] * depth};
  }
};

/// A block's vertices in a ray's space.
template <class L>
struct SeenBlock {
  alignas(64) float x[16], y[16], z[16];
  const TriangleBlock& block;

  SeenBlock(const TriangleBlock& of, const RayAtVertices<L>& ray) noexcept : block(of) {
    for (int i = 0; i < 16; i += L::kWidth) {  // the last are what follows in the block, to no effect
      const auto row = [&](int k) noexcept { return L::load(of.vertex[ray.axis[k]] + i); };
      const ShearedVertex<L> vertex = ray.see(row(0), row(1), row(2));
      L::store(x + i, vertex.x);
      L::store(y + i, vertex.y);
      L::store(z + i, vertex.z);
    }
  }
  /// Corner `k` of the triangles from `first` on.
  [[gnu::always_inline]] ShearedVertex<L> corner(int k, int first) const noexcept {
    float at[3][L::kWidth];
    for (int lane = 0; lane < L::kWidth; ++lane) {
      const int i = block.corner[k][first + lane];
      at[0][lane] = x[i];
      at[1][lane] = y[i];
      at[2][lane] = z[i];
    }
    return {L::load(at[0]), L::load(at[1]), L::load(at[2])};
  }
};

template <class L>
requires(L::kWidth >= 8) struct SeenBlock<L> {
  static constexpr int kParts = 16 / L::kWidth;  ///< registers of vertices
  using Shuffles = LaneShuffles<L::kIsa>;
  typename L::Float x[kParts], y[kParts], z[kParts];
  const TriangleBlock& block;

  [[gnu::always_inline]] SeenBlock(const TriangleBlock& of, const RayAtVertices<L>& ray) noexcept : block(of) {
    for (int p = 0; p < kParts; ++p) {
      const auto row = [&](int k) noexcept { return L::load(of.vertex[ray.axis[k]] + p * L::kWidth); };
      const ShearedVertex<L> vertex = ray.see(row(0), row(1), row(2));
      x[p] = vertex.x;
      y[p] = vertex.y;
      z[p] = vertex.z;
    }
  }
  [[gnu::always_inline]] ShearedVertex<L> corner(int k, int first) const noexcept {
    const auto index = Shuffles::load_bytes(block.corner[k] + first);
    return {Shuffles::permute(x, index), Shuffles::permute(y, index), Shuffles::permute(z, index)};
  }
};

/// Tests the block's triangles; `hit` becomes the nearest, ties to the smaller id, or for Query::any some one that blocks the ray.
template <Query Q, class L, class Stats>
[[gnu::always_inline]] inline void test_block(const RayAtVertices<L>& ray, float t_min, const TriangleBlock& block, SingleHit& hit, Stats stats) noexcept {
  using Float = typename L::Float;
  const SeenBlock<L> seen(block, ray);
  const float t_end = hit.t;
  for (std::int32_t first = 0; first < block.count; first += L::kWidth) {
    const std::int32_t left = block.count - first;
    const std::uint32_t present = (1u << (left < L::kWidth ? left : L::kWidth)) - 1;
    stats.template count<Event::prim_test, L>(L::mask(present));
    const SurfaceHit<L> found = intersect_triangle<L>(seen.corner(0, first), seen.corner(1, first), seen.corner(2, first));
    std::uint32_t closer = L::bits(found.meets) & present;
    if (closer == 0) continue;
    closer &= L::bits((found.t >= Float(t_min)) & (found.t <= Float(t_end)));
    if (closer == 0) continue;
    if constexpr (Q == Query::any) {
      stats.template count<Event::prim_hit, L>(L::mask(closer));
      hit = {-kInfinity, block.prim[first + __builtin_ctz(closer)]};
      return;
    }
    alignas(64) float t[L::kWidth], u[L::kWidth], v[L::kWidth];
    L::store(t, found.t + Float(0.0f));  // + 0 turns -0 into +0
    L::store(u, found.u + Float(0.0f));
    L::store(v, found.v + Float(0.0f));
    std::uint32_t improving = 0;
    for (; closer != 0; closer &= closer - 1) {
      const int lane = __builtin_ctz(closer);
      const std::int32_t prim = block.prim[first + lane];
      if (t[lane] > hit.t || (t[lane] == hit.t && prim >= hit.prim)) continue;
      improving |= 1u << lane;
      hit = {t[lane], prim, u[lane], v[lane]};
    }
    if (improving != 0) stats.template count<Event::prim_hit, L>(L::mask(improving));
  }
}

}  // namespace raymeter
