#include <algorithm>
#include <cmath>
#include <limits>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include "accel/octree/cell_overlap.h"
#include "accel/octree/cell_split.h"
#include "accel/octree/octree_flatten.h"
#include "accel/octree/octree_tree.h"
#include "accel/thin_box.h"
#include "core/base/threads.h"
#include "core/geometry/error_bounds.h"

namespace raymeter {

namespace {

using Range = tbb::blocked_range<std::size_t>;
constexpr std::size_t kGrain = 4096;

/// Lists are complete for rays that start up to this many extents of the scene from its centre.
constexpr double kReach = 8;
/// How far a hit may lie off its primitive's box and the ray's cell together, relative to its distance from the origin on each axis: 3 roundings of the
/// crossing, and 1 to spare. octree_walk_kernel.cpp has the proof.
constexpr double kBoxError = double{kPrimitiveError} + 4 * double{kUnitRoundoff};
/// The same for lists of what touches a cell itself: relative to the distance and the primitive's size, in any direction.
constexpr double kTouchError = double{kSurfaceError} + 4 * double{kUnitRoundoff};

/// A cell under construction.
struct BuildCell {
  Aabb box;
  double budget = 0;  ///< references that its leaves may hold together
  std::size_t first = 0, count = 0;
  std::int32_t node = -1;  ///< whose child it is
  int child = 0;
};

/// What becomes of a cell.
struct Division {
  glm::vec3 split{0.0f};
  std::array<std::uint32_t, 8> count{};
  std::size_t first_node = 0, first_cell = 0, first_ref = 0;
  bool divided = false;
};

class OctreeBuilder {
public:
  OctreeBuilder(const Scene& scene, const OctreeParams& params) : pools_(scene.pools()), params_(params), rule_(params) {
    for (std::size_t k = 0; k < kPrimKindCount; ++k) {
      const auto kind = static_cast<PrimKind>(k);
      for (std::size_t i = 0; i < pools_.size(kind); ++i) draft_.entries.push_back(prim_ref(kind, i));
    }
    tree_.exact = params.placement == "exact";
  }

  Octree run() {
    place();
    for (int depth = 0; !cells_.empty(); ++depth) {
      tree_.stats.max_depth = depth;
      divide_level(depth);
    }
    flatten(pools_, draft_, tree_);
    return std::move(tree_);
  }

private:
  /// The primitives' boxes, the root cell, and how far lists have to reach beyond their cells.
  void place() {
    const std::size_t count = draft_.entries.size();
    boxes_.resize(count);
    tbb::parallel_for(Range(0, count, kGrain), [&](const Range& range) {
      for (std::size_t e = range.begin(); e < range.end(); ++e) boxes_[e] = padded_bounds(pools_, draft_.entries[e]);
    });
    Aabb all;
    for (const Aabb& box : boxes_) all.grow(box);
    BuildCell root;
    for (std::size_t e = 0; e < count; ++e) {
      boxes_[e] = thickened(boxes_[e], draft_.entries[e].kind(), static_cast<float>(params_.thin_padding));
      root.box.grow(boxes_[e]);
    }
    pad_cones();
    const glm::dvec3 extent = count > 0 ? glm::dvec3(all.max) - glm::dvec3(all.min) : glm::dvec3(0.0);
    const double largest = std::max({extent.x, extent.y, extent.z});
    const double reach = std::sqrt(tree_.exact ? 3.0 : 1.0) * (kReach + 1) * largest;
    tree_.margin = tree_.exact ? kTouchError * (reach + std::sqrt(3.0) * largest) : kBoxError * reach;
    tree_.reach = static_cast<float>(kReach * largest);
    // Cells are not to be so small that their lists reach far beyond them, nor planes of infinity made.
    const bool finite = largest <= double{std::numeric_limits<float>::max()};
    least_ = finite ? std::max(params_.least_cell * tree_.margin, 0x1p-100) : std::numeric_limits<double>::infinity();
    for (glm::length_t a = 0; a < 3 && count > 0; ++a) {
      const auto i = static_cast<std::size_t>(a);
      tree_.box[i] = all.min[a];
      tree_.box[i + 3] = all.max[a];
      tree_.center[i] = static_cast<float>(0.5 * (double{all.min[a]} + double{all.max[a]}));
      const double growth = params_.root == "cube" ? (0.5 + params_.growth) * largest - 0.5 * extent[a] : params_.growth * extent[a];
      constexpr double kMost{std::numeric_limits<float>::max()};
      root.box.min[a] = static_cast<float>(std::max(double{root.box.min[a]} - growth, -kMost));
      root.box.max[a] = static_cast<float>(std::min(double{root.box.max[a]} + growth, kMost));
    }
    root.count = count;
    root.budget = static_cast<double>(params_.budget) * static_cast<double>(std::max<std::size_t>(count, 1024));
    cells_ = {root};
    refs_.resize(count);
    for (std::size_t e = 0; e < count; ++e) refs_[e] = static_cast<std::uint32_t>(e);
  }

  void pad_cones() {
    if (params_.cone_padding == 0) return;
    const glm::vec3 low(static_cast<float>(params_.cone_padding));
    const glm::vec3 high = params_.padding_sides == "both" ? low : glm::vec3(0.0F);
    for (std::size_t e = 0; e < boxes_.size(); ++e) {
      if (draft_.entries[e].kind() == PrimKind::cone) boxes_[e] = {boxes_[e].min - low, boxes_[e].max + high};
    }
  }

  /// Divides the cells of one level or makes leaves of them.
  void divide_level(int depth) {
    divisions_.assign(cells_.size(), Division());
    masks_.resize(refs_.size());
    if (depth < params_.max_depth) {
      tbb::parallel_for(Range(0, cells_.size(), 1), [&](const Range& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) divide(cells_[i], divisions_[i]);
      });
    }
    std::vector<BuildCell> next = number_children();
    std::vector<std::uint32_t> next_refs(next.empty() ? 0 : next.back().first + next.back().count);
    tbb::parallel_for(Range(0, cells_.size(), 16), [&](const Range& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        if (divisions_[i].divided) hand_down(cells_[i], divisions_[i], next_refs);
      }
    });
    cells_ = std::move(next);
    refs_ = std::move(next_refs);
  }

  void divide(const BuildCell& cell, Division& division) {
    if (cell.count <= static_cast<std::size_t>(params_.leaf_size)) return;
    division.split = split_point(rule_, {cell.box, least_, tree_.margin}, boxes_, std::span(refs_).subspan(cell.first, cell.count));
    if (!(std::min({division.split.x, division.split.y, division.split.z}) < std::numeric_limits<float>::infinity())) return;
    using Counts = std::array<std::uint32_t, 8>;
    const DividedCell children = divided(cell.box, division.split);
    division.count = tbb::parallel_reduce(
        Range(cell.first, cell.first + cell.count, kGrain), Counts{},
        [&](const Range& range, Counts counts) {
          for (std::size_t r = range.begin(); r < range.end(); ++r) {
            masks_[r] = listing(refs_[r], children);
            for (std::size_t c = 0; c < 8; ++c) counts[c] += masks_[r] >> c & 1u;
          }
          return counts;
        },
        [](Counts a, const Counts& b) {
          for (std::size_t c = 0; c < 8; ++c) a[c] += b[c];
          return a;
        });
    double total = 0;
    for (const std::uint32_t n : division.count) total += n;
    division.divided = total <= cell.budget;
  }

  [[nodiscard]] DividedCell divided(const Aabb& cell, const glm::vec3& split) const noexcept {
    DividedCell divided{cell, split, {}};
    for (int c = 0; c < 8 && tree_.exact; ++c) {
      const Aabb box = child_box(cell, split, c);
      const glm::dvec3 low(box.min), high(box.max);
      divided.child[static_cast<std::size_t>(c)] = {0.5 * (low + high), 0.5 * (high - low) + tree_.margin};
    }
    return divided;
  }
  /// The children that list entry e, a bit for each.
  [[nodiscard]] std::uint8_t listing(std::uint32_t e, const DividedCell& cell) const noexcept {
    constexpr std::uint8_t kAbove[3] = {0xAA, 0xCC, 0xF0};
    std::uint8_t mask = 0xFF;
    for (glm::length_t a = 0; a < 3; ++a) {
      const bool below = double{boxes_[e].min[a]} - tree_.margin <= double{cell.split[a]},
                 above = double{boxes_[e].max[a]} + tree_.margin >= double{cell.split[a]};
      const auto lower = static_cast<std::uint8_t>(~kAbove[a]), both = static_cast<std::uint8_t>(0xFF);
      mask &= static_cast<std::uint8_t>(above ? (below ? both : kAbove[a]) : lower);
    }
    if (!tree_.exact || (mask & (mask - 1)) == 0) return mask;
    return touched(pools_, draft_.entries[e], cell, mask);
  }

  [[nodiscard]] static Aabb child_box(Aabb box, const glm::vec3& split, int child) noexcept {
    for (glm::length_t a = 0; a < 3; ++a) {
      if ((child >> a & 1) != 0)
        box.min[a] = split[a];
      else
        box.max[a] = std::min(box.max[a], split[a]);
    }
    return box;
  }

  /// Numbers the nodes, the cells of the next level and the leaves' references; files the leaves.
  std::vector<BuildCell> number_children() {
    std::vector<BuildCell> next;
    std::size_t refs = 0;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const BuildCell& cell = cells_[i];
      Division& division = divisions_[i];
      if (!division.divided) {
        draft_.add_leaf(cell.node, cell.child, std::span(refs_).subspan(cell.first, cell.count));
        continue;
      }
      const std::int32_t node = draft_.add_node(cell.node, cell.child, division.split, cell.box);
      division.first_cell = next.size();
      division.first_ref = refs;
      double total = 0;
      for (const std::uint32_t n : division.count) total += n;
      for (int c = 0; c < 8; ++c) {
        const std::size_t count = division.count[static_cast<std::size_t>(c)];
        if (count == 0) continue;
        next.push_back({child_box(cell.box, division.split, c), cell.budget * static_cast<double>(count) / total, refs, count, node, c});
        refs += count;
      }
    }
    return next;
  }

  /// Copies a cell's references to its children, in their order.
  void hand_down(const BuildCell& cell, const Division& division, std::vector<std::uint32_t>& next_refs) const noexcept {
    std::array<std::size_t, 8> end{};
    std::size_t at = division.first_ref;
    for (std::size_t c = 0; c < 8; ++c) {
      end[c] = at;
      at += division.count[c];
    }
    for (std::size_t r = cell.first; r < cell.first + cell.count; ++r) {
      for (unsigned left = masks_[r]; left != 0; left &= left - 1) next_refs[end[static_cast<std::size_t>(__builtin_ctz(left))]++] = refs_[r];
    }
  }

  const Pools& pools_;
  const OctreeParams& params_;
  SplitRule rule_;
  double least_ = 0;
  Octree tree_;
  OctreeDraft draft_;
  std::vector<Aabb> boxes_;       ///< per entry, padded
  std::vector<BuildCell> cells_;  ///< of the level under construction
  std::vector<Division> divisions_;
  std::vector<std::uint32_t> refs_;  ///< their entries
  std::vector<std::uint8_t> masks_;  ///< and the children to which these go
};

}  // namespace

Octree build_octree_tree(const Scene& scene, const OctreeParams& params, int threads) {
  return on_threads(threads, [&] { return OctreeBuilder(scene, params).run(); });
}

}  // namespace raymeter
