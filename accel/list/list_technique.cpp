#include "accel/kernel_intersector.h"
#include "accel/list/bounded_list_kernel.h"
#include "accel/list/list.h"
#include "accel/list/list_kernel.h"
#include "accel/volume_links.h"
#include "core/base/threads.h"
#include "core/bounds/prim_hull.h"

namespace raymeter {

namespace {

class List final : public Structure {
public:
  explicit List(const Scene& scene) : view_{scene.pools().view(), {}, 0} {
    for (std::size_t kind = 0; kind < kPrimKindCount; ++kind) {
      const auto count = static_cast<std::int32_t>(scene.pools().size(static_cast<PrimKind>(kind)));
      if (count > 0) view_.run[view_.run_count++] = primitive_run(static_cast<PrimKind>(kind), 0, count);
    }
    stats_.leaves = 1;
    stats_.empty_leaves = scene.prim_count() == 0 ? 1 : 0;
    stats_.references = scene.prim_count();
    stats_.max_depth = 0;
    stats_.sah_cost = scene.prim_count();
    stats_.mem_bytes = sizeof *this;
  }
  [[nodiscard]] const BuildStats& stats() const noexcept override { return stats_; }
  [[nodiscard]] std::unique_ptr<Intersector> intersector(const QueryOptions& options) const override {
    return std::make_unique<KernelIntersector<ListView>>(view_, kernels_for<ListKernel, ListView>(options.isa), options.packet);
  }

private:
  ListView view_;
  BuildStats stats_;
};

/// The objects that get a volume of their own: composites, or all primitives. Dropped ones are left out.
std::vector<std::vector<PrimRef>> objects_of(const Scene& scene, bool composites) {
  std::vector<std::vector<PrimRef>> objects;
  for (std::int32_t id = 0; id < scene.prim_id_count();) {
    const Object* const object = composites ? scene.object_of(id) : nullptr;
    const std::int32_t end = object != nullptr ? object->end_prim : id + 1;
    std::vector<PrimRef> prims;
    for (; id < end; ++id) {
      if (!scene.prim(id).dropped()) prims.push_back(scene.prim(id));
    }
    if (!prims.empty()) objects.push_back(std::move(prims));
  }
  return objects;
}

/// What an object's primitives are in the scene's pools: they were added one after another, so that those of a kind lie together.
std::vector<PrimitiveRun> runs_of(std::span<const PrimRef> prims) {
  std::vector<PrimitiveRun> runs;
  for (std::size_t kind = 0; kind < kPrimKindCount; ++kind) {
    std::int32_t first = 0, count = 0;
    for (const PrimRef prim : prims) {
      if (prim.kind() == static_cast<PrimKind>(kind) && count++ == 0) first = static_cast<std::int32_t>(prim.index);
    }
    if (count > 0) runs.push_back(primitive_run(static_cast<PrimKind>(kind), first, count));
  }
  return runs;
}

template <BoundingVolume V>
std::vector<typename V::Bound> bounds_of(const std::vector<std::vector<PrimRef>>& objects, const Scene& scene, const V& volume, int threads) {
  std::vector<typename V::Bound> bounds(objects.size());
  on_threads(threads, [&] { for_each_index(objects.size(), [&](std::size_t i) { bounds[i] = volume.fit(scene, objects[i]); }); });
  return bounds;
}

template <BoundingVolume V>
class BoundedObjects final : public Structure {
public:
  using View = BoundedListView<typename V::Layout>;

  BoundedObjects(const Scene& scene, bool composites, const V& volume, int threads)
      : scene_(scene), links_(make_links(scene, objects_of(scene, composites), volume, threads, count_)) {
    stats_.leaves = count_;
    stats_.references = scene.prim_count();
    stats_.max_depth = 0;
    stats_.mem_bytes = sizeof *this + links_.mem_bytes();
  }
  [[nodiscard]] const BuildStats& stats() const noexcept override { return stats_; }
  [[nodiscard]] std::unique_ptr<Intersector> intersector(const QueryOptions& options) const override {
    const View view{links_.view(scene_.pools()), count_};
    return std::make_unique<KernelIntersector<View>>(view, kernels_for<BoundedList<typename V::Layout>::template Kernel, View>(options.isa), options.packet);
  }

private:
  static VolumeLinks<V> make_links(const Scene& scene, const std::vector<std::vector<PrimRef>>& objects, const V& volume, int threads, std::int32_t& count) {
    std::vector<VolumeLink> links;
    std::vector<PrimitiveRun> runs;
    for (const std::vector<PrimRef>& prims : objects) links.push_back(link_to(runs_of(prims), runs));
    count = static_cast<std::int32_t>(objects.size());
    return VolumeLinks<V>(volume, links, bounds_of(objects, scene, volume, threads), std::move(runs));
  }

  const Scene& scene_;
  std::int32_t count_ = 0;
  VolumeLinks<V> links_;
  BuildStats stats_;
};

}  // namespace

ParamValues resolve_list(const ParamValues& values) {
  const auto params = bind<ListParams>(values);
  check_volume(params.volume, params);
  return resolved(params);
}

std::unique_ptr<Structure> build_list(const Scene& scene, const ParamValues& values, int threads) {
  const auto params = bind<ListParams>(values);
  if (params.volume == "none") return std::make_unique<List>(scene);
  return with_volume(params.volume, params, scene, [&]<class V>(const V& volume) -> std::unique_ptr<Structure> {
    return std::make_unique<BoundedObjects<V>>(scene, params.around == "object", volume, threads);
  });
}

void add_list_quality(const Scene& scene, const ParamValues& values, int threads, BuildStats& stats) {
  const auto params = bind<ListParams>(values);
  if (params.volume == "none") return;
  with_volume(params.volume, params, scene, [&](const auto& volume) {
    const auto objects = objects_of(scene, params.around == "object");
    const auto bounds = bounds_of(objects, scene, volume, threads);
    double half_area = 0, held = 0;
    bool all_single = true;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      half_area += volume.half_area(bounds[i]);
      held += hull_half_area(scene.pools(), objects[i].front());
      all_single = all_single && objects[i].size() == 1;
    }
    stats.volume_area = 2 * half_area;
    // A convex body's mean projected area is a quarter of its surface area. Of composites, whose parts hide each other, it is not known.
    if (all_single) stats.void_area = (half_area - held) / 2;
  });
}

}  // namespace raymeter
