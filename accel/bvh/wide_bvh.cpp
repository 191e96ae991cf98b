#include "accel/bvh/wide_bvh.h"

#include <algorithm>

#include "accel/bvh/auto_intersector.h"
#include "accel/bvh/bvh.h"
#include "accel/bvh/collapse.h"
#include "accel/bvh/single_kernel.h"
#include "accel/bvh/stream_kernel.h"
#include "accel/bvh/wide_kernel.h"
#include "accel/bvh/wide_tree.h"
#include "accel/kernel_intersector.h"

namespace raymeter {

namespace {

class WideBvh final : public Structure {
public:
  WideBvh(const Scene& scene, const Aabb& box, WideTree tree)
      : tree_(std::move(tree)),
        pools_(reordered(scene.pools(), tree_.order)),
        view_{tree_.nodes.data(),   tree_.blocks.data(), tree_.runs.data(), pools_.view(), {box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z},
              tree_.stack_capacity, kMaxGroupRays},
        leaves_(leaf_sizes(tree_.nodes.span())) {
    tree_.order = {};
    tree_.stats.mem_bytes = sizeof *this + tree_.nodes.bytes() + tree_.blocks.bytes() + tree_.runs.capacity() * sizeof(PrimitiveRun) + pools_.mem_bytes();
  }
  [[nodiscard]] const BuildStats& stats() const noexcept override { return tree_.stats; }
  [[nodiscard]] std::unique_ptr<Intersector> intersector(const QueryOptions& options) const override {
    const BvhParams params = bind<BvhParams>(options.params);
    if (params.traversal == "beam") return beams(options);
    if (params.traversal == "stream") return streams(options);
    if (params.traversal == "single") return singles(options);
    return std::make_unique<AutoIntersector>(AutoIntersector::Traversals{beams(options), streams(options), singles(options)}, options.packet,
                                             simd_width(options.isa), params.group, leaves_, view_.box);
  }

private:
  [[nodiscard]] std::unique_ptr<Intersector> beams(const QueryOptions& options) const {
    WideBvhView view = view_;
    view.group_rays = bind<BvhParams>(options.params).group;
    return std::make_unique<KernelIntersector<WideBvhView>>(view, kernels_for<WideBvhKernel, WideBvhView>(options.isa), options.packet,
                                                            beam_stack_bytes(view_.stack_capacity));
  }
  [[nodiscard]] std::unique_ptr<Intersector> streams(const QueryOptions& options) const {
    return std::make_unique<KernelIntersector<WideBvhView>>(view_, kernels_for<StreamKernel, WideBvhView>(options.isa), options.packet,
                                                            stream_bytes(view_.stack_capacity));
  }
  [[nodiscard]] std::unique_ptr<Intersector> singles(const QueryOptions& options) const {
    return std::make_unique<KernelIntersector<WideBvhView>>(view_, kernels_for<SingleKernel, WideBvhView>(options.isa), options.packet,
                                                            single_bytes(view_.stack_capacity));
  }

  WideTree tree_;
  Pools pools_;
  WideBvhView view_;
  LeafSizes leaves_;
};

}  // namespace

WideTree make_wide_tree(const Scene& scene, BvhTree tree, int max_leaf_size, int threads) {
  if (std::ranges::any_of(tree.nodes, [](const BvhTree::Node& node) { return node.child_count > 2; })) tree = with_width(tree, 2, threads);
  WideTreeSettings settings;
  settings.max_leaf_size = max_leaf_size;
  return collapse_wide(scene, std::move(tree), settings, threads);
}

std::unique_ptr<Structure> build_wide_bvh(const Scene& scene, BvhTree tree, int max_leaf_size, int threads) {
  const Aabb box = tree.nodes.empty() ? Aabb{} : tree.nodes[0].box;
  return std::make_unique<WideBvh>(scene, box, make_wide_tree(scene, std::move(tree), max_leaf_size, threads));
}

}  // namespace raymeter
