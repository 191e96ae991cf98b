#include "accel/grid/grid.h"
#include "accel/grid/grid_build.h"
#include "accel/grid/grid_kernel.h"
#include "accel/kernel_intersector.h"

namespace raymeter {

namespace {

class Grid final : public Structure {
public:
  explicit Grid(UniformGrid grid) : grid_(std::move(grid)) {
    const std::size_t kinds = grid_.kinds.size();
    for (std::size_t slot = 0; slot + 1 < grid_.first.size(); slot += kinds) stats_.empty_leaves += grid_.first[slot] == grid_.first[slot + kinds] ? 1 : 0;
    stats_.leaves = grid_.cell_count();
    stats_.references = static_cast<std::int64_t>(grid_.refs.size());
    stats_.max_depth = 0;
    stats_.mem_bytes = sizeof *this + grid_.occupied.bytes() + grid_.first.bytes() + grid_.refs.bytes() + grid_.pools.mem_bytes();
  }
  [[nodiscard]] const BuildStats& stats() const noexcept override { return stats_; }
  [[nodiscard]] std::unique_ptr<Intersector> intersector(const QueryOptions& options) const override {
    const auto params = bind<GridParams>(options.params);
    const GridView view = grid_.view(params.mailbox, params.start == "origin", params.blocker == "nearest");
    if (params.traversal == "slices") {
      return std::make_unique<KernelIntersector<GridView>>(view, kernels_for<GridSlicesKernel, GridView>(options.isa), options.packet);
    }
    return std::make_unique<KernelIntersector<GridView>>(view, kernels_for<GridLanesKernel, GridView>(options.isa), options.packet);
  }

private:
  UniformGrid grid_;
  BuildStats stats_;
};

}  // namespace

std::unique_ptr<Structure> build_grid(const Scene& scene, const ParamValues& values, int threads) {
  return std::make_unique<Grid>(build_uniform_grid(scene, bind<GridParams>(values), threads));
}

}  // namespace raymeter
