#pragma once

#include <limits>
#include <span>
#include <vector>

#include "accel/bvh/wide_tree.h"

namespace raymeter {

/// Fills a block with triangles of the scene; false where they do not fit.
[[nodiscard]] bool fill_block(const TrianglePool& pool, std::span<const PrimRef> refs, TriangleBlock& block);

/// Replaces single children by what they hold, and splits leaves until each fits a leaf of a wide tree: of one kind, no more than a block or `max_leaf_size`.
void prepare(const Scene& scene, BvhTree& tree, int max_leaf_size);

/// The cheapest cut of each subtree of a binary tree that prepare() went through into at most 1 to 8 roots: leaves and nodes of a wide tree. `tree` must
/// outlive it.
class WideCuts {
public:
  WideCuts(const Scene& scene, const BvhTree& tree, const WideTreeSettings& settings);

  [[nodiscard]] const BvhTree::Node& at(std::int32_t n) const { return tree_.nodes[static_cast<std::size_t>(n)]; }
  [[nodiscard]] bool is_leaf(std::int32_t n) const { return cut_[static_cast<std::size_t>(n)].is_leaf; }
  /// Roots that the left child's part has of `roots`, where the subtree of n may be cut into that many; 0: it stays one.
  [[nodiscard]] int left_roots(std::int32_t n, int roots) const { return cut_[static_cast<std::size_t>(n)].left_roots[static_cast<std::size_t>(roots - 1)]; }
  /// The same for the children of a node that is opened whatever it costs.
  [[nodiscard]] int left_roots_below(std::int32_t n) const { return cut_[static_cast<std::size_t>(n)].left_roots_below; }
  [[nodiscard]] std::span<const PrimRef> prims(std::int32_t n) const {
    const Cut& cut = cut_[static_cast<std::size_t>(n)];
    return {order_.begin() + cut.first_prim, order_.begin() + cut.end_prim};
  }

private:
  struct Cut {
    float cost[kWideChildren];  ///< of at most 1, 2, ... roots
    std::uint8_t left_roots[kWideChildren]{};
    std::uint8_t left_roots_below = 0;
    bool is_leaf = false;
    bool fits_leaf = false;
    std::int32_t first_prim = 0, end_prim = 0;
  };

  void list_subtrees();
  float leaf_cost(const Scene& scene, std::int32_t n, const WideTreeSettings& settings);
  void distribute(const BvhTree::Node& node, Cut& cut) const;

  const BvhTree& tree_;
  std::vector<Cut> cut_;
  std::vector<std::int32_t> preorder_;
  std::vector<PrimRef> order_;
};

}  // namespace raymeter
