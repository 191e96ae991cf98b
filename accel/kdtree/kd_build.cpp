// Top-down construction. A reference is the part of a primitive in a cell, with its own box: tight, since the traversal's margins are what hits may lie
// outside. Triangles that a plane cuts are clipped to both cells (Havran 2000: "split clipping", "perfect splits"), other kinds keep to their box.

#include <algorithm>
#include <cmath>
#include <utility>

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include "accel/kdtree/kd_topology.h"
#include "core/base/threads.h"

namespace raymeter {

namespace {

constexpr std::size_t kParallelReferences = 4096;  // smaller subtrees are built by one task
constexpr std::size_t kFreeReferences = 1 << 12;   // that any scene may have, whatever its budget

using References = std::vector<SplitReference>;

struct Cell {
  Aabb box;
  int depth;
  std::size_t budget;  ///< of references in the leaves below
};

class KdBuilder {
public:
  KdBuilder(const Scene& scene, const KdParams& params, const KdPlaneChoice& choose) : pools_(scene.pools()), params_(params), choose_(choose) {
    for (std::int32_t id = 0; id < scene.prim_id_count(); ++id) {
      if (!scene.prim(id).dropped()) references_.push_back({{}, scene.prim(id)});
    }
    tbb::parallel_for(std::size_t{0}, references_.size(), [&](std::size_t i) { references_[i].box = tight_bounds(pools_, references_[i].ref); });
    if (params_.max_depth == 0 && !references_.empty()) {
      params_.max_depth = static_cast<int>(std::lround(8 + 1.3 * std::log2(static_cast<double>(references_.size()))));
    }
  }

  KdTopology run() {
    KdTopology tree;
    for (const SplitReference& reference : references_) tree.cell.grow(reference.box);
    const double budget = params_.reference_budget * static_cast<double>(references_.size());
    const Cell root{tree.cell, 0, kFreeReferences + static_cast<std::size_t>(budget)};
    add(std::move(references_), root, tree);
    return tree;
  }

private:
  /// Appends the subtree of a cell.
  void add(References references, const Cell& cell, KdTopology& tree) const {
    const bool may_split = references.size() > static_cast<std::size_t>(params_.leaf_size) && cell.depth < params_.max_depth;
    const KdPlane plane = may_split ? choose_(references, cell.box, cell.depth) : KdPlane();
    if (plane.axis < 0) return add_leaf(references, tree);
    std::pair<References, References> sides = divide(references, plane);
    const std::size_t both = sides.first.size() + sides.second.size();
    if (both > cell.budget) return add_leaf(references, tree);
    const std::size_t count = std::exchange(references, References()).size();
    Cell low{cell.box, cell.depth + 1, 0}, high = low;
    low.box.max[plane.axis] = high.box.min[plane.axis] = plane.position;
    low.budget =
        both == 0 ? 0 : static_cast<std::size_t>(static_cast<double>(cell.budget) * static_cast<double>(sides.first.size()) / static_cast<double>(both));
    low.budget = std::clamp(low.budget, sides.first.size(), cell.budget - sides.second.size());
    high.budget = cell.budget - low.budget;

    const std::size_t node = tree.nodes.size();
    tree.nodes.push_back({plane.axis, plane.position, 0, 0});
    if (count < kParallelReferences) {
      add(std::move(sides.first), low, tree);
      tree.nodes[node].link = static_cast<std::int32_t>(tree.nodes.size());
      add(std::move(sides.second), high, tree);
      return;
    }
    KdTopology upper;
    tbb::parallel_invoke([&] { add(std::move(sides.first), low, tree); }, [&] { add(std::move(sides.second), high, upper); });
    tree.nodes[node].link = static_cast<std::int32_t>(tree.nodes.size());
    append(upper, tree);
  }

  static void add_leaf(const References& references, KdTopology& tree) {
    tree.nodes.push_back({-1, 0, static_cast<std::int32_t>(tree.references.size()), static_cast<std::int32_t>(references.size())});
    for (const SplitReference& reference : references) tree.references.push_back(reference.ref);
  }

  static void append(const KdTopology& from, KdTopology& to) {
    const auto nodes = static_cast<std::int32_t>(to.nodes.size()), references = static_cast<std::int32_t>(to.references.size());
    to.references.insert(to.references.end(), from.references.begin(), from.references.end());
    to.nodes.reserve(to.nodes.size() + from.nodes.size());
    for (KdTopology::Node node : from.nodes) {
      node.link += node.axis < 0 ? references : nodes;
      to.nodes.push_back(node);
    }
  }

  [[nodiscard]] std::pair<References, References> divide(const References& references, const KdPlane& plane) const {
    std::pair<References, References> sides;
    sides.first.reserve(references.size() / 2);
    sides.second.reserve(references.size() / 2);
    for (const SplitReference& reference : references) {
      const bool below = reference.box.min[plane.axis] < plane.position;
      const bool above = reference.box.max[plane.axis] > plane.position;
      if (below && above) {
        put_on_both(reference, plane, sides);
      } else {
        (below || (!above && plane.flat_below) ? sides.first : sides.second).push_back(reference);
      }
    }
    return sides;
  }

  void put_on_both(const SplitReference& reference, const KdPlane& plane, std::pair<References, References>& sides) const {
    Aabb low = reference.box, high = reference.box;
    low.max[plane.axis] = high.min[plane.axis] = plane.position;
    if (params_.clip && reference.ref.kind() == PrimKind::triangle) {
      low = clipped(pools_, reference.ref, low);
      high = clipped(pools_, reference.ref, high);
    }
    if (!low.empty()) sides.first.push_back({low, reference.ref});
    if (!high.empty()) sides.second.push_back({high, reference.ref});
  }

  const Pools& pools_;
  KdParams params_;
  const KdPlaneChoice& choose_;
  References references_;
};

}  // namespace

KdTopology build_kd_topology(const Scene& scene, const KdParams& params, const KdPlaneChoice& choose, int threads) {
  return on_threads(threads, [&] { return KdBuilder(scene, params, choose).run(); });
}

KdPlane median_kd_plane(const Aabb& cell, int depth) noexcept {
  for (int k = 0; k < 3; ++k) {
    const int axis = (depth + k) % 3;
    const float low = cell.min[axis], high = cell.max[axis];
    const auto middle = static_cast<float>(0.5 * (double{low} + double{high}));
    if (low < middle && middle < high) return {axis, middle, true};
  }
  return {};
}

}  // namespace raymeter
