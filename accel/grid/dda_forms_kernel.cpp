#include "accel/grid/grid_kernel.h"

#include "accel/grid/grid_lanes_kernel.h"

namespace raymeter {

namespace {

/// Calls trace.operator()<F>() with the view's form, which is another than the default: that one has kernels of its own.
template <class Trace>
[[gnu::always_inline]] inline void with_other_form(DdaForm form, Trace&& trace) noexcept {
  if (form == DdaForm::divide) return trace.template operator()<DdaForm::divide>();
  if (form == DdaForm::fma) return trace.template operator()<DdaForm::fma>();
  if (form == DdaForm::accumulate) return trace.template operator()<DdaForm::accumulate>();
  return trace.template operator()<DdaForm::compensated>();
}

template <class L, DdaForm F>
void walk_past_all(const GridView& grid, const RayView& rays, std::int32_t stride, std::int32_t* cells, std::int32_t* count) noexcept {
  Packet<L, 1> packet;
  GridWalk<L, F> walk[1];
  typename L::Mask irregular[1];
  alignas(64) std::int32_t cell_of[L::kWidth];
  for (std::int32_t first = 0; first < rays.count; first += L::kWidth) {
    const std::int32_t left = rays.count - first;
    load_packet(rays, first, left < L::kWidth ? left : L::kWidth, packet);
    begin_walk(grid, packet, walk, irregular);
    const std::uint32_t everywhere = L::bits(irregular[0]);
    for (std::int32_t lane = 0; lane < L::kWidth && lane < left; ++lane) count[first + lane] = (everywhere >> lane & 1u) != 0 ? kWalksEverywhere : 0;
    for_each_front(grid.frame, packet, false, walk, [&](const typename L::Mask* front) noexcept {
      L::store(cell_of, walk[0].cell);
      for (std::uint32_t lanes = L::bits(front[0]); lanes != 0; lanes &= lanes - 1) {
        const std::int32_t lane = __builtin_ctz(lanes);
        cells[std::int64_t{first + lane} * stride + count[first + lane]++] = cell_of[lane];
      }
    });
  }
}

}  // namespace

template <Isa I, class Stats>
void DdaFormsKernel<I, Stats>::closest(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept {
  with_other_form(grid.dda, [&]<DdaForm F>() noexcept { trace_by_lanes<Query::closest, Lanes<I>, F>(grid, args, Stats(counters)); });
}

template <Isa I, class Stats>
void DdaFormsKernel<I, Stats>::any(const GridView& grid, const TraceArgs& args, Counters* counters) noexcept {
  with_other_form(grid.dda, [&]<DdaForm F>() noexcept { trace_by_lanes<Query::any, Lanes<I>, F>(grid, args, Stats(counters)); });
}

template <Isa I>
void CellWalkKernel<I>::walk(const GridView& grid, const RayView& rays, std::int32_t stride, std::int32_t* cells, std::int32_t* count) noexcept {
  const auto walk = [&]<DdaForm F>() noexcept { walk_past_all<Lanes<I>, F>(grid, rays, stride, cells, count); };
  if (grid.dda == DdaForm::recompute) return walk.template operator()<DdaForm::recompute>();
  with_other_form(grid.dda, walk);
}

template struct DdaFormsKernel<kKernelIsa, NoStats>;
template struct DdaFormsKernel<kKernelIsa, CountStats>;
template struct CellWalkKernel<kKernelIsa>;

}  // namespace raymeter
