// LBVH: Lauterbach et al. 2009, "Fast BVH construction on GPUs". Primitives are sorted along the Morton curve, and a node is split where the highest bit in
// which its codes differ changes: the middle of a cell in space. Equal codes are halved. Departures: 63 bits instead of 30, and subtrees become leaves where
// the surface area heuristic says so, since one primitive a leaf costs more nodes than any other builder spends.

#include <algorithm>
#include <bit>

#include <tbb/parallel_invoke.h>

#include "accel/bvh/box_builders.h"
#include "accel/bvh/build_prims.h"
#include "accel/bvh/merge_leaves.h"
#include "accel/bvh/morton_order.h"
#include "core/base/threads.h"

namespace raymeter {

namespace {

constexpr std::int32_t kParallelPrims = 4096;  // smaller subtrees are built by one task

class Lbvh {
public:
  Lbvh(const std::vector<BuildPrim>& prims, const std::vector<MortonPrim>& order) : prims_(prims), order_(order) {}

  BvhTree build() {
    BvhTree tree;
    if (order_.empty()) return tree;
    nodes_.resize(2 * order_.size() - 1);
    split(0, 1, 0, static_cast<std::int32_t>(order_.size()));
    tree.nodes = std::move(nodes_);
    for (const MortonPrim& at : order_) tree.order.push_back(prims_[static_cast<std::size_t>(at.prim)].ref);
    return tree;
  }

private:
  [[nodiscard]] BvhTree::Node& node(std::int32_t n) noexcept { return nodes_[static_cast<std::size_t>(n)]; }
  [[nodiscard]] std::uint64_t code(std::int32_t position) const noexcept { return order_[static_cast<std::size_t>(position)].code; }

  /// A subtree over m primitives has 2 m - 2 nodes below its root: they stand from `slot` on, whichever task makes them.
  void split(std::int32_t n, std::int32_t slot, std::int32_t first, std::int32_t last) {
    if (last - first == 1) {
      node(n) = {prims_[static_cast<std::size_t>(order_[static_cast<std::size_t>(first)].prim)].box, first, 0, 1};
      return;
    }
    const std::int32_t middle = split_position(first, last);
    const std::int32_t left_slot = slot + 2, right_slot = left_slot + 2 * (middle - first) - 2;
    const auto left = [&] { split(slot, left_slot, first, middle); };
    const auto right = [&] { split(slot + 1, right_slot, middle, last); };
    if (last - first >= kParallelPrims) {
      tbb::parallel_invoke(left, right);
    } else {
      left();
      right();
    }
    node(n) = {node(slot).box, slot, 2, 0};
    node(n).box.grow(node(slot + 1).box);
  }

  [[nodiscard]] std::int32_t split_position(std::int32_t first, std::int32_t last) const {
    const std::uint64_t differing = code(first) ^ code(last - 1);
    if (differing == 0) return first + (last - first) / 2;
    const std::uint64_t bit = std::bit_floor(differing);
    const auto begin = order_.begin();
    const auto middle = std::partition_point(begin + first, begin + last, [&](const MortonPrim& at) { return (at.code & bit) == 0; });
    return static_cast<std::int32_t>(middle - begin);
  }

  const std::vector<BuildPrim>& prims_;
  const std::vector<MortonPrim>& order_;
  Column<BvhTree::Node> nodes_;
};

}  // namespace

BvhTree build_lbvh(const Scene& scene, const SahParams& params, int threads) {
  return on_threads(threads, [&] {
    const std::vector<BuildPrim> prims = build_prims(scene);
    return merge_leaves(Lbvh(prims, build_morton_order(prims)).build(), params);
  });
}

}  // namespace raymeter
