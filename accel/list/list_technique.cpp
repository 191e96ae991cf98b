#include "accel/kernel_intersector.h"
#include "accel/list/list.h"
#include "accel/list/list_kernel.h"

namespace raymeter {

namespace {

class List final : public Structure {
public:
  explicit List(const Scene& scene) : view_{scene.pools().view(), {}, 0} {
    for (std::size_t kind = 0; kind < kPrimKindCount; ++kind) {
      const auto count = static_cast<std::int32_t>(scene.pools().size(static_cast<PrimKind>(kind)));
      if (count > 0) view_.run[view_.run_count++] = primitive_run(static_cast<PrimKind>(kind), 0, count);
    }
    stats_.leaves = 1;
    stats_.empty_leaves = scene.prim_count() == 0 ? 1 : 0;
    stats_.references = scene.prim_count();
    stats_.max_depth = 0;
    stats_.sah_cost = scene.prim_count();
    stats_.mem_bytes = sizeof *this;
  }
  [[nodiscard]] const BuildStats& stats() const noexcept override { return stats_; }
  [[nodiscard]] std::unique_ptr<Intersector> intersector(const QueryOptions& options) const override {
    return std::make_unique<KernelIntersector<ListView>>(view_, kernels_for<ListKernel, ListView>(options.isa), options.packet);
  }

private:
  ListView view_;
  BuildStats stats_;
};

}  // namespace

std::unique_ptr<Structure> build_list(const Scene& scene, const ParamValues&, int) { return std::make_unique<List>(scene); }

}  // namespace raymeter
