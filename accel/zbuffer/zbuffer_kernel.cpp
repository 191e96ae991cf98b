// The first hits of a cell's eye rays, from lists of candidates and without a structure.
//
// Memory: a footprint is one cache line (footprint_layout.h) and tells which samples a primitive may cover, and from which depth on; the primitives are the
// scene's own. A packet's samples are one rectangle. Sixteen rectangles lie side by side in registers, and one footprint is tested against all of them at once:
// bounds, and edge functions at the corner that is furthest inside (after Pineda 1988, SIGGRAPH; conservative as in Hasselgren, Akenine-Moeller, Ohlsson 2005,
// GPU Gems 2). So each packet gets a list of candidates, nearest first, and tests them by the ray kernels until the next begins behind all its hits.
//
// draw() makes a z-buffer of the same candidates: of triangles it takes the samples inside their edges, at the depth of their plane (both as padded in
// footprints: neighbours overlap by a thousandth of a sample, so that no fill rule has to keep holes shut), of all else, and of triangles too near or too
// slender for that, what the ray kernels find. meet() asks them about the primitive that a ray is shown. A ray that ends at its own hit, closed, has the same
// nearest hit.
//
// Events: volume_test, a register of packets' rectangles against a footprint, its lanes are packets, and in draw() samples
// against a triangle's edges; prim_test and prim_hit as everywhere. No nodes.
//
// No hit is lost: a footprint holds all samples and depths at which a kernel accepts a hit (footprints.cpp). A candidate is left out only where its least
// depth is beyond that of a lane's hit (equal ones are tested: ties), and lists are sorted by that depth. What the test itself rounds is in there.
// It ends: candidates are taken from two finite lists, kChunk at a time.

#include "accel/zbuffer/zbuffer_kernel.h"

#include "accel/zbuffer/candidates_kernel.h"
#include "core/geometry/run_kernel.h"

namespace raymeter {

namespace {

/// Draws a flat triangle: its fragments are the samples inside its edges, at the depth of its plane. x, y: of the packet's samples.
template <class L, int kGroups, class Stats>
inline void draw_fragments(const Footprint& print, const DepthPlane& plane, std::int32_t prim, const float* x, const float* y,
                           const HitDepths<L, kGroups>& depths, const typename L::Mask* wanted, Packet<L, kGroups>& packet, Stats stats) noexcept {
  using Float = typename L::Float;
  const Float zero(0.0f);
  for (int g = 0; g < packet.group_count(); ++g) {
    const Float sample_x = L::load(x + g * L::kWidth), sample_y = L::load(y + g * L::kWidth);
    const auto value = [&](float per_x, float per_y, float at_center) noexcept -> Float {
      return L::mul_add(Float(per_x), sample_x, L::mul_add(Float(per_y), sample_y, Float(at_center)));
    };
    const Float inverse_depth = value(plane.per_x, plane.per_y, plane.at_center);
    SurfaceHit<L> found{inverse_depth > zero, Float(1.0f) / (inverse_depth * depths.per_t[g]), zero, zero};
    for (const float(&edge)[3] : print.edge) found.meets = found.meets & (value(edge[0], edge[1], edge[2]) >= zero);
    stats.template count<Event::volume_test, L>(wanted[g] & packet.live(g));
    update<Query::closest>(packet.hit[g], wanted[g] & improves(packet.ray[g], packet.hit[g], found, prim), found, prim);
  }
}

/// Tests candidates until all that are left begin behind the packet's hits. kDraws: flat triangles are drawn instead; x, y: of the packet's samples.
template <bool kDraws, class L, int kGroups, class Stats>
inline void test_candidates(const ZbufferView& frame, const Waiting& waiting, const HitDepths<L, kGroups>& depths, const float* x, const float* y,
                            Packet<L, kGroups>& packet, Stats stats) noexcept {
  typename L::Mask wanted[Packet<L, kGroups>::kCapacity];
  for (std::int32_t k = 0; k < waiting.count && depths.reach(packet, waiting.nearest[k], wanted); ++k) {
    const Footprint& print = frame.footprints[waiting.prim[k]];
    const PrimRef prim = print.prim;
    if constexpr (kDraws) {
      if (print.flat && prim.kind() == PrimKind::triangle) {
        draw_fragments(print, frame.planes[waiting.prim[k]], waiting.prim[k], x, y, depths, wanted, packet, stats);
        continue;
      }
    }
    test_refs<Query::closest, L, kGroups>(packet, wanted, frame.pools, prim.kind(), 1, PositionRefs{static_cast<std::int32_t>(prim.index)}, stats);
  }
}

/// Up to kSideBySide packets of a cell, the candidates that each waits for, and its hits where there are more of them than a chunk.
template <bool kDraws, class L, int kGroups>
class PacketRow {
public:
  PacketRow(const ZbufferView& frame, const CellArgs& cell, std::int32_t first, std::int32_t count) noexcept
      : frame_(frame), cell_(cell), first_(first), count_(count) {}

  template <class Stats>
  void trace(Stats stats) noexcept {
    Candidates candidates{frame_, cell_};
    std::uint32_t open = (1u << count_) - 1;
    for (bool begins = true; open != 0; begins = false) {
      share_out(candidates, open, stats);
      const float next = candidates.done() ? 0.0f : candidates.nearest(candidates.list());
      for (std::int32_t p = 0; p < count_; ++p) {
        if ((open >> p & 1) == 0) continue;
        if (begins && candidates.done() && waiting_[p].count == 0) {
          store_misses(p);
        } else if (test(p, begins, candidates.done(), next, stats)) {
          continue;
        }
        open &= ~(1u << p);
      }
    }
  }

private:
  using Rays = Packet<L, kGroups>;

  [[nodiscard]] std::int32_t first_ray(std::int32_t p) const noexcept { return (first_ + p) * cell_.packet; }
  [[nodiscard]] std::int32_t ray_count(std::int32_t p) const noexcept {
    const std::int32_t left = cell_.rays.count - first_ray(p);
    return left < cell_.packet ? left : cell_.packet;
  }

  /// Shares out the next chunk of candidates among the open packets that they may cover.
  template <class Stats>
  void share_out(Candidates& candidates, std::uint32_t open, Stats stats) noexcept {
    for (std::int32_t p = 0; p < count_; ++p) waiting_[p].count = 0;
    for (std::int32_t k = 0; k < kChunk && !candidates.done(); ++k) {
      const std::int32_t prim = candidates.take();
      const Footprint& print = frame_.footprints[prim];
      for (std::uint32_t met = packets_met<L>(print, cell_, first_, count_, stats) & open; met != 0; met &= met - 1) {
        const int p = __builtin_ctz(met);
        const float in_rect = PacketRect(cell_, first_ + p).nearest(frame_.planes[prim]);
        waiting_[p].insert(prim, in_rect < print.nearest ? in_rect : print.nearest);
      }
    }
  }

  /// Tests what packet p waits for. Returns whether it may still meet what has 1 / depth of `nearest` at the most; where not, its hits are stored.
  template <class Stats>
  bool test(std::int32_t p, bool begins, bool ends, float nearest, Stats stats) noexcept {
    Rays packet;
    load_packet(cell_.rays, first_ray(p), ray_count(p), packet);
    for (int g = 0; !begins && g < packet.group_count(); ++g) packet.hit[g] = hit_[p][g];
    const HitDepths<L, kGroups> depths(frame_, packet);
    const float* const x = kDraws ? cell_.sample[0] + first_ray(p) : nullptr;
    const float* const y = kDraws ? cell_.sample[1] + first_ray(p) : nullptr;
    test_candidates<kDraws>(frame_, waiting_[p], depths, x, y, packet, stats);
    typename L::Mask reached[Rays::kCapacity];
    if (!ends && depths.reach(packet, nearest, reached)) {
      for (int g = 0; g < packet.group_count(); ++g) hit_[p][g] = packet.hit[g];
      return true;
    }
    const TraceArgs args{cell_.rays, cell_.hits, nullptr, cell_.packet, nullptr};
    store_packet<Query::closest>(args, first_ray(p), ray_count(p), packet);
    return false;
  }

  void store_misses(std::int32_t p) noexcept {
    const std::int32_t end = first_ray(p) + ray_count(p);
    for (std::int32_t i = first_ray(p); i < end; ++i) {
      cell_.hits.t[i] = kInfinity;
      cell_.hits.prim[i] = -1;
      cell_.hits.u[i] = 0;
      cell_.hits.v[i] = 0;
    }
  }

  const ZbufferView& frame_;
  const CellArgs& cell_;
  std::int32_t first_;  ///< packet
  std::int32_t count_;
  Waiting waiting_[kSideBySide];
  HitPacket<L> hit_[kSideBySide][Rays::kCapacity];
};

template <bool kDraws, class L, int kGroups, class Stats>
void trace_cell(const ZbufferView& frame, const CellArgs& cell, Stats stats) noexcept {
  const std::int32_t packets = (cell.rays.count + cell.packet - 1) / cell.packet;
  for (std::int32_t first = 0; first < packets; first += kSideBySide) {
    const std::int32_t left = packets - first;
    PacketRow<kDraws, L, kGroups>(frame, cell, first, left < kSideBySide ? left : kSideBySide).trace(stats);
  }
}

/// Tests each ray of the packet against the primitive that prim names, those that name the same together.
template <class L, int kGroups, class Stats>
void meet_named(const ZbufferView& frame, const std::int32_t* prim, Packet<L, kGroups>& packet, Stats stats) noexcept {
  using Int = typename L::Int;
  constexpr int kCapacity = Packet<L, kGroups>::kCapacity;
  std::uint32_t left[kCapacity];
  for (int g = 0; g < packet.group_count(); ++g) {
    left[g] = L::bits(packet.live(g) & ~L::less(L::load(prim + g * L::kWidth), Int(0)));
  }
  for (int g = 0; g < packet.group_count(); ++g) {
    while (left[g] != 0) {
      const std::int32_t named = prim[g * L::kWidth + __builtin_ctz(left[g])];
      typename L::Mask lanes[kCapacity];
      for (int h = 0; h < packet.group_count(); ++h) {
        lanes[h] = L::mask(left[h]) & L::equal(L::load(prim + h * L::kWidth), Int(named));
        left[h] &= ~L::bits(lanes[h]);
      }
      const PrimRef ref = frame.footprints[named].prim;
      test_refs<Query::closest, L, kGroups>(packet, lanes, frame.pools, ref.kind(), 1, PositionRefs{static_cast<std::int32_t>(ref.index)}, stats);
    }
  }
}

}  // namespace

template <Isa I, class Stats>
void ZbufferKernel<I, Stats>::list(const ZbufferView& frame, const CellArgs& cell, Counters* counters) noexcept {
  with_groups<Lanes<I>>(cell.packet, [&]<int kGroups>() noexcept { trace_cell<false, Lanes<I>, kGroups>(frame, cell, Stats(counters)); });
}

template <Isa I, class Stats>
void ZbufferKernel<I, Stats>::draw(const ZbufferView& frame, const CellArgs& cell, Counters* counters) noexcept {
  with_groups<Lanes<I>>(cell.packet, [&]<int kGroups>() noexcept { trace_cell<true, Lanes<I>, kGroups>(frame, cell, Stats(counters)); });
}

template <Isa I, class Stats>
void ZbufferKernel<I, Stats>::meet(const ZbufferView& frame, const TraceArgs& args, const std::int32_t* prim, Counters* counters) noexcept {
  with_groups<Lanes<I>>(args.packet, [&]<int kGroups>() noexcept {
    const std::int32_t* next = prim;
    for_each_packet<Query::closest, Lanes<I>, kGroups>(args, [&](Packet<Lanes<I>, kGroups>& packet) noexcept {
      meet_named(frame, next, packet, Stats(counters));
      next += args.packet;
    });
  });
}

template struct ZbufferKernel<kKernelIsa, NoStats>;
template struct ZbufferKernel<kKernelIsa, CountStats>;

}  // namespace raymeter
