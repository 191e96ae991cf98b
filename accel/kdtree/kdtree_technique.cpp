#include "accel/kdtree/kd_kernel.h"
#include "accel/kdtree/kd_tree.h"
#include "accel/kdtree/kdtree.h"
#include "accel/kernel_intersector.h"

namespace raymeter {

namespace {

template <class Params>
std::vector<Param<Params>> shared_fields() {
  return {
      {"max_depth", &Params::max_depth, "no cell is split more often; 0: 8 + 1.3 log2 of the primitives", 0, 64},
      {"leaf_size", &Params::leaf_size, "cells of at most that many primitives are not split", 1, 64},
      {"clip", &Params::clip, "triangles that a plane cuts go to the sides of it that they reach within the cell; off: that their boxes reach"},
      {"reference_budget", &Params::reference_budget, "most references a primitive, beyond 4096 in all", 1, 1000},
      {"traversal",
       &Params::traversal,
       "how packets go through it: each ray by itself, or with bounds on all of them",
       0,
       0,
       {"packet", "frustum"},
       ParamUse::query},
      {"mailbox", &Params::mailbox, "a packet remembers what it tested, in a table of 16 slots, and tests none of that again", 0, 0, {}, ParamUse::query},
  };
}

template <class Params>
class KdStructure final : public Structure {
public:
  KdStructure(const Scene& scene, const KdTopology& topology) : stats_(kd_stats(topology)), tree_(lay_out(scene, topology)) {
    stats_.mem_bytes = tree_.mem_bytes();
  }
  [[nodiscard]] const BuildStats& stats() const noexcept override { return stats_; }
  [[nodiscard]] std::unique_ptr<Intersector> intersector(const QueryOptions& options) const override {
    const auto params = bind<Params>(options.params);
    const KdView view = tree_.view(params.traversal == "frustum", params.mailbox);
    return std::make_unique<KernelIntersector<KdView>>(view, kernels_for<KdKernel, KdView>(options.isa), options.packet,
                                                       kd_stack_bytes(tree_.stack_capacity(), options.packet));
  }

private:
  BuildStats stats_;
  KdTree tree_;
};

}  // namespace

std::vector<Param<KdTreeParams>> KdTreeParams::fields() {
  std::vector<Param<KdTreeParams>> fields = shared_fields<KdTreeParams>();
  fields.insert(fields.end() - 2,
                {
                    {"traversal_cost", &KdTreeParams::traversal_cost, "surface area heuristic: cost of an inner node", 0.01, 100},
                    {"intersection_cost", &KdTreeParams::intersection_cost, "surface area heuristic: cost of a primitive test", 0.01, 100},
                    {"empty_bonus", &KdTreeParams::empty_bonus, "surface area heuristic: share of a split's cost spared where a side is empty", 0, 1},
                });
  return fields;
}

std::vector<Param<BspParams>> BspParams::fields() { return shared_fields<BspParams>(); }

std::unique_ptr<Structure> build_kdtree(const Scene& scene, const ParamValues& values, int threads) {
  const auto params = bind<KdTreeParams>(values);
  const auto choose = [&](std::span<const SplitReference> references, const Aabb& cell, int) { return cheapest_kd_plane(references, cell, params); };
  return std::make_unique<KdStructure<KdTreeParams>>(scene, build_kd_topology(scene, params, choose, threads));
}

std::unique_ptr<Structure> build_bsp(const Scene& scene, const ParamValues& values, int threads) {
  const auto params = bind<BspParams>(values);
  const auto choose = [](std::span<const SplitReference>, const Aabb& cell, int depth) { return median_kd_plane(cell, depth); };
  return std::make_unique<KdStructure<BspParams>>(scene, build_kd_topology(scene, params, choose, threads));
}

}  // namespace raymeter
