// Goldsmith & Salmon 1987 (goldsmith_salmon.h): the order of insertion, and the finished hierarchy as a tree.

#include <algorithm>
#include <mutex>
#include <numeric>

#include <tbb/parallel_for.h>

#include "accel/bvh/build_prims.h"
#include "accel/bvh/goldsmith_salmon.h"
#include "core/base/random.h"
#include "core/base/threads.h"

namespace raymeter {

namespace {

using Order = std::vector<std::int32_t>;

/// Along the longest axis of the centres.
void sort_along_axis(Order& order, const std::vector<BuildPrim>& prims) {
  Aabb centers2;
  for (const BuildPrim& prim : prims) centers2.grow(prim.box.center2());
  const glm::vec3 extent = centers2.extent();
  const glm::length_t axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t p, std::int32_t q) {
    return prims[static_cast<std::size_t>(p)].box.center2()[axis] < prims[static_cast<std::size_t>(q)].box.center2()[axis];
  });
}

/// Fisher and Yates' shuffle.
void shuffle(Order& order, std::uint64_t seed) {
  RandomStream random(seed, 0);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.bits() % i]);
}

/// Of `shuffles` random orders, the one whose tree costs least; the first of several.
InsertionTree best_of_shuffles(const Order& file_order, const GoldsmithSalmonParams& params, const InsertAll& insert_all) {
  std::mutex mutex;
  InsertionTree best;
  int best_shuffle = -1;
  tbb::parallel_for(0, params.shuffles, [&](int k) {
    Order order = file_order;
    shuffle(order, static_cast<std::uint64_t>(params.insertion_seed + k));
    InsertionTree tree = insert_all(order);
    const std::lock_guard lock(mutex);
    if (best_shuffle >= 0 && (best.cost < tree.cost || (best.cost == tree.cost && best_shuffle < k))) return;
    best = std::move(tree);
    best_shuffle = k;
  });
  return best;
}

/// The hierarchy with boxes around what its nodes hold, breadth first.
BvhTree with_boxes(const InsertionTree& from, const std::vector<BuildPrim>& prims) {
  BvhTree tree;
  if (from.nodes.empty()) return tree;
  tree.nodes.reserve(from.nodes.size());
  tree.nodes.push_back({});
  Order source{0};
  source.reserve(from.nodes.size());
  for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
    const InsertionNode& node = from.nodes[static_cast<std::size_t>(source[n])];
    if (node.child_count == 0) {
      tree.nodes[n] = {prims[static_cast<std::size_t>(node.prim)].box, static_cast<std::int32_t>(tree.order.size()), 0, 1};
      tree.order.push_back(prims[static_cast<std::size_t>(node.prim)].ref);
      continue;
    }
    tree.nodes[n].child_count = node.child_count;
    tree.nodes[n].first = static_cast<std::int32_t>(tree.nodes.size());
    for (std::int32_t c = node.first_child; c != InsertionNode::kNone; c = from.nodes[static_cast<std::size_t>(c)].next) {
      tree.nodes.push_back({});
      source.push_back(c);
    }
  }
  for (auto n = static_cast<std::int32_t>(tree.nodes.size()); n-- > 0;) {
    BvhTree::Node& node = tree.node(n);
    for (std::int32_t c = node.first; c < node.first + node.child_count; ++c) node.box.grow(tree.node(c).box);
  }
  return tree;
}

/// Gathers the leaves under each node in one leaf with the node's own box: a ray that opens the node tests them all.
void drop_leaf_boxes(BvhTree& tree) {
  for (BvhTree::Node& node : tree.nodes) {
    if (node.child_count == 0) continue;
    const auto first = tree.nodes.begin() + node.first, last = first + node.child_count;
    // Inner children first; they keep their order.
    const auto leaves = std::stable_partition(first, last, [](const BvhTree::Node& child) { return child.child_count > 0; });
    if (leaves == last) continue;
    const auto begin = static_cast<std::int32_t>(tree.order.size());
    for (auto leaf = leaves; leaf != last; ++leaf) tree.order.push_back(tree.order[static_cast<std::size_t>(leaf->first)]);
    *leaves = {node.box, begin, 0, static_cast<std::int32_t>(last - leaves)};
    node.child_count = static_cast<std::int32_t>(leaves - first) + 1;
  }
}

}  // namespace

BvhTree build_by_insertion(const Scene& scene, const GoldsmithSalmonParams& params, int threads, const InsertAll& insert_all) {
  return on_threads(threads, [&] {
    const std::vector<BuildPrim> prims = build_prims(scene);
    Order order(prims.size());
    std::iota(order.begin(), order.end(), 0);
    if (params.insertion_order == "sorted") sort_along_axis(order, prims);
    if (params.insertion_order == "shuffled") shuffle(order, static_cast<std::uint64_t>(params.insertion_seed));
    BvhTree tree = with_boxes(params.insertion_order == "best" ? best_of_shuffles(order, params, insert_all) : insert_all(order), prims);
    if (!params.leaf_boxes) drop_leaf_boxes(tree);
    return depth_first(tree);
  });
}

}  // namespace raymeter
