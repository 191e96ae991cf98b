// Single-ray traversal of an 8-wide hierarchy, for callers who have one ray or few (after Wald, Woop, Benthin, Johnson, Ernst 2014, "Embree"): the ray is
// tested against eight children at once, children in lanes, and against a leaf's triangles, triangles in lanes. Front to back by the octant order of each node;
// an entry of the stack that begins behind the hit is dropped.
//
// Events: node_visit once per inner node; volume_test eight per node, by registers of children; leaf_visit; prim_test per triangle of the leaf, by registers of
// triangles, or one at a time for other primitives.

#include "accel/bvh/single_kernel.h"

#include "accel/bvh/node_access_kernel.h"
#include "accel/bvh/single_block_kernel.h"
#include "core/geometry/run_kernel.h"
#include "core/stats/policy.h"

namespace raymeter {

namespace {

/// A register of rays, of which one at a time is traced.
template <class L>
struct SingleRays {
  Packet<L, 1> packet;  ///< for the tests of primitives that are no triangles
  RayColumns<L> columns;

  SingleRays(const RayView& rays, std::int32_t first, std::int32_t count) noexcept {
    load_packet(rays, first, count, packet);
    columns.lay_down(packet.ray[0], packet.hit[0]);
  }
};

/// Primitives that are no triangles, by the one loop that there is over them; the other lanes do not ask.
template <Query Q, class L, class Stats>
void test_run_of_one(const WideBvhView& bvh, PrimitiveRun run, int lane, Packet<L, 1>& packet, SingleHit& hit, Stats stats) noexcept {
  using Float = typename L::Float;
  const auto one = L::mask(1u << lane);
  packet.hit[0] = {L::select(one, Float(hit.t), Float(-kInfinity)), typename L::Int(hit.prim), Float(hit.u), Float(hit.v)};
  test_run<Q, L, 1>(packet, &one, bvh.pools, run, nullptr, stats);
  alignas(64) float t[L::kWidth], u[L::kWidth], v[L::kWidth];
  alignas(64) std::int32_t prim[L::kWidth];
  L::store(t, packet.hit[0].t);
  L::store(u, packet.hit[0].u);
  L::store(v, packet.hit[0].v);
  L::store(prim, packet.hit[0].prim);
  hit = {t[lane], prim[lane], u[lane], v[lane]};
}

template <Query Q, class L, class View, class Stats>
SingleHit trace_one(const View& bvh, SingleRays<L>& rays, int lane, std::byte* scratch, Stats stats) noexcept {
  SingleHit hit{rays.columns.t_end[lane]};
  if (hit.t == -kInfinity) return hit;
  const RayAtNodes<L> at_nodes(rays.columns, lane);
  const RayAtVertices<L> at_vertices(rays.columns, lane);
  const std::uint32_t octant = rays.columns.octant(lane);
  WideNode room;
  SingleStack stack(scratch, bvh.stack_capacity);
  WideRef child(WideRef::Tag::inner, 0);
  while (true) {
    if (child.tag() == WideRef::Tag::inner) {
      if constexpr (Stats::kCounting) {
        constexpr int kStep = L::kWidth < kWideChildren ? L::kWidth : kWideChildren;
        stats.template count<Event::node_visit, L>(L::mask(1));
        for (int c = 0; c < kWideChildren; c += kStep) stats.template count<Event::volume_test, L>(L::mask((1u << kStep) - 1));
      }
      at_nodes.push_met(node_at<L>(bvh, child.index(), octant, room), hit.t, stack);
    } else {
      stats.template count<Event::leaf_visit, L>(L::mask(1));
      if (child.tag() == WideRef::Tag::block)
        test_block<Q>(at_vertices, rays.columns.t_min[lane], bvh.blocks[child.index()], hit, stats);
      else
        test_run_of_one<Q>(bvh, bvh.runs[child.index()], lane, rays.packet, hit, stats);
      if (Q == Query::any && hit.t == -kInfinity) return hit;
    }
    do {
      if (stack.size == 0) return hit;
      --stack.size;
    } while (Q == Query::closest && stack.enter[stack.size] > hit.t);
    child = stack.child[stack.size];
  }
}

template <Query Q, class L, class View, class Stats>
void trace(const View& bvh, const TraceArgs& args, Stats stats) noexcept {
  for (std::int32_t first = 0; first < args.rays.count; first += L::kWidth) {
    const std::int32_t left = args.rays.count - first, count = left < L::kWidth ? left : L::kWidth;
    SingleRays<L> rays(args.rays, first, count);
    for (std::int32_t lane = 0; lane < count; ++lane) {
      const SingleHit hit = trace_one<Q>(bvh, rays, lane, args.scratch, stats);
      const bool missed = hit.prim == kNoPrim;
      const std::int32_t i = first + lane;
      if constexpr (Q == Query::any) {
        args.blocker[i] = missed ? -1 : hit.prim;
      } else {
        args.hits.t[i] = missed ? kInfinity : hit.t * rays.columns.t_unit[lane];
        args.hits.prim[i] = missed ? -1 : hit.prim;
        args.hits.u[i] = hit.u;
        args.hits.v[i] = hit.v;
      }
    }
  }
}

}  // namespace

template <Isa I, class Stats>
void SingleKernel<I, Stats>::closest(const WideBvhView& bvh, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::closest, Lanes<I>>(bvh, args, Stats(counters));
}

template <Isa I, class Stats>
void SingleKernel<I, Stats>::any(const WideBvhView& bvh, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::any, Lanes<I>>(bvh, args, Stats(counters));
}

template <Isa I, class Stats>
void SingleKernel<I, Stats>::closest(const QuantisedBvhView& bvh, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::closest, Lanes<I>>(bvh, args, Stats(counters));
}

template <Isa I, class Stats>
void SingleKernel<I, Stats>::any(const QuantisedBvhView& bvh, const TraceArgs& args, Counters* counters) noexcept {
  trace<Query::any, Lanes<I>>(bvh, args, Stats(counters));
}

template struct SingleKernel<kKernelIsa, NoStats>;
template struct SingleKernel<kKernelIsa, CountStats>;

}  // namespace raymeter
