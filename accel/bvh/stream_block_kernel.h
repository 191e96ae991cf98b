#pragma once

// One ray against the triangles of a block, triangles in lanes, by the test of core/geometry/triangle_kernel.h.

#include "accel/bvh/stream_ray_kernel.h"
#include "accel/bvh/wide_layout.h"
#include "core/geometry/triangle_kernel.h"
#include "core/simd/shuffle_kernel.h"

namespace raymeter {

/// Vertices in a ray's space.
template <class L>
struct RaySpace {
  using Float = typename L::Float;
  Float shear_x, shear_y, shear_z;
  Float org[3];
  int axis[3];

  explicit RaySpace(const StreamRay& ray) noexcept : shear_x(ray.shear[0]), shear_y(ray.shear[1]), shear_z(ray.shear[2]) {
    constexpr int next[5] = {0, 1, 2, 0, 1};
    for (int i = 0; i < 3; ++i) {
      axis[i] = next[ray.axis + (i + 1) % 3];
      org[i] = Float(ray.org[axis[i]]);
    }
  }
  /// As shear() of RayPacket.
  [[gnu::always_inline]] ShearedVertex<L> operator()(Float p, Float q, Float r) const noexcept {
    const Float depth = r - org[2];
    return {L::neg_mul_add(shear_x, depth, p - org[0]), L::neg_mul_add(shear_y, depth, q - org[1]), shear_z * depth};
  }
};

/// A block's triangles side by side, in kRegisters.
template <class L>
struct BlockTriangles {
  static constexpr int kRegisters = (TriangleBlock::kTriangles + L::kWidth - 1) / L::kWidth;
  using Seen = RaySpace<L>;
  alignas(64) float column[3][3][kRegisters * L::kWidth];  ///< [corner][axis][triangle]

  explicit BlockTriangles(const TriangleBlock& block) noexcept {
    for (int k = 0; k < 3; ++k) {
      for (int t = 0; t < TriangleBlock::kTriangles; ++t) {
        for (int a = 0; a < 3; ++a) column[k][a][t] = block.vertex[a][block.corner[k][t]];
      }
    }
  }
  [[nodiscard]] Seen seen(const RaySpace<L>& space) const noexcept { return space; }
  /// The corners of register `r`.
  [[gnu::always_inline]] void corners(const Seen& space, int r, ShearedVertex<L> (&corner)[3]) const noexcept {
    for (int k = 0; k < 3; ++k) {
      const auto row = [&](int i) noexcept { return L::load(column[k][space.axis[i]] + r * L::kWidth); };
      corner[k] = space(row(0), row(1), row(2));
    }
  }
};

/// Where lanes can be permuted a block's vertices are brought into ray space once, and from there to the triangles.
template <class L>
requires(L::kWidth >= 8) struct BlockTriangles<L> {
  static constexpr int kRegisters = (TriangleBlock::kTriangles + L::kWidth - 1) / L::kWidth;
  static constexpr int kParts = 16 / L::kWidth;  ///< registers of vertices
  using Shuffles = LaneShuffles<L::kIsa>;
  struct Seen {
    typename L::Float x[kParts], y[kParts], z[kParts];
  };
  const TriangleBlock& block;
  typename L::Int index[3][kRegisters];

  explicit BlockTriangles(const TriangleBlock& of) noexcept : block(of) {
    for (int k = 0; k < 3; ++k) {
      for (int r = 0; r < kRegisters; ++r) index[k][r] = Shuffles::load_bytes(of.corner[k] + r * L::kWidth);
    }
  }
  [[gnu::always_inline]] Seen seen(const RaySpace<L>& space) const noexcept {
    Seen vertices;
    for (int p = 0; p < kParts; ++p) {
      const auto row = [&](int i) noexcept { return L::load(block.vertex[space.axis[i]] + p * L::kWidth); };
      const ShearedVertex<L> vertex = space(row(0), row(1), row(2));
      vertices.x[p] = vertex.x;
      vertices.y[p] = vertex.y;
      vertices.z[p] = vertex.z;
    }
    return vertices;
  }
  [[gnu::always_inline]] void corners(const Seen& vertices, int r, ShearedVertex<L> (&corner)[3]) const noexcept {
    for (int k = 0; k < 3; ++k) {
      corner[k] = {Shuffles::permute(vertices.x, index[k][r]), Shuffles::permute(vertices.y, index[k][r]), Shuffles::permute(vertices.z, index[k][r])};
    }
  }
};

/// The nearest hit that one ray has, in a form of its own.
struct RayHit {
  float t;
  std::int32_t prim;
  float u;
  float v;
};

/// Tests the block's triangles; `hit` becomes the nearest, ties to the smaller id. Returns whether it changed.
template <class L, class Stats>
[[gnu::always_inline]] inline bool test_block(const StreamRay& ray, const TriangleBlock& block, const BlockTriangles<L>& triangles, RayHit& hit,
                                              Stats stats) noexcept {
  using Float = typename L::Float;
  const auto seen = triangles.seen(RaySpace<L>(ray));
  const RayHit before = hit;
  for (int r = 0; r < BlockTriangles<L>::kRegisters; ++r) {
    const std::int32_t first = r * L::kWidth;
    if (first >= block.count) break;
    const std::int32_t left = block.count - first;
    const std::uint32_t present = (1u << (left < L::kWidth ? left : L::kWidth)) - 1;
    stats.template count<Event::prim_test, L>(L::mask(present));
    ShearedVertex<L> corner[3];
    triangles.corners(seen, r, corner);
    const SurfaceHit<L> found = intersect_triangle<L>(corner[0], corner[1], corner[2]);
    std::uint32_t closer = L::bits(found.meets) & present;
    if (closer == 0) continue;
    closer &= L::bits((found.t >= Float(ray.interval[0])) & (found.t <= Float(before.t)));
    if (closer == 0) continue;
    alignas(64) float t[L::kWidth], u[L::kWidth], v[L::kWidth];
    L::store(t, found.t);
    L::store(u, found.u + Float(0.0f));
    L::store(v, found.v + Float(0.0f));
    std::uint32_t counted = 0;
    for (; closer != 0; closer &= closer - 1) {
      const int lane = __builtin_ctz(closer);
      const std::int32_t prim = block.prim[first + lane];
      if (t[lane] == before.t && prim >= before.prim) continue;
      counted |= 1u << lane;
      if (t[lane] < hit.t || (t[lane] == hit.t && prim < hit.prim)) hit = {t[lane] + 0.0f, prim, u[lane], v[lane]};
    }
    if (counted != 0) stats.template count<Event::prim_hit, L>(L::mask(counted));
  }
  return hit.prim != before.prim || hit.t != before.t;
}

}  // namespace raymeter
