#include "accel/bvh/prepare_wide.h"

#include <algorithm>

#include "accel/bvh/triangle_block.h"
#include "core/base/threads.h"

namespace raymeter {

namespace {

class Preparation {
public:
  Preparation(const Scene& scene, BvhTree& tree, int max_leaf_size) : scene_(scene), tree_(tree), max_leaf_size_(max_leaf_size) {}

  void run() {
    Nodes found = look_through();
    if (!found.single_children.empty()) {
      for (const std::size_t n : found.single_children) {
        while (tree_.nodes[n].child_count == 1) tree_.nodes[n] = tree_.nodes[static_cast<std::size_t>(tree_.nodes[n].first)];
      }
      found = look_through();
    }
    for (const std::size_t n : found.large_leaves) {
      std::size_t next = tree_.nodes.size();
      for (split_leaf(n); next < tree_.nodes.size(); ++next) split_leaf(next);  // grows behind `next`
    }
  }

private:
  /// Nodes that want work, in order.
  struct Nodes {
    std::vector<std::size_t> single_children;
    std::vector<std::size_t> large_leaves;
  };

  [[nodiscard]] Nodes look_through() const {
    constexpr std::size_t kPart = 16384;
    std::vector<Nodes> parts((tree_.nodes.size() + kPart - 1) / kPart);
    for_each_task(parts.size(), [&](std::size_t p) {
      for (std::size_t n = p * kPart; n < std::min((p + 1) * kPart, tree_.nodes.size()); ++n) {
        if (tree_.nodes[n].child_count == 1) parts[p].single_children.push_back(n);
        if (tree_.nodes[n].child_count == 0 && !is_known_to_fit(tree_.nodes[n]) && is_large(tree_.nodes[n])) parts[p].large_leaves.push_back(n);
      }
    });
    Nodes all;
    for (const Nodes& part : parts) {
      all.single_children.insert(all.single_children.end(), part.single_children.begin(), part.single_children.end());
      all.large_leaves.insert(all.large_leaves.end(), part.large_leaves.begin(), part.large_leaves.end());
    }
    return all;
  }
  /// As it comes from the builder: of mixed leaves the triangles may have to be split further.
  [[nodiscard]] bool is_known_to_fit(const BvhTree::Node& leaf) const {
    const auto is_triangle = [&](std::int32_t i) { return tree_.order[static_cast<std::size_t>(leaf.first + i)].kind() == PrimKind::triangle; };
    return tree_.fits_blocks && is_triangle(0) && is_triangle(leaf.prim_count - 1);
  }
  [[nodiscard]] bool is_large(const BvhTree::Node& leaf) const {
    const auto begin = tree_.order.begin() + leaf.first;
    return leaf.prim_count > 1 && !fits_leaf(scene_.pools(), {begin, begin + leaf.prim_count}, max_leaf_size_);
  }
  void split_leaf(std::size_t n) {
    const BvhTree::Node leaf = tree_.nodes[n];
    if (!is_large(leaf)) return;
    const auto begin = tree_.order.begin() + leaf.first;
    const auto end = begin + leaf.prim_count;
    const auto by_kind = [](PrimRef a, PrimRef b) { return a.kind() < b.kind(); };
    if (!std::is_sorted(begin, end, by_kind)) std::stable_sort(begin, end, by_kind);
    const auto next_kind = std::upper_bound(begin, end, *begin, by_kind);
    const auto middle = next_kind != end ? next_kind : begin + leaf.prim_count / 2;
    const auto part = [&](auto from, auto to) {
      BvhTree::Node node;
      for (auto ref = from; ref != to; ++ref) node.box.grow(padded_bounds(scene_.pools(), *ref));
      node.first = static_cast<std::int32_t>(from - tree_.order.begin());
      node.prim_count = static_cast<std::int32_t>(to - from);
      return node;
    };
    const BvhTree::Node children[] = {part(begin, middle), part(middle, end)};
    tree_.nodes[n] = {leaf.box, static_cast<std::int32_t>(tree_.nodes.size()), 2, 0};
    for (const BvhTree::Node& child : children) tree_.nodes.push_back(child);
  }

  const Scene& scene_;
  BvhTree& tree_;
  int max_leaf_size_;
};

}  // namespace

void prepare_wide(const Scene& scene, BvhTree& tree, int max_leaf_size) { Preparation(scene, tree, max_leaf_size).run(); }

}  // namespace raymeter
