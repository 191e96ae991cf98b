#pragma once

#include "accel/bvh/bvh.h"
#include "accel/bvh/flat_tree.h"
#include "accel/bvh/heap_kernel.h"
#include "accel/bvh/packet_kernel.h"
#include "accel/kernel_intersector.h"
#include "accel/volume_links.h"
#include "core/base/threads.h"
#include "core/bounds/aabb_volume.h"

namespace raymeter {

/// The volumes of a tree's links. Axis-aligned boxes are the builder's own, which spatial splits may have cut; of other kinds each node's is fitted around
/// all primitives below it, or, where that is as tight, merged from its children's.
template <BoundingVolume V>
[[nodiscard]] std::vector<typename V::Bound> link_bounds(const V& volume, const Scene& scene, const BvhTree& tree, const FlatTree& flat, int threads) {
  std::vector<typename V::Bound> bounds(flat.links.size());
  if (tree.nodes.empty()) return bounds;
  const auto fit = [&](std::size_t i) {
    const FlatTree::Source& source = flat.sources[i];
    if (source.node < 0) return;
    if constexpr (std::same_as<V, AabbVolume>) {
      bounds[i] = tree.node(source.node).box;
    } else if (!V::kMergeIsTight || flat.links[i].tag() != VolumeLink::kInner) {
      bounds[i] = volume.fit(
          scene, std::span(flat.order).subspan(static_cast<std::size_t>(source.first_prim), static_cast<std::size_t>(source.end_prim - source.first_prim)));
    }
  };
  on_threads(threads, [&] { for_each_index(flat.links.size(), fit); });
  for (std::size_t i = flat.links.size(); V::kMergeIsTight && !std::same_as<V, AabbVolume> && i-- > 0;) {
    const VolumeLink& link = flat.links[i];
    if (link.tag() != VolumeLink::kInner) continue;
    const auto first = static_cast<std::size_t>(link.first);
    bounds[i] = bounds[first];
    for (std::size_t c = 1; c < static_cast<std::size_t>(link.count()); ++c) bounds[i] = volume.merge(bounds[i], bounds[first + c]);
  }
  return bounds;
}

/// Adds the area of the nodes' volumes, and the SAH cost by these areas.
template <BoundingVolume V>
void add_volume_quality(const V& volume, const Scene& scene, const BvhTree& tree, int threads, BuildStats& stats) {
  const FlatTree flat = flatten(tree);
  const std::vector<typename V::Bound> bounds = link_bounds(volume, scene, tree, flat, threads);
  std::vector<double> half_area(bounds.size(), 0);
  on_threads(threads, [&] {
    for_each_index(bounds.size(), [&](std::size_t i) {
      if (flat.sources[i].node >= 0) half_area[i] = volume.half_area(bounds[i]);
    });
  });
  double area_sum = 0, cost_sum = 0;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const FlatTree::Source& source = flat.sources[i];
    const bool inner = flat.links[i].tag() == VolumeLink::kInner;
    area_sum += half_area[i];
    cost_sum += half_area[i] * (inner ? 1 : source.end_prim - source.first_prim);
  }
  stats.volume_area = 2 * area_sum;
  if (half_area[0] > 0) stats.sah_cost = cost_sum / half_area[0];
}

/// A hierarchy laid out for the traversals of any kind of volume.
template <BoundingVolume V>
class BvhStructure final : public Structure {
public:
  using Layout = typename V::Layout;

  BvhStructure(const Scene& scene, const BvhTree& tree, const V& volume, int threads) : BvhStructure(scene, tree, flatten(tree), volume, threads) {}

  [[nodiscard]] const BuildStats& stats() const noexcept override { return stats_; }
  [[nodiscard]] std::unique_ptr<Intersector> intersector(const QueryOptions& options) const override {
    const bool heap = bind<BvhParams>(options.params).traversal == "heap";
    const auto& kernels = heap ? kernels_for<BvhHeap<Layout>::template Kernel, BvhView<Layout>>(options.isa)
                               : kernels_for<BvhPacket<Layout>::template Kernel, BvhView<Layout>>(options.isa);
    const std::size_t scratch = heap ? bvh_heap_bytes(heap_capacity_) : bvh_stack_bytes(stack_capacity_, options.packet);
    const BvhView<Layout> view{links_.view(pools_), stack_capacity_, heap_capacity_};
    return std::make_unique<KernelIntersector<BvhView<Layout>>>(view, kernels, options.packet, scratch);
  }

private:
  BvhStructure(const Scene& scene, const BvhTree& tree, FlatTree flat, const V& volume, int threads)
      : stats_(tree_stats(tree)),
        links_(volume, flat.links, link_bounds(volume, scene, tree, flat, threads), std::move(flat.runs)),
        pools_(reordered(scene.pools(), flat.order)),
        stack_capacity_(flat.stack_capacity),
        heap_capacity_(flat.heap_capacity) {
    stats_.mem_bytes = sizeof *this + links_.mem_bytes() + pools_.mem_bytes();
  }

  BuildStats stats_;
  VolumeLinks<V> links_;
  Pools pools_;
  std::int32_t stack_capacity_;
  std::int32_t heap_capacity_;
};

}  // namespace raymeter
