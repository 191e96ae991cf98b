#include "accel/bvh/wide_cuts.h"

#include <algorithm>

#include "core/base/threads.h"

namespace raymeter {

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr int kTopDepth = 10;
constexpr std::size_t kSmallTree = 4096;  ///< nodes: less have no top

}  // namespace

WideCuts::WideCuts(const Scene& scene, const BvhTree& tree, const WideTreeSettings& settings) : scene_(scene), tree_(tree), settings_(settings) {
  cut_.resize_for_overwrite(tree.nodes.size());
  std::vector<Part> parts = find_parts();
  for_each_task(parts.size(), [&](std::size_t p) { list_subtrees(parts[p]); });
  std::int32_t prims = 0;
  for (Part& part : parts) {
    part.first_prim = prims;
    prims += static_cast<std::int32_t>(part.order.size());
  }
  order_ = std::make_unique_for_overwrite<PrimRef[]>(static_cast<std::size_t>(prims));
  for_each_task(parts.size(), [&](std::size_t p) { cut_part(parts[p]); });
  auto next = parts.cbegin();
  cut_top(0, next);
}

/// Marks the top; returns the subtrees below it, from left to right.
std::vector<WideCuts::Part> WideCuts::find_parts() {
  struct Item {
    std::int32_t node;
    int depth;
  };
  std::vector<Part> parts;
  std::vector<Item> open{{0, tree_.nodes.size() < kSmallTree ? kTopDepth : 0}};
  while (!open.empty()) {
    const Item item = open.back();
    open.pop_back();
    const BvhTree::Node& node = at(item.node);
    if (node.child_count == 0 || item.depth == kTopDepth) {
      parts.push_back({item.node, {}, {}, 0, {}});
      continue;
    }
    cut(item.node) = {.is_top = true};
    open.insert(open.end(), {{node.first + 1, item.depth + 1}, {node.first, item.depth + 1}});
  }
  return parts;
}

void WideCuts::list_subtrees(Part& part) const {
  std::vector<std::int32_t> open{part.root};
  while (!open.empty()) {
    const std::int32_t n = open.back();
    open.pop_back();
    part.preorder.push_back(n);
    const BvhTree::Node& node = at(n);
    if (node.child_count == 0)
      part.order.insert(part.order.end(), tree_.order.begin() + node.first, tree_.order.begin() + node.first + node.prim_count);
    else
      open.insert(open.end(), {node.first + 1, node.first});
  }
}

void WideCuts::cut_part(Part& part) {
  std::ranges::copy(part.order, order_.get() + part.first_prim);
  std::int32_t end = part.first_prim + static_cast<std::int32_t>(part.order.size());
  std::vector<Subtree> closed;  // whose parents are still to come
  closed.reserve(2 * kBalanceDepth);
  for (std::size_t i = part.preorder.size(); i-- > 0;) {
    const std::int32_t n = part.preorder[i];
    if (at(n).child_count == 0) {
      cut(n) = {.first_prim = end - at(n).prim_count, .end_prim = end};
      end = cut(n).first_prim;
      cut_leaf(n, closed.emplace_back());
    } else {
      cut(n) = {};
      join(n, closed.back(), closed[closed.size() - 2]);
      closed.pop_back();
    }
  }
  part.whole = closed.back();
}

WideCuts::Subtree WideCuts::cut_top(std::int32_t n, std::vector<Part>::const_iterator& next) {
  if (!is_top(n)) return (next++)->whole;
  Subtree left = cut_top(at(n).first, next);
  Subtree right = cut_top(at(n).first + 1, next);
  join(n, left, right);
  return right;
}

void WideCuts::cut_leaf(std::int32_t n, Subtree& subtree) {
  std::ranges::fill(subtree.cost, kInf);
  subtree.kind = prims(n)[0].kind();
  set_cost(n, subtree);
}

/// Whether both together, the subtrees of node n's children, fit a leaf; then `right` has the vertices of both.
bool WideCuts::fits_leaf_with(Subtree& right, Subtree& left, std::int32_t n) const {
  const auto count = prims(n).size();
  if (!right.fits_leaf || !left.fits_leaf || left.kind != right.kind) return false;
  if (right.kind != PrimKind::triangle) return count <= static_cast<std::size_t>(settings_.max_leaf_size);
  if (count > TriangleBlock::kTriangles) return false;
  const TrianglePool& pool = scene_.pools().triangles;
  if (left.vertices.count() == 0) left.vertices = SharedVertices(pool, prims(at(n).first));
  if (right.vertices.count() == 0) right.vertices = SharedVertices(pool, prims(at(n).first + 1));
  return right.vertices.add(left.vertices);
}

/// Makes of its children's subtrees, in place of the right one, that of node n.
void WideCuts::join(std::int32_t n, Subtree& left, Subtree& right) {
  Cut& made = cut(n);
  made.first_prim = cut(at(n).first).first_prim;
  made.end_prim = cut(at(n).first + 1).end_prim;
  float cost[kWideChildren];
  std::size_t best_left = 0;
  for (std::size_t roots = 2; roots <= kWideChildren; ++roots) {
    float best = kInf;
    for (std::size_t k = 1; k < roots; ++k) {
      const float both = left.cost[k - 1] + right.cost[roots - k - 1];
      if (both < best || k == 1) {
        best = both;
        best_left = k;
      }
    }
    cost[roots - 1] = best;
    made.left_roots |= static_cast<std::uint32_t>(best_left) << 3 * (roots - 1);
  }
  made.left_roots_below = static_cast<std::uint8_t>(best_left);
  std::copy(cost + 1, cost + kWideChildren, right.cost + 1);
  right.fits_leaf = fits_leaf_with(right, left, n);
  set_cost(n, right);
}

/// Settles what becomes of node n, given its subtree with the cost of two and more roots.
void WideCuts::set_cost(std::int32_t n, Subtree& subtree) {
  Cut& made = cut(n);
  const float area = at(n).box.half_area();
  const float prim_cost = subtree.kind == PrimKind::sphere ? settings_.sphere_cost : settings_.prim_cost;
  const float of_prims = subtree.kind == PrimKind::triangle ? settings_.block_cost : 1 + prim_cost * static_cast<float>(made.end_prim - made.first_prim);
  const float as_leaf = subtree.fits_leaf ? area * of_prims : kInf;
  const float inner = area + subtree.cost[kWideChildren - 1];
  made.is_leaf = as_leaf <= inner;
  subtree.cost[0] = std::min(as_leaf, inner);
  for (std::size_t roots = 1; roots < kWideChildren; ++roots) {
    if (subtree.cost[roots] < subtree.cost[roots - 1]) continue;
    subtree.cost[roots] = subtree.cost[roots - 1];
    const std::uint32_t fewer = made.left_roots >> 3 * (roots - 1) & 7;
    made.left_roots = (made.left_roots & ~(7u << 3 * roots)) | fewer << 3 * roots;  // 0: the subtree is one root
  }
}

}  // namespace raymeter
