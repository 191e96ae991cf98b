#include <optional>
#include <utility>

#include "accel/grid/grid.h"
#include "accel/grid/grid_build.h"
#include "accel/grid/grid_kernel.h"
#include "accel/kernel_intersector.h"
#include "core/trace/cell_walk.h"

namespace raymeter {

namespace {

/// What of the kernels there is once for each form of the DDA.
struct FormKernels {
  KernelSet<GridView> lanes;
  decltype(&CellWalkKernel<Isa::scalar, DdaForm::recompute>::walk) walk;
};

template <DdaForm F>
struct OfForm {
  template <Isa I, class Stats>
  using Lanes = GridLanesKernel<I, Stats, F>;

  static FormKernels kernels(Isa isa) noexcept {
    return {kernels_for<Lanes, GridView>(isa), for_isa(isa, []<Isa I>() { return CellWalkKernel<I, F>::walk; })};
  }
};

/// Of the form of that name, which is among the parameter's choices; else throws std::bad_optional_access.
FormKernels kernels_of_form(std::string_view name, Isa isa) {
  std::optional<FormKernels> found;
  const auto look_at = [&]<std::size_t kAt>() {
    if (kDdaForms[kAt].name == name) found = OfForm<kDdaForms[kAt].form>::kernels(isa);
  };
  [&]<std::size_t... kAt>(std::index_sequence<kAt...>) { (look_at.template operator()<kAt>(), ...); }
  (std::make_index_sequence<kDdaForms.size()>());
  return found.value();
}

/// Lanes that step each on its own, and can show where.
class LanesIntersector final : public KernelIntersector<GridView>, public CellWalk {
public:
  LanesIntersector(const UniformGrid& grid, const GridView& view, const FormKernels& kernels, int packet)
      : KernelIntersector(view, kernels.lanes, packet), grid_(grid), walk_(kernels.walk) {}

  [[nodiscard]] Cells cells() const override {
    Cells cells;
    for (std::size_t a = 0; a < 3; ++a) {
      const GridFrame& frame = grid_.frame;
      for (std::int32_t i = 1; i < frame.resolution[a]; ++i) cells.planes[a].push_back(grid_plane(static_cast<float>(i), frame.cell_size[a], frame.origin[a]));
      cells.cell_size[a] = frame.cell_size[a];
      cells.margin[a] = grid_.margin[a];
      cells.box.min[static_cast<glm::length_t>(a)] = frame.box[a];
      cells.box.max[static_cast<glm::length_t>(a)] = frame.box[a + 3];
    }
    return cells;
  }
  void walk(const RayView& rays, std::int32_t* visited, std::int32_t* count) const noexcept override {
    const std::int32_t* const n = view_.frame.resolution;
    walk_(view_, rays, n[0] + n[1] + n[2] - 2, visited, count);
  }

private:
  static_assert(kWalksEverywhere == kEverywhere);
  const UniformGrid& grid_;
  decltype(FormKernels::walk) walk_;
};

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
    return std::make_unique<LanesIntersector>(grid_, view, kernels_of_form(params.dda, options.isa), options.packet);
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
