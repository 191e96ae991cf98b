#include "accel/bvh/wide_tree.h"

#include <algorithm>
#include <array>
#include <limits>

namespace raymeter {

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
using Vertex = std::array<float, 3>;

Vertex vertex(const TrianglePool& pool, std::uint32_t triangle, std::size_t corner) {
  return {pool.vertex[corner][0][triangle], pool.vertex[corner][1][triangle], pool.vertex[corner][2][triangle]};
}

/// Fills a block; false where the triangles do not fit.
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

/// Makes a tree binary, its leaves fit to be leaves of a wide one.
class Binary {
public:
  Binary(const Scene& scene, BvhTree& tree, int max_leaf_size) : scene_(scene), tree_(tree), max_leaf_size_(static_cast<std::size_t>(max_leaf_size)) {
    for (std::size_t n = 0; n < tree_.nodes.size(); ++n) {  // grows behind n
      if (tree_.nodes[n].child_count == 0) split_leaf(n);
      else if (tree_.nodes[n].child_count > 2) halve_children(n);
    }
  }
  [[nodiscard]] static bool fits(const Scene& scene, std::span<const PrimRef> refs, std::size_t max_leaf_size) {
    const PrimKind kind = refs[0].kind();
    if (!std::all_of(refs.begin(), refs.end(), [&](PrimRef ref) { return ref.kind() == kind; })) return false;
    TriangleBlock block;
    return kind == PrimKind::triangle ? fill_block(scene.pools().triangles, refs, block) : refs.size() <= max_leaf_size;
  }

private:
  void split_leaf(std::size_t n) {
    const BvhTree::Node leaf = tree_.nodes[n];
    const auto begin = tree_.order.begin() + leaf.first;
    const auto end = begin + leaf.prim_count;
    if (leaf.prim_count < 2 || fits(scene_, {begin, end}, max_leaf_size_)) return;
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
  void halve_children(std::size_t n) {
    const BvhTree::Node node = tree_.nodes[n];
    const auto part = [&](std::int32_t from, std::int32_t to) {
      if (to - from == 1) return tree_.nodes[static_cast<std::size_t>(from)];
      BvhTree::Node half;
      half.first = from;
      half.child_count = to - from;
      for (std::int32_t c = from; c < to; ++c) half.box.grow(tree_.nodes[static_cast<std::size_t>(c)].box);
      return half;
    };
    const std::int32_t middle = node.first + node.child_count / 2;
    add_children(n, part(node.first, middle), part(middle, node.first + node.child_count));
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

/// The cheapest cut of each subtree into at most 1 to 8 roots.
class Cuts {
public:
  Cuts(const Scene& scene, const BvhTree& tree, const WideTreeSettings& settings) : tree_(tree), cut_(tree.nodes.size()) {
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
    float cost[kWideChildren];
    std::uint8_t left_roots[kWideChildren]{};
    std::uint8_t left_roots_below = 0;
    bool is_leaf = false;
    bool fits_leaf = false;
    std::int32_t first_prim = 0, end_prim = 0;
  };

  void list_subtrees() {
    preorder_.reserve(tree_.nodes.size());
    order_.reserve(tree_.order.size());
    std::vector<std::int32_t> open{0};
    while (!open.empty()) {
      const std::int32_t n = open.back();
      open.pop_back();
      preorder_.push_back(n);
      const BvhTree::Node& node = at(n);
      cut_[static_cast<std::size_t>(n)].first_prim = static_cast<std::int32_t>(order_.size());
      if (node.child_count == 0) order_.insert(order_.end(), tree_.order.begin() + node.first, tree_.order.begin() + node.first + node.prim_count);
      else open.insert(open.end(), {node.first + 1, node.first});
      cut_[static_cast<std::size_t>(n)].end_prim = static_cast<std::int32_t>(order_.size());
    }
    for (std::size_t i = preorder_.size(); i-- > 0;) {
      const BvhTree::Node& node = at(preorder_[i]);
      if (node.child_count > 0) cut_[static_cast<std::size_t>(preorder_[i])].end_prim = cut_[static_cast<std::size_t>(node.first + 1)].end_prim;
    }
  }

  float leaf_cost(const Scene& scene, std::int32_t n, const WideTreeSettings& settings) {
    const BvhTree::Node& node = at(n);
    Cut& cut = cut_[static_cast<std::size_t>(n)];
    const auto refs = prims(n);
    const bool children_fit =
        node.child_count == 0 || (cut_[static_cast<std::size_t>(node.first)].fits_leaf && cut_[static_cast<std::size_t>(node.first + 1)].fits_leaf);
    cut.fits_leaf = children_fit && Binary::fits(scene, refs, static_cast<std::size_t>(settings.max_leaf_size));
    if (!cut.fits_leaf) return kInf;
    const bool triangles = refs[0].kind() == PrimKind::triangle;
    return node.box.half_area() * (triangles ? settings.block_cost : 1 + settings.prim_cost * static_cast<float>(refs.size()));
  }

  void distribute(const BvhTree::Node& node, Cut& cut) const {
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

  const BvhTree& tree_;
  std::vector<Cut> cut_;
  std::vector<std::int32_t> preorder_;
  std::vector<PrimRef> order_;
};

/// The children of one wide node, and the binary treelet above them, which knows what is in front of what.
struct Treelet {
  struct Split {
    std::array<int, 2> part;  ///< below 8: a child, else 8 + another split; the one of the smaller coordinate first
    int axis;
  };
  std::array<std::int32_t, kWideChildren> child;  ///< nodes of the binary tree
  std::array<Split, kWideChildren> split;
  int children = 0;
  int splits = 0;

  Treelet(const Cuts& cuts, std::int32_t n) {
    if (cuts.is_leaf(n)) child[static_cast<std::size_t>(children++)] = n;
    else open(cuts, n, cuts.left_roots_below(n), kWideChildren);
  }
  /// Places of the children, front to back.
  [[nodiscard]] std::uint32_t order(std::uint32_t octant) const {
    std::uint32_t places = 0;
    int next = 0;
    if (splits > 0) list(0, octant, places, next);
    for (int place = children; next < kWideChildren; ++place, ++next) places |= static_cast<std::uint32_t>(place % kWideChildren) << 4 * next;
    return places;
  }

private:
  int add(const Cuts& cuts, std::int32_t n, int roots) {
    const int left = cuts.left_roots(n, roots);
    if (left != 0) return kWideChildren + open(cuts, n, left, roots);
    child[static_cast<std::size_t>(children)] = n;
    return children++;
  }
  int open(const Cuts& cuts, std::int32_t n, int left_roots, int roots) {
    const int self = splits++;
    const std::int32_t first = cuts.at(n).first;
    const glm::vec3 apart = cuts.at(first + 1).box.center2() - cuts.at(first).box.center2();
    Split made{};
    for (int a = 1; a < 3; ++a) {
      if (std::abs(apart[a]) > std::abs(apart[made.axis])) made.axis = a;
    }
    const int left = add(cuts, first, left_roots);
    const int right = add(cuts, first + 1, roots - left_roots);
    made.part = apart[made.axis] >= 0 ? std::array{left, right} : std::array{right, left};
    split[static_cast<std::size_t>(self)] = made;
    return self;
  }
  void list(int at, std::uint32_t octant, std::uint32_t& places, int& next) const {
    const Split& here = split[static_cast<std::size_t>(at)];
    const std::size_t near = octant >> here.axis & 1;
    for (const std::size_t side : {near, 1 - near}) {
      const int part = here.part[side];
      if (part >= kWideChildren) list(part - kWideChildren, octant, places, next);
      else places |= static_cast<std::uint32_t>(part) << 4 * next++;
    }
  }
};

}  // namespace

WideTree collapse_wide(const Scene& scene, BvhTree tree, const WideTreeSettings& settings) {
  WideTree wide;
  WideNode blank{};
  for (auto& row : blank.plane) std::fill(std::begin(row), std::end(row), &row - blank.plane < 3 ? kInf : -kInf);
  for (std::uint32_t& order : blank.order) order = 0x76543210;
  wide.nodes.push_back(blank);
  wide.stats.max_depth = 0;
  wide.stats.sah_cost = 0;
  if (tree.nodes.empty()) return wide;
  const Binary binary(scene, tree, settings.max_leaf_size);
  const Cuts cuts(scene, tree, settings);

  std::array<std::int32_t, kPrimKindCount> next_of_kind{};
  const auto add_leaf = [&](std::span<const PrimRef> prims) {
    wide.stats.references += static_cast<std::int64_t>(prims.size());
    ++wide.stats.leaves;
    const PrimKind kind = prims[0].kind();
    if (kind == PrimKind::triangle) {
      wide.blocks.resize(wide.blocks.size() + 1);
      fill_block(scene.pools().triangles, prims, wide.blocks.back());
      return WideRef(WideRef::Tag::block, wide.blocks.size() - 1);
    }
    std::int32_t& next = next_of_kind[static_cast<std::size_t>(kind)];
    wide.runs.push_back(primitive_run(kind, next, static_cast<std::int32_t>(prims.size())));
    next += static_cast<std::int32_t>(prims.size());
    wide.order.insert(wide.order.end(), prims.begin(), prims.end());
    return WideRef(WideRef::Tag::run, wide.runs.size() - 1);
  };

  struct Item {
    std::int32_t source;
    std::size_t node;
    std::int32_t depth;
  };
  std::vector<Item> open{{0, 0, 0}};
  double area_sum = 0;
  while (!open.empty()) {
    const Item item = open.back();
    open.pop_back();
    const Treelet treelet(cuts, item.source);
    ++wide.stats.interior_nodes;
    wide.stats.max_depth = std::max<std::int64_t>(*wide.stats.max_depth, item.depth + 1);
    area_sum += double{cuts.at(item.source).box.half_area()};
    WideNode node = blank;
    for (std::uint32_t octant = 0; octant < 8; ++octant) node.order[octant] = treelet.order(octant);
    for (int c = 0; c < treelet.children; ++c) {
      const std::int32_t source = treelet.child[static_cast<std::size_t>(c)];
      const Aabb& box = cuts.at(source).box;
      for (int a = 0; a < 3; ++a) {
        node.plane[a][c] = box.min[a];
        node.plane[a + 3][c] = box.max[a];
      }
      if (cuts.is_leaf(source)) {
        const auto prims = cuts.prims(source);
        node.child[c] = add_leaf(prims);
        area_sum += double{box.half_area()} * static_cast<double>(prims.size());
        continue;
      }
      node.child[c] = WideRef(WideRef::Tag::inner, wide.nodes.size());
      open.push_back({source, wide.nodes.size(), item.depth + 1});
      wide.nodes.push_back(blank);
    }
    wide.nodes[item.node] = node;
  }
  // Opening a node puts up to eight entries in place of its own.
  wide.stack_capacity = static_cast<std::int32_t>(*wide.stats.max_depth) * (kWideChildren - 1) + kWideChildren;
  const double root_area = double{tree.nodes[0].box.half_area()};
  if (root_area > 0) wide.stats.sah_cost = area_sum / root_area;
  wide.nodes.shrink_to_fit();
  wide.blocks.shrink_to_fit();
  return wide;
}

}  // namespace raymeter
