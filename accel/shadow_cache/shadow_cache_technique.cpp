// The host side: what the entries are, when they are read and when they are written. Entries are written in the order of the rays, whatever the threads: so
// counts depend on neither, and two runs of a frame are the same.

#include "accel/shadow_cache/shadow_cache.h"

#include <algorithm>
#include <vector>

#include "accel/kernel_set.h"
#include "accel/shadow_cache/blocker_table.h"
#include "accel/shadow_cache/shadow_cache_kernel.h"
#include "core/base/ieee_arithmetic.h"
#include "core/stats/policy.h"
#include "core/trace/trace.h"

namespace raymeter {

namespace {

/// Tests the cached blockers of one slice's rays.
class CachedTest {
public:
  CachedTest(const Scene& scene, Isa isa, int packet) : pools_(scene.pools().view()), kernels_(kernels_for(isa)), packet_(packet) {}

  void operator()(const RayView& rays, const PrimRef* cached, std::int32_t* blocker, Counters* counters) const noexcept {
    const auto kernel = counters != nullptr ? kernels_.counted : kernels_.timed;
    kernel({pools_, cached}, {rays, {}, blocker, packet_, nullptr}, counters);
  }

private:
  using Function = void (*)(const CachedBlockersView&, const TraceArgs&, Counters*) noexcept;
  struct Kernels {
    Function timed;
    Function counted;
  };
  static const Kernels& kernels_for(Isa isa) noexcept {
    return for_isa(isa, []<Isa I>() { return Kernels{ShadowCacheKernel<I, NoStats>::any, ShadowCacheKernel<I, CountStats>::any}; });
  }

  PoolsView pools_;
  const Kernels& kernels_;
  int packet_;
};

/// Ray by ray: each learns from all before it.
class SerialShadowCache final : public Occlusion {
public:
  SerialShadowCache(const Scene& scene, const ShadowCacheParams& params, Isa isa, Intersector& intersector)
      : table_(scene, params), test_(scene, isa, 1), intersector_(intersector), scratch_(std::max<std::size_t>(64, intersector.scratch_bytes())) {}

  void begin() override { table_.clear(); }
  [[nodiscard]] bool needs_order() const noexcept override { return true; }
  [[nodiscard]] std::unique_ptr<Occlusion> for_tiles() const override { return nullptr; }
  void find(const RayBatch& rays, const ShadowOrigins& origins, Column<std::int32_t>& blocker, int, Counters* counters) override {
    const IeeeArithmetic ieee;
    blocker.resize(rays.size());
    Column<PrimRef> cached(1);  // a column, since kernels read past its end
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const std::size_t entry = table_.entry(origins, i);
      const RayView ray = rays.view(i, 1);
      cached[0] = table_[entry];
      blocker[i] = -1;
      if (!cached[0].dropped()) test_(ray, cached.data(), &blocker[i], counters);
      if (blocker[i] < 0) {
        intersector_.prepare(ray, Query::any, 1);  // each ray is a batch
        intersector_.any_hit(ray, &blocker[i], counters, scratch_.data());
      }
      table_.learn(entry, blocker[i]);
    }
    if (counters != nullptr) counters->ray_count += rays.size();
  }

private:
  BlockerTable table_;
  CachedTest test_;
  Intersector& intersector_;
  Column<std::byte> scratch_;
};

/// Batch by batch: the rays of one are tested against what the table held when it began, and those that are left are traced together.
class BatchShadowCache final : public Occlusion {
public:
  BatchShadowCache(const Scene& scene, const ShadowCacheParams& params, Isa isa, int packet, Intersector& intersector)
      : table_(scene, params), test_(scene, isa, packet), intersector_(intersector), batch_(static_cast<std::size_t>(params.batch)) {}

  void begin() override { table_.clear(); }
  [[nodiscard]] std::unique_ptr<Occlusion> for_tiles() const override { return std::make_unique<BatchShadowCache>(*this); }
  void find(const RayBatch& rays, const ShadowOrigins& origins, Column<std::int32_t>& blocker, int threads, Counters* counters) override {
    blocker.resize(rays.size());
    for (std::size_t first = 0; first < rays.size(); first += batch_) {
      const std::size_t count = std::min(batch_, rays.size() - first);
      test_cached(rays, origins, first, count, blocker, threads, counters);
      trace_open(rays, first, count, blocker, threads, counters);
      for (std::size_t i = first; i < first + count; ++i) table_.learn(table_.entry(origins, i), blocker[i]);
    }
  }

private:
  void test_cached(const RayBatch& rays, const ShadowOrigins& origins, std::size_t first, std::size_t count, Column<std::int32_t>& blocker, int threads,
                   Counters* counters) {
    cached_.resize(count);
    slice_counters_.assign(counters != nullptr ? slice_count(count) : 0, {});
    for_each_slice(count, threads, [&](std::size_t slice, std::size_t begin, std::size_t size) {
      for (std::size_t i = begin; i < begin + size; ++i) cached_[i] = table_[table_.entry(origins, first + i)];
      test_(rays.view(first + begin, size), cached_.data() + begin, blocker.data() + first + begin, counters != nullptr ? &slice_counters_[slice] : nullptr);
    });
    for (const Counters& one : slice_counters_) counters->add(one);
  }

  void trace_open(const RayBatch& rays, std::size_t first, std::size_t count, Column<std::int32_t>& blocker, int threads, Counters* counters) {
    open_.clear();
    for (std::size_t i = first; i < first + count; ++i) {
      if (blocker[i] < 0) open_.push_back(static_cast<std::int32_t>(i));
    }
    open_rays_.resize(open_.size());
    for_each_slice(open_.size(), threads, [&](std::size_t, std::size_t begin, std::size_t size) {
      for (std::size_t k = begin; k < begin + size; ++k) open_rays_.set(k, rays[static_cast<std::size_t>(open_[k])]);
    });
    intersector_.prepare(open_rays_.view(), Query::any, threads);
    trace_any(intersector_, open_rays_, open_blocker_, threads, counters);
    for (std::size_t k = 0; k < open_.size(); ++k) blocker[static_cast<std::size_t>(open_[k])] = open_blocker_[k];
    if (counters != nullptr) counters->ray_count += count - open_.size();
  }

  BlockerTable table_;
  CachedTest test_;
  Intersector& intersector_;
  std::size_t batch_;
  Column<PrimRef> cached_;  ///< of the batch's rays
  std::vector<Counters> slice_counters_;
  Column<std::int32_t> open_;  ///< rays that the cache does not answer
  RayBatch open_rays_;
  Column<std::int32_t> open_blocker_;
};

}  // namespace

std::unique_ptr<Occlusion> make_shadow_cache(const Scene& scene, const SlotOptions& options, Intersector& intersector) {
  const auto params = bind<ShadowCacheParams>(options.params);
  if (params.update == "serial") return std::make_unique<SerialShadowCache>(scene, params, options.isa, intersector);
  return std::make_unique<BatchShadowCache>(scene, params, options.isa, options.packet, intersector);
}

}  // namespace raymeter
