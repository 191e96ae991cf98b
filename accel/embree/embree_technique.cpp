#include "accel/embree/embree.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <map>
#include <mutex>
#include <vector>

#include "accel/embree/embree_modes.h"
#include "core/ray/ray_batch.h"
#include "core/trace/slices.h"

namespace raymeter {

namespace {

/// Denormal numbers are taken for zero while Embree works, as it asks of its callers.
class FlushDenormals {
public:
  FlushDenormals() noexcept : before_(__builtin_ia32_stmxcsr()) { __builtin_ia32_ldmxcsr(before_ | kFlushToZero | kDenormalsAreZero); }
  ~FlushDenormals() { __builtin_ia32_ldmxcsr(before_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

private:
  static constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
  unsigned before_;
};

std::optional<EmbreeMode> mode_of(const EmbreeParams& params) noexcept {
  for (const EmbreeMode& mode : embree_modes()) {
    if (name(mode.layout) == params.mode) return EmbreeMode{mode.layout, params.coherence == "coherent"};
  }
  return std::nullopt;
}

/// Seconds that a mode takes for some slices; `ahead` leaves out the conversion.
double time_of(const EmbreeScene& scene, EmbreeMode mode, Query query, const RayView& rays, bool ahead) {
  constexpr std::int32_t kSlices = 64;
  using Clock = std::chrono::steady_clock;
  const FlushDenormals flush;
  Column<std::byte> space(embree_bytes(mode.layout, query, kSliceRays));
  HitBatch hits;
  hits.resize(kSliceRays);
  Column<std::int32_t> blocker(kSliceRays);
  const auto slices = static_cast<std::int32_t>(slice_count(static_cast<std::size_t>(rays.count)));
  const std::int32_t taken = std::min(slices, kSlices);
  double sum = 0;
  for (std::int32_t s = 0; s < taken; ++s) {
    const std::int32_t first = static_cast<std::int32_t>(std::int64_t{s} * slices / taken) * kSliceRays;
    const RayView slice = slice_of(rays, first, std::min(kSliceRays, rays.count - first));
    auto start = Clock::now();
    to_embree(mode.layout, query, slice, space.data());
    if (ahead) start = Clock::now();
    trace_embree(scene, mode, query, space.data(), hits.view(0, static_cast<std::size_t>(slice.count)), blocker.data(), slice.count);
    sum += std::chrono::duration<double>(Clock::now() - start).count();
  }
  return sum;
}

class EmbreeIntersector final : public Intersector {
public:
  EmbreeIntersector(std::shared_ptr<const EmbreeScene> scene, const EmbreeParams& params)
      : scene_(std::move(scene)), mode_{mode_of(params), mode_of(params)}, ahead_(params.layout == "ahead") {}

  [[nodiscard]] bool keeps_batch() const noexcept override { return true; }
  void prepare(const RayView& rays, Query query, int) override {
    if (rays.count == 0) return;
    std::optional<EmbreeMode>& mode = mode_[static_cast<std::size_t>(query)];
    if (!mode) mode = fastest(rays, query);
    if (!ahead_) return;
    batch_ = rays.t_min;
    const std::size_t slices = slice_count(static_cast<std::size_t>(rays.count));
    slice_bytes_ = embree_bytes(mode->layout, query, kSliceRays);
    converted_.resize(slices * slice_bytes_);
    for (std::size_t s = 0; s < slices; ++s) {
      const auto first = static_cast<std::int32_t>(s) * kSliceRays;
      to_embree(mode->layout, query, slice_of(rays, first, std::min(kSliceRays, rays.count - first)), converted_.data() + s * slice_bytes_);
    }
  }
  [[nodiscard]] std::string choice(Query query) const override {
    const std::optional<EmbreeMode>& mode = mode_[static_cast<std::size_t>(query)];
    if (!mode) return {};
    return "mode=" + std::string(name(mode->layout)) + (mode->coherent ? ",coherence=coherent" : ",coherence=incoherent");
  }
  [[nodiscard]] std::size_t scratch_bytes() const noexcept override {
    std::size_t most = 0;
    for (const EmbreeMode& mode : embree_modes()) most = std::max(most, embree_bytes(mode.layout, Query::closest, kSliceRays));
    return most;
  }
  void closest_hit(const RayView& rays, const HitView& hits, Counters*, std::byte* scratch) const noexcept override {
    trace(Query::closest, rays, hits, nullptr, scratch);
  }
  void any_hit(const RayView& rays, std::int32_t* blocker, Counters*, std::byte* scratch) const noexcept override {
    trace(Query::any, rays, {}, blocker, scratch);
  }

private:
  /// By the least time of several rounds, so that a slow spell of the machine decides nothing.
  [[nodiscard]] EmbreeMode fastest(const RayView& rays, Query query) const {
    constexpr int kRounds = 5;
    const auto modes = embree_modes();
    std::vector<double> least_s(modes.size(), std::numeric_limits<double>::infinity());
    for (int round = 0; round < kRounds; ++round) {
      for (std::size_t m = 0; m < modes.size(); ++m) least_s[m] = std::min(least_s[m], time_of(*scene_, modes[m], query, rays, ahead_));
    }
    return modes[static_cast<std::size_t>(std::ranges::min_element(least_s) - least_s.begin())];
  }

  void trace(Query query, const RayView& rays, const HitView& hits, std::int32_t* blocker, std::byte* scratch) const noexcept {
    const FlushDenormals flush;
    const EmbreeMode mode = mode_[static_cast<std::size_t>(query)].value_or(EmbreeMode{});
    std::byte* space = scratch;
    if (ahead_)
      space = converted_.data() + static_cast<std::size_t>((rays.t_min - batch_) / kSliceRays) * slice_bytes_;
    else
      to_embree(mode.layout, query, rays, space);
    trace_embree(*scene_, mode, query, space, hits, blocker, rays.count);
  }

  std::shared_ptr<const EmbreeScene> scene_;
  std::array<std::optional<EmbreeMode>, 2> mode_;  ///< by query; empty until the fastest is known
  bool ahead_;
  const float* batch_ = nullptr;  ///< which batch `converted_` holds: its first t_min
  std::size_t slice_bytes_ = 0;
  mutable Column<std::byte> converted_;  ///< a slice's part is written by whoever traces that slice
};

class Embree final : public Structure {
public:
  Embree(const Scene& scene, const EmbreeParams& params, int threads) : source_(scene), params_(params), threads_(threads) {
    stats_.mem_bytes = scene_for(best_isa())->mem_bytes();
  }
  [[nodiscard]] const BuildStats& stats() const noexcept override { return stats_; }
  [[nodiscard]] std::unique_ptr<Intersector> intersector(const QueryOptions& options) const override {
    return std::make_unique<EmbreeIntersector>(scene_for(options.isa), bind<EmbreeParams>(options.params));
  }

private:
  /// Embree's trees depend on the instruction set: that of the machine's best is built at once, the others when they are asked for.
  [[nodiscard]] std::shared_ptr<const EmbreeScene> scene_for(Isa isa) const {
    const std::scoped_lock lock(mutex_);
    std::shared_ptr<const EmbreeScene>& scene = scenes_[isa];
    if (!scene) scene = std::make_shared<const EmbreeScene>(source_, params_, isa, threads_);
    return scene;
  }

  const Scene& source_;
  EmbreeParams params_;
  int threads_;
  mutable std::mutex mutex_;
  mutable std::map<Isa, std::shared_ptr<const EmbreeScene>> scenes_;
  BuildStats stats_;
};

}  // namespace

std::unique_ptr<Structure> build_embree(const Scene& scene, const ParamValues& values, int threads) {
  return std::make_unique<Embree>(scene, bind<EmbreeParams>(values), threads);
}

}  // namespace raymeter
