// PLOC: Meister & Bittner 2018, "Parallel locally-ordered clustering for bounding volume hierarchy construction" (TVCG 24(3)). Clusters, at first single
// primitives in Morton order, look for the neighbour within `ploc_radius` places with which they have the smallest common box; pairs that choose each other
// merge, the merged cluster takes the first one's place, and so on until one is left.
//
// Departure: where clusters nest, each prefers the next smaller one, and one pair a round would merge. A round in which fewer than a sixteenth would merge lets
// each cluster in turn take its choice where both are still free; that is at least one in 2 ploc_radius + 1.
//
// Ties are broken by a rule that both sides of a pair see alike: nearest in the order, then pairs that begin at an even place, then the first. So at least one
// pair merges in every round, and half of all clusters do where everything coincides. As in the paper subtrees become leaves where the surface area heuristic
// says so.

#include <algorithm>
#include <limits>
#include <tuple>

#include <tbb/parallel_for.h>

#include "accel/bvh/box_builders.h"
#include "accel/bvh/build_prims.h"
#include "accel/bvh/merge_leaves.h"
#include "accel/bvh/morton_order.h"
#include "core/base/threads.h"

namespace raymeter {

namespace {

using Cluster = BvhTree::Node;

/// Half area of the common box; finite, so that it can be compared.
float common_area(const Aabb& a, const Aabb& b) noexcept {
  Aabb box = a;
  box.grow(b);
  const float area = box.half_area();
  return area <= std::numeric_limits<float>::max() ? area : std::numeric_limits<float>::max();
}

/// The place of the best partner of the cluster at `i`; there are at least two clusters.
std::int32_t nearest(const std::vector<Cluster>& clusters, std::int32_t i, std::int32_t radius) {
  const auto count = static_cast<std::int32_t>(clusters.size());
  std::int32_t best = -1;
  std::tuple<float, std::int32_t, std::int32_t, std::int32_t> least;
  for (std::int32_t j = std::max(0, i - radius); j < std::min(count, i + radius + 1); ++j) {
    if (j == i) continue;
    const float area = common_area(clusters[static_cast<std::size_t>(i)].box, clusters[static_cast<std::size_t>(j)].box);
    if (best >= 0 && area > std::get<0>(least)) continue;
    const std::int32_t first = std::min(i, j);
    const std::tuple key{area, std::max(i, j) - first, first & 1, first};
    if (best >= 0 && key >= least) continue;
    least = key;
    best = j;
  }
  return best;
}

/// A cluster is a node that has no parent yet; once it is merged it goes into the tree, beside its sibling.
class Clustering {
public:
  Clustering(const std::vector<BuildPrim>& prims, const std::vector<MortonPrim>& order) {
    clusters_.reserve(order.size());
    tree_.order.reserve(order.size());
    for (const MortonPrim& at : order) {
      const BuildPrim& prim = prims[static_cast<std::size_t>(at.prim)];
      clusters_.push_back({prim.box, static_cast<std::int32_t>(tree_.order.size()), 0, 1});
      tree_.order.push_back(prim.ref);
    }
  }

  BvhTree build(std::int32_t radius) {
    if (clusters_.empty()) return {};
    tree_.nodes.reserve(2 * clusters_.size());
    tree_.nodes.push_back({});  // the root, which is known last
    std::vector<std::int32_t> partner(clusters_.size());
    while (clusters_.size() > 1) {
      tbb::parallel_for(std::size_t{0}, clusters_.size(), [&](std::size_t i) { partner[i] = nearest(clusters_, static_cast<std::int32_t>(i), radius); });
      keep_pairs(partner);
      merge_pairs(partner);
    }
    tree_.nodes[0] = clusters_[0];
    return std::move(tree_);
  }

private:
  /// Leaves `partner` with pairs alone, each other's partners; -1 for clusters that stay.
  void keep_pairs(std::vector<std::int32_t>& partner) const {
    const auto count = static_cast<std::int32_t>(clusters_.size());
    std::vector<std::int32_t> pair(clusters_.size(), -1);
    std::int32_t paired = 0;
    const auto take = [&](std::int32_t i, bool mutual) {
      const auto first = static_cast<std::size_t>(i), second = static_cast<std::size_t>(partner[first]);
      if (pair[first] >= 0 || pair[second] >= 0 || (mutual && partner[second] != i)) return;
      pair[first] = partner[first];
      pair[second] = i;
      paired += 2;
    };
    for (std::int32_t i = 0; i < count; ++i) take(i, true);
    if (paired < count / 16) {
      for (std::int32_t i = 0; i < count; ++i) take(i, false);
    }
    std::copy(pair.begin(), pair.end(), partner.begin());
  }

  void merge_pairs(const std::vector<std::int32_t>& partner) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < clusters_.size(); ++i) {
      if (partner[i] >= 0 && partner[i] < static_cast<std::int32_t>(i)) continue;
      Cluster cluster = clusters_[i];
      if (partner[i] >= 0) {
        const auto j = static_cast<std::size_t>(partner[i]);
        const auto first = static_cast<std::int32_t>(tree_.nodes.size());
        tree_.nodes.push_back(clusters_[i]);
        tree_.nodes.push_back(clusters_[j]);
        cluster = {clusters_[i].box, first, 2, 0};
        cluster.box.grow(clusters_[j].box);
      }
      clusters_[kept++] = cluster;
    }
    clusters_.resize(kept);
  }

  std::vector<Cluster> clusters_;
  BvhTree tree_;
};

}  // namespace

BvhTree build_ploc(const Scene& scene, const SahParams& sah, const PlocParams& params, int threads) {
  return on_threads(threads, [&] {
    const std::vector<BuildPrim> prims = build_prims(scene);
    return merge_leaves(Clustering(prims, build_morton_order(prims)).build(params.ploc_radius), sah);
  });
}

}  // namespace raymeter
