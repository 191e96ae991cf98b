#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "accel/bvh/triangle_block.h"
#include "accel/bvh/wide_tree.h"

namespace raymeter {

/// The cheapest cut of each subtree of a binary tree that prepare_wide() went through into at most 1 to 8 roots: leaves and nodes of a wide tree. `tree` must
/// outlive it.
///
/// The nodes of a large tree down to a fixed depth are its top; the subtrees below it are worked on in parallel.
class WideCuts {
public:
  WideCuts(const Scene& scene, const BvhTree& tree, const WideTreeSettings& settings);

  [[nodiscard]] const BvhTree::Node& at(std::int32_t n) const { return tree_.node(n); }
  [[nodiscard]] bool is_leaf(std::int32_t n) const { return cut(n).is_leaf; }
  [[nodiscard]] bool is_top(std::int32_t n) const { return cut(n).is_top; }
  /// Roots that the left child's part has of `roots`, where the subtree of n may be cut into that many; 0: it stays one.
  [[nodiscard]] int left_roots(std::int32_t n, int roots) const { return static_cast<int>(cut(n).left_roots >> 3 * (roots - 1) & 7); }
  /// The same for the children of a node that is opened whatever it costs.
  [[nodiscard]] int left_roots_below(std::int32_t n) const { return cut(n).left_roots_below; }
  [[nodiscard]] std::span<const PrimRef> prims(std::int32_t n) const { return {order_.get() + cut(n).first_prim, order_.get() + cut(n).end_prim}; }

private:
  struct Cut {
    std::uint32_t left_roots = 0;  ///< three bits each
    std::uint8_t left_roots_below = 0;
    bool is_leaf = false;
    bool is_top = false;
    std::int32_t first_prim = 0, end_prim = 0;
  };
  /// What a parent asks of a subtree.
  struct Subtree {
    float cost[kWideChildren];  ///< of at most 1, 2, ... roots
    bool fits_leaf = true;
    PrimKind kind{};
    SharedVertices vertices;  ///< where it fits a leaf of triangles; none as long as nobody asked for those of a leaf
  };
  /// A subtree below the top.
  struct Part {
    std::int32_t root;
    std::vector<std::int32_t> preorder;
    std::vector<PrimRef> order;
    std::int32_t first_prim = 0;
    Subtree whole;
  };

  [[nodiscard]] Cut& cut(std::int32_t n) { return cut_[static_cast<std::size_t>(n)]; }
  [[nodiscard]] const Cut& cut(std::int32_t n) const { return cut_[static_cast<std::size_t>(n)]; }
  std::vector<Part> find_parts();
  void list_subtrees(Part& part) const;
  void cut_part(Part& part);
  Subtree cut_top(std::int32_t n, std::vector<Part>::const_iterator& next);
  void cut_leaf(std::int32_t n, Subtree& subtree);
  void join(std::int32_t n, Subtree& left, Subtree& right);
  [[nodiscard]] bool fits_leaf_with(Subtree& right, Subtree& left, std::int32_t n) const;
  void set_cost(std::int32_t n, Subtree& subtree);

  const Scene& scene_;
  const BvhTree& tree_;
  const WideTreeSettings& settings_;
  Column<Cut> cut_;
  std::unique_ptr<PrimRef[]> order_;
};

}  // namespace raymeter
