// The cells that the walk leads rays through, for tests and records: not in the files of the forms, whose kernels are timed (dda_lanes_kernel.h).

#include "accel/grid/grid_kernel.h"
#include "accel/grid/grid_lanes_kernel.h"

namespace raymeter {

template <Isa I, DdaForm F>
void CellWalkKernel<I, F>::walk(const GridView& grid, const RayView& rays, std::int32_t stride, std::int32_t* cells, std::int32_t* count) noexcept {
  using L = Lanes<I>;
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

template struct CellWalkKernel<kKernelIsa, DdaForm::recompute>;
template struct CellWalkKernel<kKernelIsa, DdaForm::divide>;
template struct CellWalkKernel<kKernelIsa, DdaForm::fma>;
template struct CellWalkKernel<kKernelIsa, DdaForm::accumulate>;
template struct CellWalkKernel<kKernelIsa, DdaForm::compensated>;

}  // namespace raymeter
