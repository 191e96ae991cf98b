#include "accel/bvh/wide_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "accel/bvh/wide_cuts.h"

namespace raymeter {

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

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

  Treelet(const WideCuts& cuts, std::int32_t n) {
    if (cuts.is_leaf(n))
      child[static_cast<std::size_t>(children++)] = n;
    else
      open(cuts, n, cuts.left_roots_below(n), kWideChildren);
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
  int add(const WideCuts& cuts, std::int32_t n, int roots) {
    const int left = cuts.left_roots(n, roots);
    if (left != 0) return kWideChildren + open(cuts, n, left, roots);
    child[static_cast<std::size_t>(children)] = n;
    return children++;
  }
  int open(const WideCuts& cuts, std::int32_t n, int left_roots, int roots) {
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
      if (part >= kWideChildren)
        list(part - kWideChildren, octant, places, next);
      else
        places |= static_cast<std::uint32_t>(part) << 4 * next++;
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
  prepare(scene, tree, settings.max_leaf_size);
  const WideCuts cuts(scene, tree, settings);

  std::array<std::int32_t, kPrimKindCount> next_of_kind{};
  const auto add_leaf = [&](std::span<const PrimRef> prims) {
    wide.stats.references += static_cast<std::int64_t>(prims.size());
    ++wide.stats.leaves;
    const PrimKind kind = prims[0].kind();
    if (kind == PrimKind::triangle) {
      wide.blocks.resize(wide.blocks.size() + 1);
      if (!fill_block(scene.pools().triangles, prims, wide.blocks.back())) throw std::logic_error("a leaf that fits no block");
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
    area_sum += double{cuts.at(item.source).box.half_area()} * 0.5 * treelet.children;  // as sah_node_cost
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
