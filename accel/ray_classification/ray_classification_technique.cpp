#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "accel/kernel_set.h"
#include "accel/ray_classification/classify_kernel.h"
#include "accel/ray_classification/ray_cells.h"
#include "accel/ray_classification/ray_classification.h"
#include "accel/ray_classification/ray_classification_kernel.h"
#include "core/base/threads.h"
#include "core/trace/on_demand.h"
#include "core/trace/slices.h"

namespace raymeter {

namespace {

using Classify = void (*)(const RayClassFrame&, const RayView&, std::int32_t, std::int32_t, std::uint64_t*) noexcept;

/// Owns the cells that its batches have made: memory_mb is for these.
class Classifier final : public Intersector, public OnDemand {
public:
  Classifier(const ClassifiedScene& scene, const Pools& pools, const RayClassificationParams& params, const QueryOptions& options)
      : scene_(scene),
        classify_(for_isa(options.isa, []<Isa I>() { return ClassifyKernel<I>::keys; })),
        kernels_(kernels_for<RayClassificationKernel, RayCellsView>(options.isa)),
        packet_(options.packet),
        cells_(scene, params) {
    view_.pools = pools.view();
    view_.beams = params.beams;
    std::copy_n(scene.space.frame().box, 6, view_.box);
    for (std::size_t kind = 0; kind < kPrimKindCount; ++kind) view_.prim_count[kind] = static_cast<std::int32_t>(pools.size(static_cast<PrimKind>(kind)));
  }

  [[nodiscard]] bool keeps_batch() const noexcept override { return true; }
  void prepare(const RayView& rays, Query, int threads) override {
    batch_ = rays;
    const auto count = static_cast<std::size_t>(rays.count);
    rays_.reset(count);
    const RayClassFrame frame = scene_.space.frame();
    for_each_slice(count, threads, [&](std::size_t, std::size_t first, std::size_t size) {
      classify_(frame, rays, static_cast<std::int32_t>(first), static_cast<std::int32_t>(size), rays_.key.data());
    });
    constexpr int kClassBits = 3;
    rays_.sort(scene_.space.key_bits() + kClassBits, threads);
    on_threads(threads, [&] { cells_.serve(rays_); });
    view_.cells = cells_.cells().data();
  }
  [[nodiscard]] const std::int32_t* order() const noexcept override { return rays_.place.data(); }

  [[nodiscard]] DemandStats demand() const noexcept override { return cells_.stats(); }

  void closest_hit(const RayView& rays, const HitView& hits, Counters* counters, std::byte* scratch) const noexcept override {
    const std::ptrdiff_t first = first_of(rays);
    const HitView all{hits.t - first, hits.prim - first, hits.u - first, hits.v - first, batch_.count};
    const auto kernel = counters != nullptr ? kernels_.counted_closest : kernels_.timed_closest;
    kernel(slice(first), {batch(rays.count), all, nullptr, packet_, scratch}, counters);
  }
  void any_hit(const RayView& rays, std::int32_t* blocker, Counters* counters, std::byte* scratch) const noexcept override {
    const std::ptrdiff_t first = first_of(rays);
    const auto kernel = counters != nullptr ? kernels_.counted_any : kernels_.timed_any;
    kernel(slice(first), {batch(rays.count), {}, blocker - first, packet_, scratch}, counters);
  }

private:
  [[nodiscard]] std::ptrdiff_t first_of(const RayView& rays) const noexcept {
    const std::ptrdiff_t first = rays.org[0] - batch_.org[0];
    assert(first >= 0 && first + rays.count <= batch_.count && "a slice of the batch that was prepared");
    return first;
  }
  [[nodiscard]] RayCellsView slice(std::ptrdiff_t first) const noexcept {
    RayCellsView view = view_;
    view.cell = cells_.cell_of_rays().data() + first;
    view.order = rays_.place.data() + first;
    return view;
  }
  [[nodiscard]] RayView batch(std::int32_t count) const noexcept {
    RayView rays = batch_;
    rays.count = count;
    return rays;
  }

  const ClassifiedScene& scene_;
  Classify classify_;
  KernelSet<RayCellsView> kernels_;
  int packet_;
  RayCells cells_;
  RayOrder rays_;
  RayView batch_{};
  RayCellsView view_{};
};

class RayClassification final : public Structure {
public:
  RayClassification(const Scene& scene, const RayClassificationParams& params, int threads)
      : scene_(scene, params, threads), pools_(reordered(scene.pools(), scene_.prims)) {
    stats_.leaves = kRayClasses;
    stats_.references = 0;
    for (std::int32_t c = 0; c < kRayClasses; ++c) stats_.max_depth = std::max(stats_.max_depth.value_or(0), std::int64_t{scene_.space.depth(c)});
    stats_.mem_bytes = sizeof *this + scene_.mem_bytes() + pools_.mem_bytes();
  }
  [[nodiscard]] const BuildStats& stats() const noexcept override { return stats_; }
  [[nodiscard]] std::unique_ptr<Intersector> intersector(const QueryOptions& options) const override {
    const auto params = bind<RayClassificationParams>(options.params);
    const double least = static_cast<double>(RayCells::least_bytes(scene_)) * 0x1p-20;
    if (params.memory_mb < least) {
      throw Error("memory_mb: " + to_string(ParamValue(params.memory_mb)) + " is too little for the lists of " + std::to_string(scene_.prims.size()) +
                  " primitives; expected at least " + to_string(ParamValue(std::ceil(least * 16) / 16)));
    }
    return std::make_unique<Classifier>(scene_, pools_, params, options);
  }

private:
  ClassifiedScene scene_;
  Pools pools_;  ///< in the scene's order: what lies together there mostly does in space
  BuildStats stats_;
};

}  // namespace

std::unique_ptr<Structure> build_ray_classification(const Scene& scene, const ParamValues& values, int threads) {
  return std::make_unique<RayClassification>(scene, bind<RayClassificationParams>(values), threads);
}

}  // namespace raymeter
