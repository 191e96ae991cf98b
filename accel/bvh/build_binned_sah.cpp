// Binned SAH after Wald 2007, "On fast construction of SAH-based bounding volume hierarchies". Nodes are split in place over one array of boxes; large nodes
// are binned in parallel over fixed chunks, whose bins are merged in order, and subtrees are built in parallel; so the tree is the same on any number of
// threads.

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>
#include <limits>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include "accel/bvh/box_builders.h"
#include "core/base/threads.h"

namespace raymeter {

namespace {

constexpr int kMaxBins = 64;
constexpr std::int32_t kParallelPrims = 16384;  // smaller subtrees are built by one task
constexpr int kBalanceDepth = 64;               // deeper nodes are halved, so that no input makes a deep tree

/// Box of four-float rows, so that the compiler uses one register a row.
struct Box4 {
  float min[4];
  float max[4];
};
constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr Box4 kEmptyBox{{kInf, kInf, kInf, kInf}, {-kInf, -kInf, -kInf, -kInf}};

inline void grow(Box4& box, const Box4& other) noexcept {
  for (int a = 0; a < 4; ++a) {
    box.min[a] = box.min[a] < other.min[a] ? box.min[a] : other.min[a];
    box.max[a] = box.max[a] > other.max[a] ? box.max[a] : other.max[a];
  }
}

inline float half_area(const Box4& box) noexcept {
  const float x = box.max[0] - box.min[0], y = box.max[1] - box.min[1], z = box.max[2] - box.min[2];
  return x * y + y * z + z * x;
}

Aabb to_aabb(const Box4& box) noexcept { return {{box.min[0], box.min[1], box.min[2]}, {box.max[0], box.max[1], box.max[2]}}; }

/// A primitive's padded box, and in the fourth row element its place in the scene.
struct BuildPrim {
  Box4 box;
  [[nodiscard]] float center2(int axis) const noexcept { return box.min[axis] + box.max[axis]; }
  [[nodiscard]] std::int32_t prim() const noexcept { return std::bit_cast<std::int32_t>(box.max[3]); }
};

/// What is needed to split a node: the bounds of its primitives and of (twice) their centres.
struct NodeBounds {
  Box4 box = kEmptyBox;
  Box4 centers2 = kEmptyBox;
  void add(const BuildPrim& prim) noexcept {
    grow(box, prim.box);
    Box4 center;
    for (int a = 0; a < 4; ++a) center.min[a] = center.max[a] = prim.box.min[a] + prim.box.max[a];
    grow(centers2, center);
  }
  void add(const NodeBounds& other) noexcept {
    grow(box, other.box);
    grow(centers2, other.centers2);
  }
};

struct Bins {
  Box4 box[3][kMaxBins];
  std::int32_t count[3][kMaxBins];
  void clear(int bins) noexcept {
    for (int a = 0; a < 3; ++a) {
      std::fill_n(box[a], bins, kEmptyBox);
      std::fill_n(count[a], bins, 0);
    }
  }
  void add(const Bins& other, int bins) noexcept {
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < bins; ++b) {
        grow(box[a][b], other.box[a][b]);
        count[a][b] += other.count[a][b];
      }
    }
  }
};

/// Maps centres to bins; axes without extent map to bin 0 and are never split.
struct BinMapping {
  int bins;
  float offset[4];
  float scale[4];
  BinMapping(const Box4& centers2, int bin_count) noexcept : bins(bin_count) {
    for (int a = 0; a < 4; ++a) {
      const float extent = centers2.max[a] - centers2.min[a];
      const float factor = static_cast<float>(bins) * 0.99999f / extent;
      offset[a] = centers2.min[a];
      scale[a] = a < 3 && extent > 0 && factor < kInf ? factor : 0.0f;
    }
  }
  [[nodiscard]] int bin(const BuildPrim& prim, int axis) const noexcept {
    const auto b = static_cast<int>((prim.center2(axis) - offset[axis]) * scale[axis]);
    return b < bins ? b : bins - 1;
  }
};

struct Split {
  float cost = kInf;  // of the children, in half areas times primitives
  int axis = -1;
  int bin = 0;  // the first bin of the right child
};

class BinnedSah {
public:
  BinnedSah(const Scene& scene, const SahParams& params) : scene_(scene), params_(params), node_cost_(static_cast<float>(params.node_cost)) {}

  BvhTree build() {
    collect();
    BvhTree tree;
    if (prims_.empty()) return tree;
    nodes_.resize(2 * prims_.size());
    next_node_ = 1;
    split(0, 0, static_cast<std::int32_t>(prims_.size()), bounds_of(0, static_cast<std::int32_t>(prims_.size())), 0);
    nodes_.resize(static_cast<std::size_t>(next_node_));
    tree.nodes = std::move(nodes_);
    tree.order.resize(prims_.size());
    for (std::size_t i = 0; i < prims_.size(); ++i) tree.order[i] = scene_.prim(prims_[i].prim());
    return tree;
  }

private:
  void collect() {
    prims_.reserve(static_cast<std::size_t>(scene_.prim_count()));
    for (std::int32_t id = 0; id < scene_.prim_id_count(); ++id) {
      if (!scene_.prim(id).dropped()) prims_.push_back({{{0, 0, 0, 0}, {0, 0, 0, std::bit_cast<float>(id)}}});
    }
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, prims_.size(), 4096), [&](const tbb::blocked_range<std::size_t>& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        BuildPrim& prim = prims_[i];
        const Aabb box = padded_bounds(scene_.pools(), scene_.prim(prim.prim()));
        for (int a = 0; a < 3; ++a) {
          prim.box.min[a] = box.min[a];
          prim.box.max[a] = box.max[a];
        }
      }
    });
  }

  /// Calls body(part, first, last) for fixed parts of [first, last), in parallel, and returns the parts merged in order.
  template <class Part, class Body, class Merge>
  Part over_parts(std::int32_t first, std::int32_t last, const Part& zero, Body&& body, Merge&& merge) const {
    constexpr std::int32_t kPart = 8192;
    const std::int32_t parts = (last - first + kPart - 1) / kPart;
    if (last - first < kParallelPrims) {
      Part sum = zero;
      body(sum, first, last);
      return sum;
    }
    std::vector<Part> sums(static_cast<std::size_t>(parts), zero);
    tbb::parallel_for(0, parts,
                      [&](std::int32_t part) { body(sums[static_cast<std::size_t>(part)], first + part * kPart, std::min(last, first + (part + 1) * kPart)); });
    for (std::size_t part = 1; part < sums.size(); ++part) merge(sums[0], sums[part]);
    return sums[0];
  }

  NodeBounds bounds_of(std::int32_t first, std::int32_t last) const {
    return over_parts(
        first, last, NodeBounds{},
        [&](NodeBounds& sum, std::int32_t begin, std::int32_t end) {
          for (std::int32_t i = begin; i < end; ++i) sum.add(prims_[static_cast<std::size_t>(i)]);
        },
        [](NodeBounds& sum, const NodeBounds& part) { sum.add(part); });
  }

  Split best_split(std::int32_t first, std::int32_t last, const NodeBounds& bounds, const BinMapping& mapping) const {
    Bins zero;
    zero.clear(mapping.bins);
    const Bins bins = over_parts(
        first, last, zero,
        [&](Bins& sum, std::int32_t begin, std::int32_t end) {
          for (std::int32_t i = begin; i < end; ++i) {
            const BuildPrim& prim = prims_[static_cast<std::size_t>(i)];
            for (int a = 0; a < 3; ++a) {
              const int b = mapping.bin(prim, a);
              grow(sum.box[a][b], prim.box);
              ++sum.count[a][b];
            }
          }
        },
        [&](Bins& sum, const Bins& part) { sum.add(part, mapping.bins); });
    Split best;
    for (int a = 0; a < 3; ++a) {
      if (!(bounds.centers2.max[a] > bounds.centers2.min[a])) continue;
      float right_cost[kMaxBins];
      Box4 box = kEmptyBox;
      std::int32_t count = 0;
      for (int b = mapping.bins - 1; b > 0; --b) {
        grow(box, bins.box[a][b]);
        count += bins.count[a][b];
        right_cost[b] = count > 0 ? half_area(box) * static_cast<float>(count) : kInf;
      }
      box = kEmptyBox;
      count = 0;
      for (int b = 1; b < mapping.bins; ++b) {
        grow(box, bins.box[a][b - 1]);
        count += bins.count[a][b - 1];
        const float cost = count > 0 ? half_area(box) * static_cast<float>(count) + right_cost[b] : kInf;
        if (cost < best.cost) best = {cost, a, b};
      }
    }
    return best;
  }

  void split(std::int32_t node, std::int32_t first, std::int32_t last, const NodeBounds& bounds, int depth) {
    const std::int32_t count = last - first;
    nodes_[static_cast<std::size_t>(node)].box = to_aabb(bounds.box);
    const BinMapping mapping(bounds.centers2, std::min(params_.bins, std::max(4, static_cast<int>(std::min(count, kMaxBins)))));
    const Split best = count > 1 && depth < kBalanceDepth ? best_split(first, last, bounds, mapping) : Split{};
    const float area = half_area(bounds.box);
    const bool worth_it = node_cost_ * area + best.cost < static_cast<float>(count) * area;
    if (count == 1 || (count <= params_.max_leaf_size && !worth_it)) {
      make_leaf(node, first, last);
      return;
    }
    const std::int32_t middle = partition(first, last, best, mapping);
    const std::int32_t child = next_node_.fetch_add(2);
    nodes_[static_cast<std::size_t>(node)].first = child;
    nodes_[static_cast<std::size_t>(node)].child_count = 2;
    const auto left = [&] { split(child, first, middle, bounds_of(first, middle), depth + 1); };
    const auto right = [&] { split(child + 1, middle, last, bounds_of(middle, last), depth + 1); };
    if (count >= kParallelPrims) {
      tbb::parallel_invoke(left, right);
    } else {
      left();
      right();
    }
  }

  /// Returns where the right child begins. Without a split, or with one that leaves a side empty, the node is halved as it lies.
  std::int32_t partition(std::int32_t first, std::int32_t last, const Split& best, const BinMapping& mapping) {
    const std::int32_t half = first + (last - first) / 2;
    if (best.axis < 0) return half;
    const auto begin = prims_.begin();
    const auto middle = std::partition(begin + first, begin + last, [&](const BuildPrim& prim) { return mapping.bin(prim, best.axis) < best.bin; });
    const auto position = static_cast<std::int32_t>(middle - begin);
    return position > first && position < last ? position : half;
  }

  void make_leaf(std::int32_t node, std::int32_t first, std::int32_t last) {
    // By kind, then id: a leaf's runs, and the order of tests in it, follow from what it holds alone.
    std::sort(prims_.begin() + first, prims_.begin() + last, [&](const BuildPrim& p, const BuildPrim& q) {
      const std::uint32_t p_kind = scene_.prim(p.prim()).kind_bits, q_kind = scene_.prim(q.prim()).kind_bits;
      return p_kind != q_kind ? p_kind < q_kind : p.prim() < q.prim();
    });
    nodes_[static_cast<std::size_t>(node)].first = first;
    nodes_[static_cast<std::size_t>(node)].prim_count = last - first;
  }

  const Scene& scene_;
  SahParams params_;
  float node_cost_;
  std::vector<BuildPrim> prims_;
  std::vector<BvhTree::Node> nodes_;
  std::atomic<std::int32_t> next_node_{0};
};

}  // namespace

BvhTree build_binned_sah(const Scene& scene, const SahParams& params, int threads) {
  return on_threads(threads, [&] { return BinnedSah(scene, params).build(); });
}

}  // namespace raymeter
