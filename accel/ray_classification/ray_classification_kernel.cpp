// Rays against the candidates of their cells (Arvo, Kirk 1987). Memory: a list of candidates a cell, eight bytes each, in the order in which they begin along
// the dominant axis; the primitives lie in the structure's own pools. There is nothing to traverse: which cell a ray is in was found for the whole batch
// (classify_kernel.cpp, ray_order.h), and rays come sorted by cells, so that a packet, gathered from anywhere in the batch, shares one list.
//
// Events: leaf_visit once per ray, for its cell; of these empty_leaf_visit where its list is empty; prim_test per candidate that begins before the ray's
// nearest hit so far and, where the list is long, meets the beam of its neighbours in the packet. Registers test eight candidates for a look at their hits, so
// that executions exceed what some lane needs, and may have no such lane. No nodes. Rays that miss the scene's box visit nothing.
//
// Why no hit is lost. A cell's list holds all primitives that its rays can hit (beam.h). The search ends, and single candidates are passed over, where one
// begins beyond the nearest hit: by the slab test of its padded box on the dominant axis alone, which is looser than that of the box; beams of a packet are
// conservative by themselves (beam_kernel.h). Rays of which cells' beams know nothing, because they start too far away, are tested against everything.
//
// It ends after as many steps as the list has candidates.

#include "accel/ray_classification/ray_classification_kernel.h"

#include "accel/packet_beams_kernel.h"
#include "core/geometry/run_kernel.h"
#include "core/ray/packet_loop.h"
#include "core/stats/policy.h"

namespace raymeter {

namespace {

/// Candidates that are tested between two looks at whether any ray has need of more.
constexpr std::int32_t kBlock = 8;
/// A list of so many candidates is not worth making beams for.
constexpr std::int32_t kFew = 8;

/// The lanes for which a candidate begins no later than their nearest hit.
template <class L>
[[gnu::always_inline]] inline typename L::Mask begins_before_hit(const RayPacket<L>& ray, const HitPacket<L>& hit, int axis, float plane) noexcept {
  using Float = typename L::Float;
  const Float crossing = (Float(plane) - ray.org[axis]) * ray.inv_dir[axis];
  return L::mul_add(crossing, Float(1.0f - kSlabPadding), -ray.slab_slack) <= hit.t;
}

/// A block of a cell's list. A candidate that begins beyond a ray's hit cannot improve it: registers are tested against the rest of the block, as asking for
/// each candidate would cost them more than it saves.
template <class L, int kGroups>
struct CandidateRefs {
  static constexpr Selection kSelection = L::kWidth == 1 ? Selection::tested : Selection::counted;
  const Candidate* list;
  const Packet<L, kGroups>* packet;
  int axis;
  float sign;

  [[nodiscard]] std::int32_t index(std::int32_t k) const noexcept { return list[k].index(); }
  [[nodiscard]] typename L::Mask wanted(typename L::Mask lanes, int group, std::int32_t k) const noexcept {
    return lanes & begins_before_hit(packet->ray[group], packet->hit[group], axis, sign * list[k].start);
  }
};

template <Query Q, class L, int kGroups, class Stats>
void visit_cell(const RayCellsView& view, const RayCell& cell, Packet<L, kGroups>& packet, Stats stats) noexcept {
  typename L::Mask lanes[Packet<L, kGroups>::kCapacity];
  const int axis = cell.ray_class >> 1;
  const float sign = (cell.ray_class & 1) != 0 ? -1.0f : 1.0f;
  for (std::int32_t k = 0; k < cell.count;) {
    bool wanted = false;
    for (int g = 0; g < packet.group_count(); ++g) {
      lanes[g] = begins_before_hit(packet.ray[g], packet.hit[g], axis, sign * cell.list[k].start);
      wanted = wanted || L::any(lanes[g]);
    }
    if (!wanted) return;
    std::int32_t end = k + 1;
    while (end < cell.count && end - k < kBlock && cell.list[end].kind() == cell.list[k].kind()) ++end;
    test_refs<Q, L, kGroups>(packet, lanes, view.pools, static_cast<PrimKind>(cell.list[k].kind()), end - k,
                             CandidateRefs<L, kGroups>{cell.list + k, &packet, axis, sign}, stats);
    k = end;
  }
}

/// A long list, of which a packet's own beams, thinner than the cell, take what they meet.
template <Query Q, class L, int kGroups, class Stats>
class LongList {
public:
  LongList(const RayCellsView& view, PacketBeams<L, kGroups>& beams, Stats stats) noexcept : view_(view), beams_(beams), stats_(stats) {}

  /// Returns false where the packet has no beams.
  bool visit(const RayCell& cell) noexcept {
    beams_.find_alive();
    Beam whole;
    whole.axis = cell.ray_class >> 1;
    whole.across[0] = whole.axis == 0 ? 1 : 0;
    whole.across[1] = whole.axis == 2 ? 1 : 2;
    whole.sign = (cell.ray_class & 1) != 0 ? -1.0f : 1.0f;
    if (beams_.alive == 0 || !beams_.make(view_.box, whole)) return false;
    for (std::int32_t k = 0; k < cell.count; ++k) {
      const Candidate candidate = cell.list[k];
      std::uint32_t reached = 0;
      for (int b = 0; b < beams_.count; ++b) reached |= (candidate.start <= beams_.farthest[b] ? 1u : 0u) << b;
      reached &= beams_.alive;
      if (reached == 0) break;
      const auto kind = static_cast<PrimKind>(candidate.kind());
      if (kind != kind_) flush();
      kind_ = kind;
      for (std::uint32_t left = reached & beams_.that_meet(view_.pools, kind, candidate.index()); left != 0; left &= left - 1) {
        const int b = __builtin_ctz(left);
        met_[b][met_count_[b]++] = candidate.index();
        if (met_count_[b] == kBlock) test(b);
      }
    }
    flush();
    return true;
  }

private:
  void flush() noexcept {
    for (int b = 0; b < beams_.count; ++b) {
      if (met_count_[b] > 0) test(b);
    }
  }
  void test(int b) noexcept {
    Packet<L, kGroups>& rays = beams_.rays[b];
    typename L::Mask lanes[Packet<L, kGroups>::kCapacity];
    for (int g = 0; g < rays.group_count(); ++g) lanes[g] = rays.live(g);
    test_refs<Q, L, kGroups>(rays, lanes, view_.pools, kind_, met_count_[b], ListedRefs{met_[b]}, stats_);
    met_count_[b] = 0;
    beams_.update_farthest(b);
  }

  const RayCellsView& view_;
  PacketBeams<L, kGroups>& beams_;
  Stats stats_;
  PrimKind kind_ = PrimKind::triangle;  ///< of what has been met
  std::int32_t met_count_[kBeams] = {};
  std::int32_t met_[kBeams][kBlock];
};

template <Query Q, class L, int kGroups, class Stats>
void visit_everything(const RayCellsView& view, Packet<L, kGroups>& packet, Stats stats) noexcept {
  typename L::Mask live[Packet<L, kGroups>::kCapacity];
  for (int g = 0; g < packet.group_count(); ++g) live[g] = packet.live(g);
  for (std::size_t kind = 0; kind < kPrimKindCount; ++kind) {
    test_refs<Q, L, kGroups>(packet, live, view.pools, static_cast<PrimKind>(kind), view.prim_count[kind], PositionRefs{0}, stats);
  }
}

/// The rays of a packet, brought together from their places in the batch, and their answers on the way back. Ray by ray: eight gathers of a register's lanes
/// take longer than loading and storing each of them.
template <class L>
struct Gathered {
  const std::int32_t* place = nullptr;
  alignas(64) float org[3][kMaxPacket] = {};
  alignas(64) float dir[3][kMaxPacket] = {};
  alignas(64) float t_min[kMaxPacket] = {};
  alignas(64) float t_max[kMaxPacket] = {};
  alignas(64) float t[kMaxPacket], u[kMaxPacket], v[kMaxPacket];
  alignas(64) std::int32_t prim[kMaxPacket];

  RayView load(const RayView& rays, const std::int32_t* order, std::int32_t count) noexcept {
    place = order;
    for (std::int32_t k = 0; k < count; ++k) {
      const std::int32_t at = order[k];
      for (int a = 0; a < 3; ++a) {
        org[a][k] = rays.org[a][at];
        dir[a][k] = rays.dir[a][at];
      }
      t_min[k] = rays.t_min[at];
      t_max[k] = rays.t_max[at];
    }
    return {{org[0], org[1], org[2]}, {dir[0], dir[1], dir[2]}, t_min, t_max, count};
  }

  template <Query Q, int kGroups>
  void store(const TraceArgs& args, std::int32_t count, const PacketBeams<L, kGroups>& beams) noexcept {
    beams.template store<Q>({{}, {t, prim, u, v, count}, prim, args.packet, nullptr}, 0, count);
    for (std::int32_t k = 0; k < count; ++k) {
      const std::int32_t at = place[k];
      if constexpr (Q == Query::any) {
        args.blocker[at] = prim[k];
      } else {
        args.hits.t[at] = t[k];
        args.hits.prim[at] = prim[k];
        args.hits.u[at] = u[k];
        args.hits.v[at] = v[k];
      }
    }
  }
};

template <Query Q>
void store_miss(const TraceArgs& args, std::int32_t at) noexcept {
  if constexpr (Q == Query::any) {
    args.blocker[at] = -1;
  } else {
    args.hits.t[at] = kInfinity;
    args.hits.prim[at] = -1;
    args.hits.u[at] = 0;
    args.hits.v[at] = 0;
  }
}

/// A packet's rays, which are all in one cell.
template <Query Q, class L, int kGroups, class Stats>
void visit(const RayCellsView& view, const RayCell& cell, PacketBeams<L, kGroups>& beams, std::int32_t rays, Stats stats) noexcept {
  for (int b = 0; b < beams.count; ++b) {
    for (int g = 0; g < beams.rays[b].group_count(); ++g) {
      stats.template count<Event::leaf_visit, L>(beams.rays[b].live(g));
      if (Stats::kCounting && cell.count == 0) stats.template count<Event::empty_leaf_visit, L>(beams.rays[b].live(g));
    }
  }
  const bool classified = cell.ray_class < kRayClasses;
  if (view.beams && classified && rays > 1 && cell.count > kFew && LongList<Q, L, kGroups, Stats>(view, beams, stats).visit(cell)) return;
  for (int b = 0; b < beams.count; ++b) {
    if (classified)
      visit_cell<Q>(view, cell, beams.rays[b], stats);
    else
      visit_everything<Q>(view, beams.rays[b], stats);
  }
}

template <Query Q, class L, int kGroups, class Stats>
void trace_slice(const RayCellsView& view, const TraceArgs& args, Stats stats) noexcept {
  PacketBeams<L, kGroups> beams;
  Gathered<L> rays;
  for (std::int32_t first = 0; first < args.rays.count;) {
    const std::int32_t number = view.cell[first];
    const RayCell& cell = view.cells[number];
    if (cell.ray_class == kNowhere) {
      store_miss<Q>(args, view.order[first++]);
      continue;
    }
    std::int32_t count = 1;
    while (count < args.packet && first + count < args.rays.count && view.cell[first + count] == number) ++count;
    beams.load(rays.load(args.rays, view.order + first, count), 0, count);
    visit<Q>(view, cell, beams, count, stats);
    rays.template store<Q>(args, count, beams);
    first += count;
  }
}

template <Query Q, class L, class Stats>
void trace(const RayCellsView& view, const TraceArgs& args, Stats stats) noexcept {
  const std::int32_t in_beam = args.packet < kBeamRays ? args.packet : kBeamRays;
  with_groups<L>(in_beam, [&]<int kGroups>() noexcept { trace_slice<Q, L, kGroups>(view, args, stats); });
}

}  // namespace

template <Isa I, class Stats>
void RayClassificationKernel<I, Stats>::closest(const RayCellsView& view, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::closest, Lanes<I>>(view, args, Stats(counters));
}

template <Isa I, class Stats>
void RayClassificationKernel<I, Stats>::any(const RayCellsView& view, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::any, Lanes<I>>(view, args, Stats(counters));
}

template struct RayClassificationKernel<kKernelIsa, NoStats>;
template struct RayClassificationKernel<kKernelIsa, CountStats>;

}  // namespace raymeter
