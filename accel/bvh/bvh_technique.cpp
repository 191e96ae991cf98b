#include <algorithm>

#include "accel/bvh/bvh.h"
#include "accel/bvh/bvh_layout.h"
#include "accel/bvh/bvh_tree.h"
#include "accel/bvh/packet_kernel.h"
#include "accel/kernel_intersector.h"

namespace raymeter {

namespace {

/// Lays a tree out: links in depth-first order of their parents, a leaf's primitives together in the pools.
class Layout {
public:
  explicit Layout(const BvhTree& tree) : tree_(tree) {}

  void run() {
    links.resize(2, BvhLink{{kInf, kInf, kInf, -kInf, -kInf, -kInf}, 0, 0});
    if (tree_.nodes.empty()) return;
    links.reserve(tree_.nodes.size() + 1);
    struct Item {
      std::int32_t node;
      std::size_t link;
      std::int32_t stack_below;
    };
    std::vector<Item> open{{0, 0, 1}};
    while (!open.empty()) {
      const Item item = open.back();
      open.pop_back();
      const BvhTree::Node& node = tree_.nodes[static_cast<std::size_t>(item.node)];
      const Aabb& box = node.box;
      BvhLink link{{box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z}, 0, 0};
      stack_capacity = std::max(stack_capacity, item.stack_below);
      if (node.child_count == 0) {
        set_leaf(link, node);
      } else {
        link.tag_and_count = BvhLink::kInner << PrimitiveRun::kCountBits | static_cast<std::uint32_t>(node.child_count);
        link.first = static_cast<std::int32_t>(links.size());
        links.resize(links.size() + static_cast<std::size_t>(node.child_count));
        // Opening this node puts its children on the stack in its own place.
        const std::int32_t stack_below = item.stack_below + node.child_count - 1;
        for (std::int32_t c = node.child_count - 1; c >= 0; --c) {
          open.push_back({node.first + c, static_cast<std::size_t>(link.first + c), stack_below});
        }
        stack_capacity = std::max(stack_capacity, stack_below);
      }
      links[item.link] = link;
    }
  }

  Column<BvhLink> links;
  std::vector<PrimitiveRun> runs;
  std::vector<PrimRef> order;  ///< primitives as the leaves come
  std::int32_t stack_capacity = 1;

private:
  static constexpr float kInf = std::numeric_limits<float>::infinity();

  void set_leaf(BvhLink& link, const BvhTree::Node& node) {
    std::vector<PrimitiveRun> leaf;
    for (std::int32_t i = 0; i < node.prim_count;) {
      const PrimKind kind = tree_.order[static_cast<std::size_t>(node.first + i)].kind();
      std::int32_t end = i;
      while (end < node.prim_count && tree_.order[static_cast<std::size_t>(node.first + end)].kind() == kind) ++end;
      std::int32_t& next = next_of_kind_[static_cast<std::size_t>(kind)];
      leaf.push_back(primitive_run(kind, next, end - i));
      next += end - i;
      i = end;
    }
    const auto begin = tree_.order.begin() + node.first;
    order.insert(order.end(), begin, begin + node.prim_count);
    if (leaf.size() == 1) {
      link.tag_and_count = leaf[0].kind_and_count;
      link.first = leaf[0].first;
    } else {
      link.tag_and_count = BvhLink::kRuns << PrimitiveRun::kCountBits | static_cast<std::uint32_t>(leaf.size());
      link.first = static_cast<std::int32_t>(runs.size());
      runs.insert(runs.end(), leaf.begin(), leaf.end());
    }
  }

  const BvhTree& tree_;
  std::array<std::int32_t, kPrimKindCount> next_of_kind_{};
};

class Bvh final : public Structure {
public:
  Bvh(const Scene& scene, const BvhTree& tree) : stats_(tree_stats(tree)) {
    Layout layout(tree);
    layout.run();
    links_ = std::move(layout.links);
    runs_ = std::move(layout.runs);
    stack_capacity_ = layout.stack_capacity;
    pools_ = reordered(scene.pools(), layout.order);
    stats_.mem_bytes = sizeof *this + links_.bytes() + runs_.capacity() * sizeof(PrimitiveRun) + pools_.mem_bytes();
  }
  [[nodiscard]] const BuildStats& stats() const noexcept override { return stats_; }
  [[nodiscard]] std::unique_ptr<Intersector> intersector(const QueryOptions& options) const override {
    const BvhView view{links_.data(), runs_.data(), pools_.view(), stack_capacity_};
    return std::make_unique<KernelIntersector<BvhView>>(view, kernels_for<BvhPacketKernel, BvhView>(options.isa), options.packet,
                                                        bvh_stack_bytes(stack_capacity_));
  }

private:
  BuildStats stats_;
  Column<BvhLink> links_;
  std::vector<PrimitiveRun> runs_;
  Pools pools_;
  std::int32_t stack_capacity_ = 1;
};

}  // namespace

std::unique_ptr<Structure> build_bvh(const Scene& scene, const ParamValues& values, int threads) {
  return std::make_unique<Bvh>(scene, build_bvh_tree(scene, bind<BvhParams>(values), threads));
}

}  // namespace raymeter
