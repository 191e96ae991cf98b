#pragma once

// One ray against the triangles of a block, triangles in lanes, by the test of core/geometry/triangle_kernel.h.

#include "accel/bvh/stream_hit_kernel.h"
#include "accel/bvh/stream_ray_kernel.h"
#include "accel/bvh/wide_layout.h"
#include "core/geometry/triangle_kernel.h"
#include "core/simd/shuffle_kernel.h"

namespace raymeter {

/// What brings vertices into a ray's space; `axes` as StreamAxes.
template <class L>
struct RaySpace {
  using Float = typename L::Float;
  Float shear[3];
  Float org[3];

  [[gnu::always_inline]] RaySpace(const StreamRay& ray, const StreamAxes& axes) noexcept
      : shear{ray.shear[0], ray.shear[1], ray.shear[2]}, org{ray.org[axes.p], ray.org[axes.q], ray.org[axes.r]} {}
  /// As shear() of RayPacket.
  [[gnu::always_inline]] ShearedVertex<L> operator()(Float p, Float q, Float r) const noexcept {
    const Float depth = r - org[2];
    return {L::neg_mul_add(shear[0], depth, p - org[0]), L::neg_mul_add(shear[1], depth, q - org[1]), shear[2] * depth};
  }
};

/// A block's triangles side by side, in kRegisters, their coordinates in the order of a group's axes.
template <class L>
struct BlockTriangles {
  static constexpr int kRegisters = (TriangleBlock::kTriangles + L::kWidth - 1) / L::kWidth;
  alignas(64) float column[3][3][kRegisters * L::kWidth];  ///< [corner][axis][triangle]

  BlockTriangles(const TriangleBlock& block, const StreamAxes& axes) noexcept {
    const float* const row[3] = {block.vertex[axes.p], block.vertex[axes.q], block.vertex[axes.r]};
    if constexpr (L::kWidth >= 8) {
      for (int i = 0; i < 3; ++i) {
        typename L::Float vertices[16 / L::kWidth];
        for (int part = 0; part < 16 / L::kWidth; ++part) vertices[part] = L::load(row[i] + part * L::kWidth);
        for (int k = 0; k < 3; ++k) {
          for (int r = 0; r < kRegisters; ++r)
            L::store(column[k][i] + r * L::kWidth,
                     LaneShuffles<L::kIsa>::permute(vertices, LaneShuffles<L::kIsa>::load_bytes(block.corner[k] + r * L::kWidth)));
        }
      }
    } else {
      for (int k = 0; k < 3; ++k) {
        for (int t = 0; t < TriangleBlock::kTriangles; ++t) {
          for (int i = 0; i < 3; ++i) column[k][i][t] = row[i][block.corner[k][t]];
        }
      }
    }
  }
  /// Corner `k` of register `r`.
  [[gnu::always_inline]] ShearedVertex<L> corner(const RaySpace<L>& space, int k, int r) const noexcept {
    const auto row = [&](int i) noexcept { return L::load(column[k][i] + r * L::kWidth); };
    return space(row(0), row(1), row(2));
  }
};

/// Calls take(LeafHits) for each register of the block's triangles. Whether a ray meets any of them is not predictable: nothing here branches on it.
template <class L, class Stats, class Take>
[[gnu::always_inline]] inline void meet_block(const StreamRay& ray, const StreamAxes& axes, const TriangleBlock& block, const BlockTriangles<L>& triangles,
                                              Stats stats, Take take) noexcept {
  using Float = typename L::Float;
  const RaySpace<L> space(ray, axes);
  const Float t_min(ray.interval[0]), t_end(-ray.interval[1]);
  for (int r = 0; r < BlockTriangles<L>::kRegisters; ++r) {
    const std::int32_t first = r * L::kWidth;
    if (first >= block.count) break;
    const std::int32_t left = block.count - first;
    const std::uint32_t present = (1u << (left < L::kWidth ? left : L::kWidth)) - 1;
    stats.template count<Event::prim_test, L>(L::mask(present));
    const SurfaceHit<L> found = intersect_triangle<L, true>(triangles.corner(space, 0, r), triangles.corner(space, 1, r), triangles.corner(space, 2, r));
    take(LeafHits<L>{found, L::bits(found.meets & (found.t >= t_min) & (found.t <= t_end)) & present, first});
  }
}

/// Tests the block's triangles; `hit` becomes the nearest, ties to the smaller id. Returns whether it changed.
template <class L, class Stats>
[[gnu::always_inline]] inline bool nearest_of_block(const StreamRay& ray, const StreamAxes& axes, const TriangleBlock& block,
                                                    const BlockTriangles<L>& triangles, RayHit& hit, Stats stats) noexcept {
  const RayHit before = hit;
  meet_block<L>(ray, axes, block, triangles, stats, [&](const LeafHits<L>& found) noexcept { take_nearest<L>(found, block.prim, before, hit, stats); });
  return hit.prim != before.prim || hit.t != before.t;
}

/// The triangles of the block that block a ray which nothing has blocked yet, as bits.
template <class L, class Stats>
[[gnu::always_inline]] inline std::uint32_t blockers_of_block(const StreamRay& ray, const StreamAxes& axes, const TriangleBlock& block,
                                                              const BlockTriangles<L>& triangles, Stats stats) noexcept {
  std::uint32_t blockers = 0;
  meet_block<L>(ray, axes, block, triangles, stats, [&](const LeafHits<L>& found) noexcept {
    if (Stats::kCounting && found.closer != 0) stats.template count<Event::prim_hit, L>(L::mask(found.closer));
    blockers |= found.closer << found.first;
  });
  return blockers;
}

}  // namespace raymeter
