// SBVH: Stich, Friedrich & Dietrich 2009, "Spatial splits in bounding volume hierarchies" (HPG). Top-down; beside the best split of the references by their
// centres a node considers planes that cut references in two, where the children of the former overlap by more than `split_overlap` of the root's area. A
// reference that a plane meets goes to both sides, each with the box of its part, or to one side whole where that costs less ("reference unsplitting").
//
// Departures: splits by centres are binned as spatial ones are (the paper sweeps over all of them), and the extra references are bounded by a share of the
// primitives that each node hands down to its children in proportion to what they hold, so that the tree does not depend on the order in which nodes are split.

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include "accel/bvh/box_builders.h"
#include "accel/bvh/build_prims.h"
#include "core/base/threads.h"
#include "core/bounds/split_reference.h"

namespace raymeter {

namespace {

constexpr std::size_t kParallelReferences = 4096;  // smaller subtrees are built by one task
constexpr int kBalanceDepth = 64;                  // deeper nodes are halved, so that no input makes a deep tree
constexpr int kMaxBins = 64;
constexpr float kInf = std::numeric_limits<float>::infinity();

using References = std::vector<SplitReference>;

struct Bin {
  Aabb box;
  std::int32_t entering = 0;  ///< references that begin in it
  std::int32_t leaving = 0;   ///< that end in it
};
using Bins = std::array<Bin, kMaxBins>;

struct Split {
  float cost = kInf;  // of the children, in half areas times references
  int axis = -1;
  int bin = 0;  // the first of the right child
  Aabb left, right;
  std::int32_t left_count = 0, right_count = 0;
};

/// Bins of equal width over an interval of an axis.
struct BinMapping {
  int bins;
  float low;
  float width;
  BinMapping(float from, float to, int bin_count) noexcept : bins(bin_count), low(from), width((to - from) / static_cast<float>(bin_count)) {}
  [[nodiscard]] bool usable() const noexcept { return width > 0 && width < kInf && low + width > low; }
  [[nodiscard]] int bin(float x) const noexcept { return std::clamp(static_cast<int>((x - low) / width), 0, bins - 1); }
  /// Where bin b begins.
  [[nodiscard]] float border(int b) const noexcept { return low + width * static_cast<float>(b); }
};

/// The cheapest border between bins.
void weigh(const Bins& bins, int bin_count, int axis, Split& best) {
  std::array<Split, kMaxBins> right;
  Aabb box;
  std::int32_t count = 0;
  for (int b = bin_count - 1; b > 0; --b) {
    const Bin& bin = bins[static_cast<std::size_t>(b)];
    box.grow(bin.box);
    count += bin.leaving;
    right[static_cast<std::size_t>(b)].right = box;
    right[static_cast<std::size_t>(b)].right_count = count;
  }
  box = Aabb();
  count = 0;
  for (int b = 1; b < bin_count; ++b) {
    const Bin& bin = bins[static_cast<std::size_t>(b - 1)];
    box.grow(bin.box);
    count += bin.entering;
    Split split = right[static_cast<std::size_t>(b)];
    if (count == 0 || split.right_count == 0) continue;
    split.cost = box.half_area() * static_cast<float>(count) + split.right.half_area() * static_cast<float>(split.right_count);
    if (!(split.cost < best.cost)) continue;
    split.axis = axis;
    split.bin = b;
    split.left = box;
    split.left_count = count;
    best = split;
  }
}

class Sbvh {
public:
  Sbvh(const Scene& scene, const SahParams& sah, const SbvhParams& params) : pools_(scene.pools()), sah_(sah), params_(params) {
    const std::vector<PrimRef> refs = prims_that_can_be_hit(scene);
    references_.resize(refs.size());
    tbb::parallel_for(std::size_t{0}, refs.size(), [&](std::size_t i) { references_[i] = {tight_bounds(pools_, refs[i]), refs[i]}; });
  }

  BvhTree build() {
    if (references_.empty()) return {};
    const auto budget = static_cast<std::size_t>(params_.split_budget * static_cast<double>(references_.size()));
    tree_.order.resize(references_.size() + budget);
    tree_.nodes.resize(2 * tree_.order.size());
    root_area_ = bounds(references_).half_area();
    next_node_ = 1;
    split(0, std::move(references_), budget, 0);
    return depth_first(tree_);
  }

private:
  /// More bins than references tell nothing more.
  [[nodiscard]] int bin_count(const References& references) const noexcept {
    return std::min(sah_.bins, std::max(4, static_cast<int>(std::min<std::size_t>(references.size(), kMaxBins))));
  }

  [[nodiscard]] static Aabb bounds(const References& references) {
    Aabb box;
    for (const SplitReference& reference : references) box.grow(reference.box);
    return box;
  }

  /// Splits of references by their centres.
  [[nodiscard]] Split best_object_split(const References& references, const Aabb& centers2) const {
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      const BinMapping mapping(centers2.min[axis], centers2.max[axis], bin_count(references));
      if (!mapping.usable()) continue;
      Bins bins{};
      for (const SplitReference& reference : references) {
        Bin& bin = bins[static_cast<std::size_t>(mapping.bin(reference.box.center2()[axis]))];
        bin.box.grow(reference.box);
        ++bin.entering;
        ++bin.leaving;
      }
      weigh(bins, mapping.bins, axis, best);
    }
    return best;
  }

  /// Splits by planes: a reference counts, with its part's box, in every bin that it reaches into.
  [[nodiscard]] Split best_spatial_split(const References& references, const Aabb& box) const {
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      const BinMapping mapping(box.min[axis], box.max[axis], bin_count(references));
      if (!mapping.usable()) continue;
      Bins bins{};
      for (const SplitReference& reference : references) {
        const int last = mapping.bin(reference.box.max[axis]);
        int b = mapping.bin(reference.box.min[axis]);
        ++bins[static_cast<std::size_t>(b)].entering;
        SplitReference rest = reference;
        for (; b < last; ++b) {
          const CutReference sides = cut(pools_, rest, axis, mapping.border(b + 1));
          bins[static_cast<std::size_t>(b)].box.grow(sides.left);
          rest.box = sides.right;
        }
        bins[static_cast<std::size_t>(last)].box.grow(rest.box);
        ++bins[static_cast<std::size_t>(last)].leaving;
      }
      weigh(bins, mapping.bins, axis, best);
    }
    return best;
  }

  struct Sides {
    References left, right;
  };

  [[nodiscard]] Sides split_by_centers(const References& references, const Split& split, const Aabb& centers2) const {
    const BinMapping mapping(centers2.min[split.axis], centers2.max[split.axis], bin_count(references));
    Sides sides;
    for (const SplitReference& reference : references) {
      (mapping.bin(reference.box.center2()[split.axis]) < split.bin ? sides.left : sides.right).push_back(reference);
    }
    return sides;
  }

  [[nodiscard]] Sides split_by_plane(const References& references, Split split, const Aabb& box) const {
    const BinMapping mapping(box.min[split.axis], box.max[split.axis], bin_count(references));
    Sides sides;
    for (const SplitReference& reference : references) {
      const bool in_left = mapping.bin(reference.box.min[split.axis]) < split.bin, in_right = mapping.bin(reference.box.max[split.axis]) >= split.bin;
      if (in_left && in_right) {
        put_to_cheapest(reference, cut(pools_, reference, split.axis, mapping.border(split.bin)), split, sides);
      } else {
        (in_left ? sides.left : sides.right).push_back(reference);
      }
    }
    return sides;
  }

  /// On both sides, or whole on one, whichever keeps the children cheapest; `split` follows.
  static void put_to_cheapest(const SplitReference& reference, const CutReference& cut, Split& split, Sides& sides) {
    const auto cost = [](const Aabb& left, std::int32_t left_count, const Aabb& right, std::int32_t right_count) {
      return left.half_area() * static_cast<float>(left_count) + right.half_area() * static_cast<float>(right_count);
    };
    Aabb left = split.left, right = split.right;
    left.grow(reference.box);
    right.grow(reference.box);
    const float both = cost(split.left, split.left_count, split.right, split.right_count);
    const float in_left = cut.right.empty() ? -kInf : cost(left, split.left_count, split.right, split.right_count - 1);
    const float in_right = cut.left.empty() ? -kInf : cost(split.left, split.left_count - 1, right, split.right_count);
    if (in_left < both && in_left <= in_right) {
      sides.left.push_back(reference);
      split.left = left;
      --split.right_count;
    } else if (in_right < both) {
      sides.right.push_back(reference);
      split.right = right;
      --split.left_count;
    } else {
      sides.left.push_back({cut.left, reference.ref});
      sides.right.push_back({cut.right, reference.ref});
    }
  }

  /// The children's references; halves where no split is found.
  [[nodiscard]] Sides best_sides(const References& references, const Aabb& box, std::size_t budget, int depth, bool may_be_leaf) const {
    Aabb centers2;
    for (const SplitReference& reference : references) centers2.grow(reference.box.center2());
    const bool balance = depth >= kBalanceDepth;
    const Split object = balance ? Split() : best_object_split(references, centers2);
    Split spatial;
    if (!balance && budget > 0 && overlap(object) > params_.split_overlap * double{root_area_}) spatial = best_spatial_split(references, box);
    const float area = box.half_area(), node_cost = static_cast<float>(sah_.node_cost);
    if (may_be_leaf && !(node_cost * area + std::min(object.cost, spatial.cost) < area * static_cast<float>(references.size()))) return {};
    if (spatial.cost < object.cost) {
      Sides sides = split_by_plane(references, spatial, box);
      // Where a child has no fewer references than the node, the split has used up some of the budget: that cannot go on for ever.
      const bool both = !sides.left.empty() && !sides.right.empty();
      if (both && sides.left.size() + sides.right.size() <= references.size() + budget) return sides;
    }
    if (object.axis >= 0) return split_by_centers(references, object, centers2);
    const auto middle = references.begin() + static_cast<std::ptrdiff_t>(references.size() / 2);
    return {{references.begin(), middle}, {middle, references.end()}};
  }

  /// Of the children's boxes; all there is where there is no split by centres.
  [[nodiscard]] static double overlap(const Split& object) noexcept {
    if (object.axis < 0) return std::numeric_limits<double>::infinity();
    const Aabb common{glm::max(object.left.min, object.right.min), glm::min(object.left.max, object.right.max)};
    return glm::all(glm::lessThanEqual(common.min, common.max)) ? double{common.half_area()} : 0.0;
  }

  void split(std::int32_t node, References references, std::size_t budget, int depth) {
    const std::size_t count = references.size();
    const bool may_be_leaf = count <= static_cast<std::size_t>(sah_.max_leaf_size);
    Sides sides;
    if (count > 1) sides = best_sides(references, bounds(references), budget, depth, may_be_leaf);
    if (sides.left.empty()) {
      make_leaf(node, references);
      return;
    }
    references = References();
    const std::size_t both = sides.left.size() + sides.right.size(), rest = budget - (both - count);
    const std::size_t left_budget = rest * sides.left.size() / both;
    const std::int32_t child = next_node_.fetch_add(2);
    tree_.node(node).first = child;
    tree_.node(node).child_count = 2;
    const auto left = [&] { split(child, std::move(sides.left), left_budget, depth + 1); };
    const auto right = [&] { split(child + 1, std::move(sides.right), rest - left_budget, depth + 1); };
    if (count >= kParallelReferences) {
      tbb::parallel_invoke(left, right);
    } else {
      left();
      right();
    }
    tree_.node(node).box = tree_.node(child).box;
    tree_.node(node).box.grow(tree_.node(child + 1).box);
  }

  void make_leaf(std::int32_t node, const References& references) {
    const auto count = static_cast<std::int32_t>(references.size());
    BvhTree::Node leaf{{}, next_reference_.fetch_add(count), 0, count};
    for (std::size_t i = 0; i < references.size(); ++i) {
      tree_.order[static_cast<std::size_t>(leaf.first) + i] = references[i].ref;
      leaf.box.grow(padded_part(pools_, references[i]));
    }
    tree_.node(node) = leaf;
  }

  const Pools& pools_;
  SahParams sah_;
  SbvhParams params_;
  References references_;
  float root_area_ = 0;
  BvhTree tree_;
  std::atomic<std::int32_t> next_node_{0};
  std::atomic<std::int32_t> next_reference_{0};
};

}  // namespace

BvhTree build_sbvh(const Scene& scene, const SahParams& sah, const SbvhParams& params, int threads) {
  return on_threads(threads, [&] { return Sbvh(scene, sah, params).build(); });
}

}  // namespace raymeter
