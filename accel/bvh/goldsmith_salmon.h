#pragma once

// The incremental construction of Goldsmith & Salmon 1987, "Automatic creation of object hierarchies for ray tracing" (IEEE CG&A 7(5)), in the form
//     Cost(n) = children(n) area(n) + sum of Cost(child),   Cost(leaf) = 0,
// which counts the tests of a random ray times the root's area. To add a primitive m at an inner node n costs area(n + m) (children + 1) - area(n) children; at
// a leaf, which becomes an inner node over both, 2 area(n + m). The search goes down from the root into the child where that is least, and m is added at the
// best node met. With `inherited`, as in the paper, a place also costs what the nodes above it grow by: children (area(n + m) - area(n)) each.
//
// Stored costs stay those of the tree: the root's own increment is a candidate like any other, a leaf's new parent counts its two children, and the bounds,
// areas and costs of all nodes above the new one follow at once.

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "accel/bvh/build_prims.h"
#include "accel/bvh/bvh_params.h"
#include "accel/bvh/bvh_tree.h"
#include "core/bounds/bounding_volume.h"

namespace raymeter {

/// What the volume in use does not matter for: who is whose child.
struct InsertionNode {
  static constexpr std::int32_t kNone = -1;
  std::int32_t parent = kNone;
  std::int32_t first_child = kNone;
  std::int32_t last_child = kNone;
  std::int32_t next = kNone;     ///< sibling
  std::int32_t child_count = 0;  ///< 0: a leaf
  std::int32_t inner_children = 0;
  std::int32_t prim = kNone;  ///< leaves: what insert() was given
};

/// A finished hierarchy; the root is the first node, children come after their parent.
struct InsertionTree {
  std::vector<InsertionNode> nodes;
  double cost = 0;  ///< of the root, in half areas of the volume in use
};

/// A hierarchy that grows by one primitive at a time. Areas are half areas of V, which changes no comparison.
template <BoundingVolume V>
class GoldsmithSalmon {
public:
  using Bound = typename V::Bound;
  static constexpr std::int32_t kNone = InsertionNode::kNone;

  struct Node : InsertionNode {
    Bound bound;
    double area = 0;
    double cost = 0;
  };

  GoldsmithSalmon(const V& volume, bool inherited) : volume_(volume), inherited_(inherited) {}

  void reserve(std::size_t prims) { nodes_.reserve(2 * prims); }

  void insert(const Bound& bound, std::int32_t prim) {
    const double area = volume_.half_area(bound);
    if (nodes_.empty()) {
      add_leaf(bound, area, prim, kNone);
      return;
    }
    const std::int32_t place = best_place(bound, area);
    std::size_t depth = depth_of_place_;
    double growth;
    if (at(place).child_count == 0) {
      growth = make_inner(place, bound, area, prim);
    } else {
      const double before = at(place).area * at(place).child_count;
      add_leaf(bound, area, prim, place);
      grow(place, bound, common_areas_[depth]);
      growth = at(place).area * at(place).child_count - before;
      at(place).cost += growth;
    }
    for (std::int32_t n = at(place).parent; n != kNone; n = at(n).parent) {
      const double before = at(n).area;
      grow(n, bound, common_areas_[--depth]);
      growth += (at(n).area - before) * at(n).child_count;
      at(n).cost += growth;
    }
  }

  /// All nodes; the root is the first.
  [[nodiscard]] const std::vector<Node>& nodes() const noexcept { return nodes_; }
  [[nodiscard]] double cost() const noexcept { return nodes_.empty() ? 0 : nodes_[0].cost; }

private:
  [[nodiscard]] Node& at(std::int32_t n) noexcept { return nodes_[static_cast<std::size_t>(n)]; }
  [[nodiscard]] const Node& at(std::int32_t n) const noexcept { return nodes_[static_cast<std::size_t>(n)]; }

  /// What adding a primitive at `node` costs where their common bound has this area.
  [[nodiscard]] static double increment(const Node& node, double common_area) noexcept {
    return node.child_count == 0 ? 2 * common_area : common_area * (node.child_count + 1) - node.area * node.child_count;
  }

  /// Of what holds the node's volume and another. Where that is the node's own, as often in overlapping nodes, it need not be measured again.
  [[nodiscard]] double area_with(const Node& node, const Bound& bound) const {
    const Bound both = volume_.merge(node.bound, bound);
    if constexpr (std::equality_comparable<Bound>) {
      if (both == node.bound) return node.area;
    }
    return volume_.half_area(both);
  }

  /// Also leaves, for the nodes on the way down to it, what their areas become: they are not worked out twice.
  [[nodiscard]] std::int32_t best_place(const Bound& bound, double area) {
    std::int32_t n = 0, best = 0;
    common_areas_.assign(1, area_with(at(0), bound));
    depth_of_place_ = 0;
    double best_cost = increment(at(0), common_areas_[0]), above = 0;
    while (at(n).child_count > 0) {
      if (inherited_) {
        above += (common_areas_.back() - at(n).area) * at(n).child_count;
        if (above >= best_cost) break;  // and so do all places below
      }
      const Choice child = best_child(n, bound, area);
      n = child.node;
      common_areas_.push_back(child.common_area);
      if (above + child.increment < best_cost) {
        best_cost = above + child.increment;
        best = n;
        depth_of_place_ = common_areas_.size() - 1;
      }
    }
    return best;
  }

  struct Choice {
    std::int32_t node = kNone;
    double increment = std::numeric_limits<double>::infinity();
    double common_area = 0;
  };

  /// The child of least increment, the first of several.
  [[nodiscard]] Choice best_child(std::int32_t parent, const Bound& bound, double area) const {
    // No leaf can cost less than this: with a hundred thousand coincident primitives under one node, the first is as good as any.
    const double least = at(parent).inner_children == 0 ? 2 * area : 0;
    Choice best;
    for (std::int32_t c = at(parent).first_child; c != kNone; c = at(c).next) {
      // What holds both has at least the area of either; most children are not worth a look at what they would become.
      if (increment(at(c), std::max(at(c).area, area)) >= best.increment) continue;
      const double common_area = area_with(at(c), bound);
      const double cost = increment(at(c), common_area);
      if (cost < best.increment || best.node == kNone) best = {c, cost, common_area};
      if (best.increment <= least) break;
    }
    return best;
  }

  void add_leaf(const Bound& bound, double area, std::int32_t prim, std::int32_t parent) {
    const auto leaf = static_cast<std::int32_t>(nodes_.size());
    nodes_.push_back({{.parent = parent, .prim = prim}, bound, area});
    if (parent == kNone) return;
    Node& above = at(parent);
    if (above.child_count++ == 0)
      above.first_child = leaf;
    else
      at(above.last_child).next = leaf;
    above.last_child = leaf;
  }

  /// A leaf becomes an inner node in its own place, over its primitive and the new one. Returns the cost that this adds.
  double make_inner(std::int32_t n, const Bound& bound, double area, std::int32_t prim) {
    const Node leaf = at(n);
    at(n).prim = kNone;
    add_leaf(leaf.bound, leaf.area, leaf.prim, n);
    add_leaf(bound, area, prim, n);
    grow(n, bound, common_areas_[depth_of_place_]);
    if (leaf.parent != kNone) ++at(leaf.parent).inner_children;
    return at(n).cost = 2 * at(n).area;
  }

  void grow(std::int32_t n, const Bound& bound, double common_area) {
    Node& node = at(n);
    node.bound = volume_.merge(node.bound, bound);
    node.area = common_area;
  }

  V volume_;
  bool inherited_;
  std::vector<Node> nodes_;
  // Of the latest search, from the root down.
  std::vector<double> common_areas_;
  std::size_t depth_of_place_ = 0;
};

/// Builds over primitives in the order of insertion that the parameters name. `insert_all(order)` makes the hierarchy of the scene's prims_that_can_be_hit(),
/// inserted in that order; it is called from several threads.
using InsertAll = std::function<InsertionTree(std::span<const std::int32_t> order)>;
[[nodiscard]] BvhTree build_by_insertion(const Scene& scene, const GoldsmithSalmonParams& params, int threads, const InsertAll& insert_all);

/// Goldsmith and Salmon's hierarchy by the areas of any volume: nodes of any number of children over single primitives. The tree has boxes all the same.
template <BoundingVolume V>
[[nodiscard]] BvhTree build_goldsmith_salmon(const Scene& scene, const V& volume, const GoldsmithSalmonParams& params, int threads) {
  std::vector<typename V::Bound> bounds;
  bounds.reserve(static_cast<std::size_t>(scene.prim_count()));
  for (const PrimRef ref : prims_that_can_be_hit(scene)) bounds.push_back(volume.fit(scene, ref));
  return build_by_insertion(scene, params, threads, [&](std::span<const std::int32_t> order) {
    GoldsmithSalmon<V> hierarchy(volume, params.inherited);
    hierarchy.reserve(order.size());
    for (const std::int32_t prim : order) hierarchy.insert(bounds[static_cast<std::size_t>(prim)], prim);
    return InsertionTree{{hierarchy.nodes().begin(), hierarchy.nodes().end()}, hierarchy.cost()};
  });
}

}  // namespace raymeter
