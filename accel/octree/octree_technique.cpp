#include "accel/kernel_intersector.h"
#include "accel/octree/octree_parametric_kernel.h"
#include "accel/octree/octree_scratch_layout.h"
#include "accel/octree/octree_tree.h"
#include "accel/octree/octree_walk_kernel.h"

namespace raymeter {

namespace {

class OctreeStructure final : public Structure {
public:
  explicit OctreeStructure(Octree tree) : tree_(std::move(tree)) {
    tree_.stats.mem_bytes = sizeof *this + tree_.nodes.bytes() + tree_.outline.bytes() + tree_.first.bytes() + tree_.refs.bytes() + tree_.pools.mem_bytes();
  }
  [[nodiscard]] const BuildStats& stats() const noexcept override { return tree_.stats; }
  [[nodiscard]] std::unique_ptr<Intersector> intersector(const QueryOptions& options) const override {
    const auto params = bind<OctreeParams>(options.params);
    const OctreeView view = tree_.view(params);
    const auto make = [&](const KernelSet<OctreeView>& kernels) {
      return std::make_unique<KernelIntersector<OctreeView>>(view, kernels, options.packet, OctreeScratch::bytes(view.depth));
    };
    if (params.tracking == "parametric") return make(kernels_for<OctreeParametricKernel, OctreeView>(options.isa));
    return make(kernels_for<OctreeWalkKernel, OctreeView>(options.isa));
  }

private:
  Octree tree_;
};

}  // namespace

std::unique_ptr<Structure> build_octree(const Scene& scene, const ParamValues& values, int threads) {
  return std::make_unique<OctreeStructure>(build_octree_tree(scene, bind<OctreeParams>(values), threads));
}

}  // namespace raymeter
