#include "accel/bvh/wide_cuts.h"

#include <algorithm>
#include <array>

namespace raymeter {

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
using Vertex = std::array<float, 3>;

Vertex vertex(const TrianglePool& pool, std::uint32_t triangle, std::size_t corner) {
  return {pool.vertex[corner][0][triangle], pool.vertex[corner][1][triangle], pool.vertex[corner][2][triangle]};
}

bool fits_leaf(const Scene& scene, std::span<const PrimRef> refs, std::size_t max_leaf_size) {
  const PrimKind kind = refs[0].kind();
  if (!std::all_of(refs.begin(), refs.end(), [&](PrimRef ref) { return ref.kind() == kind; })) return false;
  TriangleBlock block;
  return kind == PrimKind::triangle ? fill_block(scene.pools().triangles, refs, block) : refs.size() <= max_leaf_size;
}

/// Replaces single children, and splits leaves that fit no leaf of a wide tree.
class Preparation {
public:
  Preparation(const Scene& scene, BvhTree& tree, int max_leaf_size) : scene_(scene), tree_(tree), max_leaf_size_(static_cast<std::size_t>(max_leaf_size)) {
    for (std::size_t n = 0; n < tree_.nodes.size(); ++n) {  // grows behind n
      while (tree_.nodes[n].child_count == 1) tree_.nodes[n] = tree_.nodes[static_cast<std::size_t>(tree_.nodes[n].first)];
      if (tree_.nodes[n].child_count == 0) split_leaf(n);
    }
  }

private:
  void split_leaf(std::size_t n) {
    const BvhTree::Node leaf = tree_.nodes[n];
    const auto begin = tree_.order.begin() + leaf.first;
    const auto end = begin + leaf.prim_count;
    if (leaf.prim_count < 2 || fits_leaf(scene_, {begin, end}, max_leaf_size_)) return;
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
    add_children(n, part(begin, middle), part(middle, end));
  }
  void add_children(std::size_t n, const BvhTree::Node& left, const BvhTree::Node& right) {
    tree_.nodes[n].first = static_cast<std::int32_t>(tree_.nodes.size());
    tree_.nodes[n].child_count = 2;
    tree_.nodes[n].prim_count = 0;
    tree_.nodes.push_back(left);
    tree_.nodes.push_back(right);
  }

  const Scene& scene_;
  BvhTree& tree_;
  std::size_t max_leaf_size_;
};

}  // namespace

bool fill_block(const TrianglePool& pool, std::span<const PrimRef> refs, TriangleBlock& block) {
  if (refs.size() > TriangleBlock::kTriangles) return false;
  std::array<Vertex, TriangleBlock::kVertices> known;
  std::size_t vertices = 0;
  block = {};
  for (std::size_t t = 0; t < refs.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vertex v = vertex(pool, refs[t].index, k);
      const std::size_t at = static_cast<std::size_t>(std::find(known.begin(), known.begin() + static_cast<std::ptrdiff_t>(vertices), v) - known.begin());
      if (at == vertices) {
        if (vertices == known.size()) return false;
        known[vertices++] = v;
      }
      block.corner[k][t] = static_cast<std::uint8_t>(at);
    }
    block.prim[t] = pool.prim[refs[t].index];
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    for (std::size_t a = 0; a < 3; ++a) block.vertex[a][v] = known[v][a];
  }
  block.count = static_cast<std::int32_t>(refs.size());
  return true;
}

void prepare(const Scene& scene, BvhTree& tree, int max_leaf_size) { Preparation(scene, tree, max_leaf_size); }

WideCuts::WideCuts(const Scene& scene, const BvhTree& tree, const WideTreeSettings& settings) : tree_(tree), cut_(tree.nodes.size()) {
  list_subtrees();
  for (std::size_t i = preorder_.size(); i-- > 0;) {
    const std::int32_t n = preorder_[i];
    const BvhTree::Node& node = at(n);
    Cut& cut = cut_[static_cast<std::size_t>(n)];
    const float leaf = leaf_cost(scene, n, settings);
    if (node.child_count > 0) distribute(node, cut);
    const float inner = node.child_count > 0 ? node.box.half_area() + cut.cost[kWideChildren - 1] : kInf;
    cut.is_leaf = leaf <= inner;
    cut.cost[0] = cut.is_leaf ? leaf : inner;
    for (std::size_t roots = 1; roots < kWideChildren; ++roots) {
      if (node.child_count > 0 && cut.cost[roots] < cut.cost[roots - 1]) continue;
      cut.cost[roots] = cut.cost[roots - 1];
      cut.left_roots[roots] = cut.left_roots[roots - 1];  // 0: the subtree is one root
    }
  }
}

void WideCuts::list_subtrees() {
  preorder_.reserve(tree_.nodes.size());
  order_.reserve(tree_.order.size());
  std::vector<std::int32_t> open{0};
  while (!open.empty()) {
    const std::int32_t n = open.back();
    open.pop_back();
    preorder_.push_back(n);
    const BvhTree::Node& node = at(n);
    cut_[static_cast<std::size_t>(n)].first_prim = static_cast<std::int32_t>(order_.size());
    if (node.child_count == 0)
      order_.insert(order_.end(), tree_.order.begin() + node.first, tree_.order.begin() + node.first + node.prim_count);
    else
      open.insert(open.end(), {node.first + 1, node.first});
    cut_[static_cast<std::size_t>(n)].end_prim = static_cast<std::int32_t>(order_.size());
  }
  for (std::size_t i = preorder_.size(); i-- > 0;) {
    const BvhTree::Node& node = at(preorder_[i]);
    if (node.child_count > 0) cut_[static_cast<std::size_t>(preorder_[i])].end_prim = cut_[static_cast<std::size_t>(node.first + 1)].end_prim;
  }
}

float WideCuts::leaf_cost(const Scene& scene, std::int32_t n, const WideTreeSettings& settings) {
  const BvhTree::Node& node = at(n);
  Cut& cut = cut_[static_cast<std::size_t>(n)];
  const auto refs = prims(n);
  const bool children_fit =
      node.child_count == 0 || (cut_[static_cast<std::size_t>(node.first)].fits_leaf && cut_[static_cast<std::size_t>(node.first + 1)].fits_leaf);
  cut.fits_leaf = children_fit && fits_leaf(scene, refs, static_cast<std::size_t>(settings.max_leaf_size));
  if (!cut.fits_leaf) return kInf;
  const bool triangles = refs[0].kind() == PrimKind::triangle;
  return node.box.half_area() * (triangles ? settings.block_cost : 1 + settings.prim_cost * static_cast<float>(refs.size()));
}

void WideCuts::distribute(const BvhTree::Node& node, Cut& cut) const {
  const Cut& left = cut_[static_cast<std::size_t>(node.first)];
  const Cut& right = cut_[static_cast<std::size_t>(node.first + 1)];
  for (std::size_t roots = 2; roots <= kWideChildren; ++roots) {
    float best = kInf;
    for (std::size_t k = 1; k < roots; ++k) {
      const float cost = left.cost[k - 1] + right.cost[roots - k - 1];
      if (cost < best || k == 1) {
        best = cost;
        cut.left_roots[roots - 1] = static_cast<std::uint8_t>(k);
      }
    }
    cut.cost[roots - 1] = best;
  }
  cut.left_roots_below = cut.left_roots[kWideChildren - 1];
}

}  // namespace raymeter
