#include "accel/grid/recursive_grid.h"
#include "accel/grid/recursive_grid_kernel.h"
#include "accel/kernel_intersector.h"

namespace raymeter {

RecursiveGridView RecursiveGrid::view(bool mailbox, bool from_origin) const noexcept {
  RecursiveGridView view{pools.view(), frame, grids.data(), cells.data(), first.data(), refs.data(), static_cast<std::int32_t>(kinds.size()),
                         {},           {},    mailbox,      from_origin};
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    view.kind[k] = kinds[k];
    view.prim_count[k] = static_cast<std::int32_t>(pools.size(kinds[k]));
  }
  return view;
}

namespace {

class NestedGrids final : public Structure {
public:
  explicit NestedGrids(RecursiveGrid grid) : grid_(std::move(grid)) {
    stats_.interior_nodes = static_cast<std::int64_t>(grid_.grids.size());
    stats_.leaves = static_cast<std::int64_t>(grid_.cells.size()) - (stats_.interior_nodes - 1);
    for (const CellLink cell : grid_.cells) stats_.empty_leaves += cell.is_empty() ? 1 : 0;
    stats_.references = static_cast<std::int64_t>(grid_.refs.size());
    stats_.max_depth = grid_.depth;
    stats_.mem_bytes = sizeof *this + grid_.grids.bytes() + grid_.cells.bytes() + grid_.first.bytes() + grid_.refs.bytes() + grid_.pools.mem_bytes();
  }
  [[nodiscard]] const BuildStats& stats() const noexcept override { return stats_; }
  [[nodiscard]] std::unique_ptr<Intersector> intersector(const QueryOptions& options) const override {
    const auto params = bind<RecursiveGridParams>(options.params);
    return std::make_unique<KernelIntersector<RecursiveGridView>>(grid_.view(params.mailbox, params.start == "origin"),
                                                                  kernels_for<RecursiveGridKernel, RecursiveGridView>(options.isa), options.packet);
  }

private:
  RecursiveGrid grid_;
  BuildStats stats_;
};

}  // namespace

std::unique_ptr<Structure> build_recursive_grid(const Scene& scene, const ParamValues& values, int threads) {
  return std::make_unique<NestedGrids>(build_nested_grids(scene, bind<RecursiveGridParams>(values), threads));
}

}  // namespace raymeter
