#include <functional>
#include <vector>

#include "accel/kernel_set.h"
#include "accel/zbuffer/bins.h"
#include "accel/zbuffer/cell_runs.h"
#include "accel/zbuffer/drawn_samples.h"
#include "accel/zbuffer/zbuffer.h"
#include "accel/zbuffer/zbuffer_kernel.h"
#include "core/stats/policy.h"
#include "core/trace/slices.h"
#include "core/trace/trace.h"

namespace raymeter {

namespace {

/// The functions of the kernel on one instruction set, timed or counted.
struct ZbufferKernels {
  void (*list)(const ZbufferView&, const CellArgs&, Counters*) noexcept;
  void (*draw)(const ZbufferView&, const CellArgs&, Counters*) noexcept;
  void (*meet)(const ZbufferView&, const TraceArgs&, const std::int32_t*, Counters*) noexcept;
};

template <class Stats>
ZbufferKernels zbuffer_kernels(Isa isa) noexcept {
  return for_isa(isa, []<Isa I>() { return ZbufferKernels{ZbufferKernel<I, Stats>::list, ZbufferKernel<I, Stats>::draw, ZbufferKernel<I, Stats>::meet}; });
}

class Zbuffer final : public FirstHit {
public:
  Zbuffer(const Scene& scene, const SlotOptions& options, Intersector& intersector)
      : scene_(scene),
        params_(bind<ZbufferParams>(options.params)),
        timed_(zbuffer_kernels<NoStats>(options.isa)),
        counted_(zbuffer_kernels<CountStats>(options.isa)),
        packet_(options.packet),
        intersector_(intersector) {}

  void begin(const CameraModel& model, int threads) override {
    plane_ = ImagePlane(model);
    // A z-buffer's samples may lie beside those of the cell that they stand for.
    make_bins(plane_, scene_, params_.resolution == 1 ? 0 : 1, threads, bins_);
    const glm::vec3 view_dir(plane_.center);
    view_ = {scene_.pools().view(), bins_.footprints.data(), bins_.planes.data(), {view_dir.x, view_dir.y, view_dir.z}};
  }

  void find(const CameraModel&, const Column<std::int32_t>& pixels, const RayBatch& eye_rays, HitBatch& hits, int threads, Counters* counters) override {
    hits.resize(eye_rays.size());
    const bool seeds = params_.mode == "seed";
    RayBatch seeded;  // the eye rays, ending at what they are shown
    if (seeds) seeded = eye_rays;
    const CellRuns runs(plane_, pixels, packet_);
    std::vector<Counters> sums(counters != nullptr ? slice_count(eye_rays.size()) : 0);
    for_each_slice(eye_rays.size(), threads, [&](std::size_t slice, std::size_t first, std::size_t count) {
      Slice work{
          .kernels = counters != nullptr ? counted_ : timed_, .seeded = seeds ? &seeded : nullptr, .counters = counters != nullptr ? &sums[slice] : nullptr};
      for (std::size_t ray = first; ray < first + count; ray += static_cast<std::size_t>(work.run.count)) {
        runs.next(ray, first + count, work.run);
        find_run(eye_rays, hits, work);
      }
    });
    for (const Counters& sum : sums) counters->add(sum);
    if (!seeds) {
      if (counters != nullptr) counters->ray_count += eye_rays.size();
      return;
    }
    intersector_.prepare(seeded.view(), Query::closest, threads);
    trace_closest(intersector_, seeded, hits, threads, counters);
  }

private:
  /// What a slice works with.
  struct Slice {
    const ZbufferKernels& kernels;
    RayBatch* seeded;  ///< mode seed only
    Counters* counters;
    CellRun run{};
    DrawnSamples samples{};
    HitBatch drawn{};
    Column<std::int32_t> prim{};  ///< that the z-buffer shows at the run's rays
  };

  [[nodiscard]] CellArgs cell_args(const CellRun& run) const noexcept {
    const auto cell = bins_.cell(run.cell_x, run.cell_y);
    CellArgs args{};
    args.packet = packet_;
    args.near_list[0] = cell.data();
    args.near_list[1] = bins_.wide.data();
    args.list_size[0] = static_cast<std::int32_t>(cell.size());
    args.list_size[1] = static_cast<std::int32_t>(bins_.wide.size());
    args.rect[0] = run.rects.min_x;
    args.rect[1] = run.rects.max_x;
    args.rect[2] = run.rects.min_y;
    args.rect[3] = run.rects.max_y;
    args.sample[0] = run.x;
    args.sample[1] = run.y;
    return args;
  }

  void find_run(const RayBatch& eye_rays, HitBatch& hits, Slice& work) const {
    const CellRun& run = work.run;
    const auto size = static_cast<std::size_t>(run.count);
    CellArgs args = cell_args(run);
    args.rays = eye_rays.view(run.first, size);
    args.hits = hits.view(run.first, size);
    if (params_.mode == "list") return work.kernels.list(view_, args, work.counters);
    draw(args, work);
    // The hit of the ray itself, on the primitive that it is shown.
    work.kernels.meet(view_, {args.rays, args.hits, nullptr, packet_, nullptr}, work.prim.data(), work.counters);
    for (std::size_t k = 0; k < size; ++k) {
      const std::size_t ray = run.first + k;
      const auto sample = params_.resolution == 1 ? k : static_cast<std::size_t>(work.samples.of_ray[k]);
      if (work.seeded != nullptr) {
        if (hits.prim[ray] >= 0) work.seeded->t_max[ray] = hits.t[ray];
      } else if (hits.prim[ray] < 0 && work.prim[k] >= 0) {  // beside the ray: where the sample met it
        hits.prim[ray] = work.prim[k];
        hits.t[ray] = work.drawn.t[sample];
      }
    }
  }

  /// Draws the z-buffer about a run, and looks up what its rays are shown.
  void draw(CellArgs args, Slice& work) const {
    const auto size = static_cast<std::size_t>(work.run.count);
    work.prim.resize(size);
    if (params_.resolution != 1) {
      DrawnSamples& samples = work.samples;
      samples.make(plane_, work.run, params_.resolution, packet_);
      args.rays = samples.rays.view();
      for (std::size_t side = 0; side < samples.rect.size(); ++side) args.rect[side] = samples.rect[side].data();
      args.sample[0] = samples.x.data();
      args.sample[1] = samples.y.data();
    }
    work.drawn.resize(static_cast<std::size_t>(args.rays.count));
    args.hits = work.drawn.view();
    work.kernels.draw(view_, args, work.counters);
    for (std::size_t k = 0; k < size; ++k) work.prim[k] = work.drawn.prim[params_.resolution == 1 ? k : static_cast<std::size_t>(work.samples.of_ray[k])];
  }

  const Scene& scene_;
  ZbufferParams params_;
  ZbufferKernels timed_, counted_;
  int packet_;
  Intersector& intersector_;
  ImagePlane plane_{CameraModel{}};
  FootprintBins bins_;
  ZbufferView view_{};
};

}  // namespace

std::unique_ptr<FirstHit> make_zbuffer(const Scene& scene, const SlotOptions& options, Intersector& intersector) {
  return std::make_unique<Zbuffer>(scene, options, intersector);
}

}  // namespace raymeter
