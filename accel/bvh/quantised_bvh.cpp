#include "accel/bvh/quantised_bvh.h"

#include "accel/bvh/bvh.h"
#include "accel/bvh/quantised_nodes.h"
#include "accel/bvh/single_kernel.h"
#include "accel/bvh/stream_kernel.h"
#include "accel/kernel_intersector.h"

namespace raymeter {

namespace {

class QuantisedBvh final : public Structure {
public:
  QuantisedBvh(const Scene& scene, WideTree tree, int bits)
      : nodes_(quantised_nodes(tree.nodes.span(), bits)), tree_(std::move(tree)), pools_(reordered(scene.pools(), tree_.order)) {
    tree_.nodes = {};
    tree_.order = {};
    view_.blocks = tree_.blocks.data();
    view_.runs = tree_.runs.data();
    view_.pools = pools_.view();
    view_.stack_capacity = tree_.stack_capacity;
    view_.plane_bytes = nodes_.by_bytes.empty() ? 2 : 1;
    view_.quantised =
        view_.plane_bytes == 1 ? reinterpret_cast<const std::byte*>(nodes_.by_bytes.data()) : reinterpret_cast<const std::byte*>(nodes_.by_words.data());
    tree_.stats.mem_bytes = sizeof *this + nodes_.bytes() + tree_.blocks.bytes() + tree_.runs.capacity() * sizeof(PrimitiveRun) + pools_.mem_bytes();
  }
  [[nodiscard]] const BuildStats& stats() const noexcept override { return tree_.stats; }
  [[nodiscard]] std::unique_ptr<Intersector> intersector(const QueryOptions& options) const override {
    const bool alone = bind<BvhParams>(options.params).traversal == "single";
    const auto& kernels = alone ? kernels_for<SingleKernel, QuantisedBvhView>(options.isa) : kernels_for<StreamKernel, QuantisedBvhView>(options.isa);
    const std::size_t scratch = alone ? single_bytes(view_.stack_capacity) : stream_bytes(view_.stack_capacity);
    return std::make_unique<KernelIntersector<QuantisedBvhView>>(view_, kernels, options.packet, scratch);
  }

private:
  QuantisedNodes nodes_;
  WideTree tree_;  ///< without its nodes
  Pools pools_;
  QuantisedBvhView view_{};
};

}  // namespace

std::unique_ptr<Structure> make_quantised_bvh(const Scene& scene, WideTree tree, int bits) {
  return std::make_unique<QuantisedBvh>(scene, std::move(tree), bits);
}

}  // namespace raymeter
