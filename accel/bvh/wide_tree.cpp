#include "accel/bvh/wide_tree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>

#include "accel/bvh/prepare_wide.h"
#include "accel/bvh/treelet.h"
#include "core/base/threads.h"

namespace raymeter {

namespace {

WideNode blank_node() {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  WideNode blank{};
  for (int p = 0; p < 6; ++p) std::fill(std::begin(blank.plane[p]), std::end(blank.plane[p]), p < 3 ? kInf : -kInf);
  for (std::uint32_t& order : blank.order) order = 0x76543210;
  return blank;
}

/// Where the next of each goes.
struct Places {
  std::size_t nodes = 0, blocks = 0, runs = 0;
  std::array<std::int32_t, kPrimKindCount> prims{};  ///< in runs, by kind

  [[nodiscard]] std::size_t all_prims() const {
    std::size_t sum = 0;
    for (const std::int32_t count : prims) sum += static_cast<std::size_t>(count);
    return sum;
  }
  void advance(const Places& by) {
    nodes += by.nodes;
    blocks += by.blocks;
    runs += by.runs;
    for (std::size_t k = 0; k < kPrimKindCount; ++k) prims[k] += by.prims[k];
  }
};

/// A wide subtree: the top, without the branches below it, or one of these.
struct Branch {
  std::int32_t source;  ///< the node of the binary tree in whose place its root is
  std::int64_t depth;
  Places begin{};
  Places end{};
  std::int64_t references = 0, max_depth = 0;
  double area_sum = 0;
};

/// Writes a wide tree in two passes, its branches side by side: one that counts, so that each knows its places, and one that fills them.
class Writer {
public:
  Writer(const Scene& scene, const WideCuts& cuts, WideTree& wide) : scene_(scene), cuts_(cuts), wide_(wide) {}

  /// Returns the sum over nodes and leaves of half area times sah_node_cost().
  double run() {
    walk<false>(top_);
    for_each_task(branches_.size(), [&](std::size_t b) { walk<false>(branches_[b]); });
    Places next = top_.end;
    for (Branch& branch : branches_) {
      branch.begin = next;
      next.advance(branch.end);
    }
    wide_.nodes.resize_for_overwrite(next.nodes);
    wide_.blocks.resize_for_overwrite(next.blocks);
    wide_.runs.resize(next.runs);
    wide_.order.resize(next.all_prims());
    walk<true>(top_);
    for_each_task(branches_.size(), [&](std::size_t b) { walk<true>(branches_[b]); });
    wide_.stats.interior_nodes = static_cast<std::int64_t>(next.nodes);
    wide_.stats.leaves = static_cast<std::int64_t>(next.blocks + next.runs);
    add_sums(top_);
    for (const Branch& branch : branches_) add_sums(branch);
    return area_sum_;
  }

private:
  /// Passes through a branch, and through the top once before its branches are: then it lists them.
  template <bool kFill>
  void walk(Branch& branch) {
    struct Item {
      std::int32_t source;
      std::size_t node;
      std::int64_t depth;
    };
    Places next = branch.begin;
    std::size_t next_branch = 0;
    std::vector<Item> open{{branch.source, next.nodes++, branch.depth}};
    while (!open.empty()) {
      const Item item = open.back();
      open.pop_back();
      const Treelet treelet(cuts_, item.source);
      std::array<WideRef, kWideChildren> child{};
      for (std::size_t c = 0; c < treelet.children().size(); ++c) {
        const std::int32_t source = treelet.children()[c];
        if (cuts_.is_leaf(source)) {
          child[c] = place_leaf<kFill>(cuts_.prims(source), next);
        } else if (cuts_.is_top(item.source) && !cuts_.is_top(source)) {
          if constexpr (!kFill) branches_.push_back({source, item.depth + 1});
          child[c] = WideRef(WideRef::Tag::inner, branches_[next_branch++].begin.nodes);
        } else {
          open.push_back({source, next.nodes, item.depth + 1});
          child[c] = WideRef(WideRef::Tag::inner, next.nodes++);
        }
      }
      if constexpr (!kFill) continue;
      branch.max_depth = std::max(branch.max_depth, item.depth + 1);
      branch.area_sum += double{cuts_.at(item.source).box.half_area()} * 0.5 * static_cast<double>(treelet.children().size());  // as sah_node_cost
      fill_node(treelet, child, wide_.nodes[item.node], branch);
    }
    branch.end = next;
  }
  void fill_node(const Treelet& treelet, const std::array<WideRef, kWideChildren>& child, WideNode& node, Branch& branch) const {
    node = blank_;
    for (std::uint32_t octant = 0; octant < 8; ++octant) node.order[octant] = treelet.order(octant);
    for (std::size_t c = 0; c < treelet.children().size(); ++c) {
      const std::int32_t source = treelet.children()[c];
      const Aabb& box = cuts_.at(source).box;
      for (int a = 0; a < 3; ++a) {
        node.plane[a][c] = box.min[a];
        node.plane[a + 3][c] = box.max[a];
      }
      node.child[c] = child[c];
      if (!cuts_.is_leaf(source)) continue;
      const auto prims = cuts_.prims(source).size();
      branch.references += static_cast<std::int64_t>(prims);
      branch.area_sum += double{box.half_area()} * static_cast<double>(prims);
    }
  }
  template <bool kFill>
  WideRef place_leaf(std::span<const PrimRef> prims, Places& next) const {
    const PrimKind kind = prims[0].kind();
    if (kind == PrimKind::triangle) {
      if (kFill && !fill_block(scene_.pools().triangles, prims, wide_.blocks[next.blocks])) throw std::logic_error("a leaf that fits no block");
      return WideRef(WideRef::Tag::block, next.blocks++);
    }
    std::int32_t& of_kind = next.prims[static_cast<std::size_t>(kind)];
    if constexpr (kFill) {
      wide_.runs[next.runs] = primitive_run(kind, of_kind, static_cast<std::int32_t>(prims.size()));
      std::ranges::copy(prims, wide_.order.begin() + static_cast<std::ptrdiff_t>(next.all_prims()));
    }
    of_kind += static_cast<std::int32_t>(prims.size());
    return WideRef(WideRef::Tag::run, next.runs++);
  }
  void add_sums(const Branch& branch) {
    wide_.stats.references += branch.references;
    wide_.stats.max_depth = std::max(*wide_.stats.max_depth, branch.max_depth);
    area_sum_ += branch.area_sum;
  }

  const Scene& scene_;
  const WideCuts& cuts_;
  WideTree& wide_;
  const WideNode blank_ = blank_node();
  Branch top_{0, 0};
  std::vector<Branch> branches_;
  double area_sum_ = 0;
};

WideTree collapse(const Scene& scene, BvhTree tree, const WideTreeSettings& settings) {
  WideTree wide;
  wide.stats.max_depth = 0;
  wide.stats.sah_cost = 0;
  if (tree.nodes.empty()) {
    wide.nodes.push_back(blank_node());
    return wide;
  }
  prepare_wide(scene, tree, settings.max_leaf_size);
  const double area_sum = Writer(scene, WideCuts(scene, tree, settings), wide).run();
  // Opening a node puts up to eight entries in place of its own.
  wide.stack_capacity = static_cast<std::int32_t>(*wide.stats.max_depth) * (kWideChildren - 1) + kWideChildren;
  const double root_area = double{tree.nodes[0].box.half_area()};
  if (root_area > 0) wide.stats.sah_cost = area_sum / root_area;
  return wide;
}

}  // namespace

WideTree collapse_wide(const Scene& scene, BvhTree tree, const WideTreeSettings& settings, int threads) {
  return on_threads(threads, [&] { return collapse(scene, std::move(tree), settings); });
}

}  // namespace raymeter
