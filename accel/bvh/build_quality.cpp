// EPO, end-point overlap: Aila, Karras & Laine 2013, "On quality metrics of bounding volume hierarchies" (HPG): the sum over all nodes of their cost
// (sah_node_cost) times the share of the scene's surface that lies in the node's box without belonging to its subtree. It predicts what
// rays that end on surfaces pay for overlap. Triangles and polygons are clipped to the boxes: that part is exact. Curved surfaces, and triangles where there
// are very many, are sampled: points uniform in area, and the standard error of their mean.

#include <algorithm>
#include <cmath>
#include <numeric>

#include <tbb/parallel_for.h>

#include "accel/bvh/surface_measure.h"
#include "accel/bvh/tree_quality.h"
#include "core/base/random.h"
#include "core/base/threads.h"

namespace raymeter {

namespace {

constexpr std::size_t kSamples = 20000;         // points on surfaces; a standard error of 1 % where EPO scatters as much as it is large
constexpr std::ptrdiff_t kMostClipped = 20000;  // triangles

glm::dvec3 center(const Aabb& box) noexcept { return 0.5 * (glm::dvec3(box.min) + glm::dvec3(box.max)); }

bool meet(const Aabb& a, const Aabb& b) noexcept { return glm::all(glm::lessThanEqual(a.min, b.max)) && glm::all(glm::lessThanEqual(b.min, a.max)); }

bool inside(const glm::dvec3& point, const Aabb& box) noexcept {
  return glm::all(glm::lessThanEqual(glm::dvec3(box.min), point)) && glm::all(glm::lessThanEqual(point, glm::dvec3(box.max)));
}

/// Which primitives a node's subtree holds.
class Holders {
public:
  explicit Holders(const BvhTree& tree) : first_(tree.nodes.size()), last_(tree.nodes.size()), places_(tree.order.size()) {
    for (auto n = static_cast<std::int32_t>(tree.nodes.size()); n-- > 0;) {  // depth first: a subtree's leaves lie together in the order
      const BvhTree::Node& node = tree.node(n);
      const auto i = static_cast<std::size_t>(n);
      first_[i] = node.child_count > 0 ? first_[static_cast<std::size_t>(node.first)] : node.first;
      last_[i] = node.child_count > 0 ? last_[static_cast<std::size_t>(node.first + node.child_count - 1)] : node.first + node.prim_count;
    }
    for (std::size_t i = 0; i < places_.size(); ++i) places_[i] = {key(tree.order[i]), static_cast<std::int32_t>(i)};
    std::sort(places_.begin(), places_.end());
  }
  [[nodiscard]] bool holds(std::int32_t node, PrimRef ref) const {
    const auto at = std::lower_bound(places_.begin(), places_.end(), std::pair(key(ref), first_[static_cast<std::size_t>(node)]));
    return at != places_.end() && at->first == key(ref) && at->second < last_[static_cast<std::size_t>(node)];
  }

private:
  static std::uint32_t key(PrimRef ref) noexcept { return static_cast<std::uint32_t>(ref.kind_bits) << 29 | ref.index; }
  std::vector<std::int32_t> first_, last_;                      ///< of a node's places in the order
  std::vector<std::pair<std::uint32_t, std::int32_t>> places_;  ///< of each primitive, sorted
};

class EndPointOverlap {
public:
  EndPointOverlap(const Scene& scene, const BvhTree& tree) : pools_(scene.pools()), tree_(tree), holders_(tree), prims_(tree.order) {
    std::sort(prims_.begin(), prims_.end(), [](PrimRef p, PrimRef q) { return p.kind_bits != q.kind_bits ? p.kind_bits < q.kind_bits : p.index < q.index; });
    prims_.erase(std::unique(prims_.begin(), prims_.end()), prims_.end());
  }

  void measure(BuildStats& stats) const {
    const auto is = [](PrimKind kind) { return [kind](PrimRef ref) { return ref.kind() == kind; }; };
    const bool clip_triangles = std::count_if(prims_.begin(), prims_.end(), is(PrimKind::triangle)) <= kMostClipped;
    std::vector<PrimRef> clipped, sampled;
    for (const PrimRef ref : prims_) {
      const bool clips = ref.kind() == PrimKind::polygon || (ref.kind() == PrimKind::triangle && clip_triangles);
      (clips ? clipped : sampled).push_back(ref);
    }
    double area = 0;
    for (const PrimRef ref : clipped) area += surface_area(pools_, ref);
    const Sum sum = sample(sampled);
    const double total = area + sum.area;
    if (!(total > 0) || !std::isfinite(total)) return;
    stats.epo = (clip(clipped) + sum.area * sum.mean) / total;
    stats.epo_se = sum.area * sum.error / total;
  }

private:
  struct Sum {
    double area = 0;
    double mean = 0;   ///< cost of the nodes that a point lies in without belonging to them
    double error = 0;  ///< standard error of the mean
  };

  /// Calls visit(node) for the nodes whose parents it returned true for.
  template <class Visit>
  void descend(Visit&& visit) const {
    std::vector<std::int32_t> open{0};
    while (!open.empty()) {
      const std::int32_t n = open.back();
      open.pop_back();
      if (!visit(n)) continue;
      for (std::int32_t c = 0; c < tree_.node(n).child_count; ++c) open.push_back(tree_.node(n).first + c);
    }
  }

  /// Cost times area over planar primitives.
  [[nodiscard]] double clip(const std::vector<PrimRef>& refs) const {
    std::vector<double> sums(refs.size());
    tbb::parallel_for(std::size_t{0}, refs.size(), [&](std::size_t i) {
      const Aabb box = tight_bounds(pools_, refs[i]);
      const std::vector<glm::dvec3> vertices = outline(pools_, refs[i]);
      descend([&](std::int32_t n) {
        if (!meet(tree_.node(n).box, box)) return false;
        if (!holders_.holds(n, refs[i])) sums[i] += sah_node_cost(tree_.node(n)) * area_in_box(vertices, tree_.node(n).box);
        return true;
      });
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0);
  }

  [[nodiscard]] Sum sample(const std::vector<PrimRef>& refs) const {
    std::vector<double> area_up_to(refs.size());
    double area = 0;
    for (std::size_t i = 0; i < refs.size(); ++i) area_up_to[i] = area += surface_area(pools_, refs[i]);
    if (!(area > 0) || !std::isfinite(area)) return {};
    std::vector<double> costs(kSamples);
    tbb::parallel_for(std::size_t{0}, kSamples, [&](std::size_t k) {
      RandomStream random(0, k);
      // Stratified over the whole area; the error below is that of independent points, and so an upper bound.
      const double place = area * (static_cast<double>(k) + random.uniform()) / static_cast<double>(kSamples);
      const auto at = std::upper_bound(area_up_to.begin(), area_up_to.end() - 1, place) - area_up_to.begin();
      const PrimRef ref = refs[static_cast<std::size_t>(at)];
      const double u = random.uniform();
      const glm::dvec3 point = point_on_surface(pools_, ref, u, random.uniform());
      descend([&](std::int32_t n) {
        if (!inside(point, tree_.node(n).box)) return false;
        if (!holders_.holds(n, ref)) costs[k] += sah_node_cost(tree_.node(n));
        return true;
      });
    });
    const double mean = std::accumulate(costs.begin(), costs.end(), 0.0) / static_cast<double>(kSamples);
    double squares = 0;
    for (const double one : costs) squares += (one - mean) * (one - mean);
    return {area, mean, std::sqrt(squares / static_cast<double>(kSamples - 1) / static_cast<double>(kSamples))};
  }

  const Pools& pools_;
  const BvhTree& tree_;
  Holders holders_;
  std::vector<PrimRef> prims_;  ///< each once
};

void add_sibling_distance(const BvhTree& tree, BuildStats& stats) {
  const Aabb& scene = tree.nodes[0].box;
  const double diagonal = glm::length(glm::dvec3(scene.max) - glm::dvec3(scene.min));
  double distances = 0;
  for (const BvhTree::Node& node : tree.nodes) {
    glm::dvec3 middle(0.0);
    for (std::int32_t c = node.first; c < node.first + node.child_count; ++c) middle += center(tree.node(c).box) / double(node.child_count);
    for (std::int32_t c = node.first; c < node.first + node.child_count; ++c)
      distances += glm::length(center(tree.node(c).box) - middle) / double(node.child_count);
  }
  if (stats.interior_nodes > 0 && diagonal > 0) stats.sibling_distance = distances / static_cast<double>(stats.interior_nodes) / diagonal;
}

void add_cost_depth(const std::vector<double>& cost_at_depth, BuildStats& stats) {
  double costs = 0, cost_depths = 0;
  for (std::size_t d = 0; d < cost_at_depth.size(); ++d) {
    costs += cost_at_depth[d];
    cost_depths += cost_at_depth[d] * static_cast<double>(d);
  }
  if (!(costs > 0)) return;
  stats.cost_depth = cost_depths / costs;
  double up_to = 0;
  std::size_t d = 0;
  while (d + 1 < cost_at_depth.size() && (up_to += cost_at_depth[d]) < 0.9 * costs) ++d;
  stats.cost_depth_p90 = static_cast<double>(d);
}

}  // namespace

void add_volume_quality(const BvhTree& tree, std::span<const NodeMeasure> measures, BuildStats& stats) {
  if (tree.nodes.empty()) return;
  double half_areas = 0, enclosed = 0, costs = 0;
  std::vector<std::int32_t> depth(tree.nodes.size(), 0);
  std::vector<double> cost_at_depth;
  for (std::size_t n = 0; n < tree.nodes.size(); ++n) {  // parents before their children
    const BvhTree::Node& node = tree.nodes[n];
    const auto d = static_cast<std::size_t>(depth[n]);
    const double cost = sah_node_cost(node) * measures[n].half_area;
    half_areas += measures[n].half_area;
    enclosed += measures[n].enclosed;
    costs += cost;
    if (d >= cost_at_depth.size()) cost_at_depth.resize(d + 1);
    cost_at_depth[d] += cost;
    for (std::int32_t c = node.first; c < node.first + node.child_count; ++c) depth[static_cast<std::size_t>(c)] = static_cast<std::int32_t>(d) + 1;
  }
  stats.volume_area = 2 * half_areas;
  if (measures[0].half_area > 0) stats.sah_cost = costs / measures[0].half_area;
  if (measures[0].enclosed > 0) {
    stats.total_volume = enclosed / measures[0].enclosed;
    stats.node_volume = *stats.total_volume / static_cast<double>(stats.nodes());
  }
  add_cost_depth(cost_at_depth, stats);
}

void add_box_quality(const Scene& scene, const BvhTree& tree, int threads, BuildStats& stats) {
  if (tree.nodes.empty()) return;
  on_threads(threads, [&] {
    add_sibling_distance(tree, stats);
    const BvhTree ordered = depth_first(tree);
    EndPointOverlap(scene, ordered).measure(stats);
  });
}

}  // namespace raymeter
