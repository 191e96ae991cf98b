#pragma once

#include "accel/bvh/bvh.h"
#include "accel/bvh/flat_tree.h"
#include "accel/bvh/heap_kernel.h"
#include "accel/bvh/packet_kernel.h"
#include "accel/bvh/tree_quality.h"
#include "accel/bvh/weak_bvh.h"
#include "accel/kernel_intersector.h"
#include "accel/volume_links.h"
#include "core/base/threads.h"
#include "core/bounds/aabb_volume.h"
#include "core/scene/unit_triangles.h"

namespace raymeter {

/// So many primitives at most have a volume fitted around all of them at once: it looks at a copy of each.
inline constexpr std::int32_t kMostFitted = 1 << 15;

/// The volumes of a tree's links. Axis-aligned boxes are the builder's own, which spatial splits may have cut. Of other kinds a node's volume is fitted around
/// all primitives below it; where that is no tighter, or where there are too many, it is merged from its children's. `tight`: boxes as they are around the
/// primitives below, with no room for what these kernels err.
template <BoundingVolume V>
[[nodiscard]] std::vector<typename V::Bound> link_bounds(const V& volume, const Scene& scene, const BvhTree& tree, const FlatTree& flat, bool tight,
                                                         int threads) {
  std::vector<typename V::Bound> bounds(flat.links.size());
  if (tree.nodes.empty()) return bounds;
  const auto merged = [&](std::size_t i) {
    const FlatTree::Source& source = flat.sources[i];
    return flat.links[i].tag() == VolumeLink::kInner && (V::kMergeIsTight || source.end_prim - source.first_prim > kMostFitted);
  };
  const auto fit = [&](std::size_t i) {
    const FlatTree::Source& source = flat.sources[i];
    if (source.node < 0) return;
    if constexpr (std::same_as<V, AabbVolume>) {
      if (!tight) bounds[i] = tree.node(source.node).box;
      for (std::int32_t k = source.first_prim; tight && k < source.end_prim; ++k)
        bounds[i].grow(tight_bounds(scene.pools(), flat.order[static_cast<std::size_t>(k)]));
    } else if (!merged(i)) {
      bounds[i] = volume.fit(
          scene, std::span(flat.order).subspan(static_cast<std::size_t>(source.first_prim), static_cast<std::size_t>(source.end_prim - source.first_prim)));
    }
  };
  on_threads(threads, [&] { for_each_index(flat.links.size(), fit); });
  for (std::size_t i = flat.links.size(); !std::same_as<V, AabbVolume> && i-- > 0;) {  // children stand behind their parent
    if (!merged(i)) continue;
    const auto first = static_cast<std::size_t>(flat.links[i].first);
    bounds[i] = bounds[first];
    for (std::size_t c = 1; c < static_cast<std::size_t>(flat.links[i].count()); ++c) bounds[i] = volume.merge(bounds[i], bounds[first + c]);
  }
  return bounds;
}

/// What the volumes of a tree's nodes measure.
template <BoundingVolume V>
[[nodiscard]] std::vector<NodeMeasure> node_measures(const V& volume, const Scene& scene, const BvhTree& tree, int threads) {
  const FlatTree flat = flatten(tree);
  const std::vector<typename V::Bound> bounds = link_bounds(volume, scene, tree, flat, false, threads);
  std::vector<NodeMeasure> measures(tree.nodes.size());
  on_threads(threads, [&] {
    for_each_index(bounds.size(), [&](std::size_t i) {
      if (flat.sources[i].node >= 0) measures[static_cast<std::size_t>(flat.sources[i].node)] = {volume.half_area(bounds[i]), volume.enclosed(bounds[i])};
    });
  });
  return measures;
}

/// A hierarchy laid out for the traversals of any kind of volume.
template <BoundingVolume V>
class BvhStructure final : public Structure {
public:
  using Layout = typename V::Layout;

  BvhStructure(const Scene& scene, const BvhTree& tree, const V& volume, int threads, const BvhParams& params = {})
      : BvhStructure(scene, tree, flatten(tree), volume, params.box_bounds == "tight", threads) {
    if (params.triangle_test == "baldwin_weber") unit_triangles_ = unit_triangles(pools_, threads);
    stats_.mem_bytes += unit_triangles_.mem_bytes();
  }

  [[nodiscard]] const BuildStats& stats() const noexcept override { return stats_; }
  [[nodiscard]] std::unique_ptr<Intersector> intersector(const QueryOptions& options) const override {
    const auto params = bind<BvhParams>(options.params);
    const bool heap = params.traversal == "heap";
    const auto& kernels = heap ? kernels_for<BvhHeap<Layout>::template Kernel, BvhView<Layout>>(options.isa)
                               : kernels_for<BvhPacket<Layout>::template Kernel, BvhView<Layout>>(options.isa);
    const std::size_t scratch = heap ? bvh_heap_bytes(heap_capacity_) : bvh_stack_bytes(stack_capacity_, options.packet);
    const BvhView<Layout> view{links_.view(pools_), stack_capacity_, heap_capacity_};
    if constexpr (std::same_as<V, AabbVolume>) {
      if (!heap && has_weak_tests(params)) return weak_intersector(view, unit_triangles_.view(), params, options, scratch);
    }
    return std::make_unique<KernelIntersector<BvhView<Layout>>>(view, kernels, options.packet, scratch);
  }

private:
  BvhStructure(const Scene& scene, const BvhTree& tree, FlatTree flat, const V& volume, bool tight, int threads)
      : stats_(tree_stats(tree)),
        links_(volume, flat.links, link_bounds(volume, scene, tree, flat, tight, threads), std::move(flat.runs)),
        pools_(reordered(scene.pools(), flat.order)),
        stack_capacity_(flat.stack_capacity),
        heap_capacity_(flat.heap_capacity) {
    stats_.mem_bytes = sizeof *this + links_.mem_bytes() + pools_.mem_bytes();
  }

  BuildStats stats_;
  VolumeLinks<V> links_;
  Pools pools_;
  UnitTriangles unit_triangles_;  ///< of bvh:triangle_test=baldwin_weber
  std::int32_t stack_capacity_;
  std::int32_t heap_capacity_;
};

}  // namespace raymeter
