// Tests of cached blockers (Haines, Greenberg 1986). Memory: a reference to a primitive of the scene's pools for each ray. Events: cache_test, a ray against
// its cached primitive; cache_hit, that blocks it. Neither counts as prim_test or prim_hit: those are of the structure behind the cache, and all tests are the
// sum. Departure: rays share registers, and each distinct primitive of a register is tested once, by the code that leaves use. So an answer is that of any
// structure: a ray is blocked by this primitive or not, whoever asks. It ends: each turn of the loop takes at least one lane off.

#include "accel/shadow_cache/shadow_cache_kernel.h"

#include "core/geometry/run_kernel.h"
#include "core/ray/packet_loop.h"
#include "core/stats/policy.h"

namespace raymeter {

namespace {

/// Counts tests of primitives as tests of the cache.
template <class Stats>
struct CacheEvents {
  static constexpr bool kCounting = Stats::kCounting;
  Stats stats;
  template <Event e, class L>
  void count(const typename L::Mask& lanes) const noexcept {
    static_assert(e == Event::prim_test || e == Event::prim_hit);
    stats.template count<e == Event::prim_test ? Event::cache_test : Event::cache_hit, L>(lanes);
  }
};

template <class L, class Stats>
void test_cached(const CachedBlockersView& cached, const TraceArgs& args, CacheEvents<Stats> stats) noexcept {
  static_assert(sizeof(PrimRef) == sizeof(std::int32_t));
  Packet<L, 1> packet;
  const std::int32_t step = args.packet < L::kWidth ? args.packet : L::kWidth;
  for (std::int32_t first = 0; first < args.rays.count; first += step) {
    const std::int32_t left = args.rays.count - first;
    const std::int32_t count = left < step ? left : step;
    load_packet(args.rays, first, count, packet);
    alignas(64) std::int32_t ref_bits[L::kWidth];
    std::uint32_t has_one = 0;
    for (std::int32_t lane = 0; lane < count; ++lane) {
      ref_bits[lane] = __builtin_bit_cast(std::int32_t, cached.blocker[first + lane]);
      has_one |= cached.blocker[first + lane].dropped() ? 0u : 1u << lane;
    }
    for (std::int32_t lane = count; lane < L::kWidth; ++lane) ref_bits[lane] = 0;
    const typename L::Int refs = L::load(ref_bits);
    std::uint32_t open = has_one & L::bits(packet.live(0));
    while (open != 0) {
      const int lane = __builtin_ctz(open);
      const PrimRef ref = cached.blocker[first + lane];
      const typename L::Mask same = L::mask(open) & L::equal(refs, typename L::Int(ref_bits[lane]));
      test_refs<Query::any>(packet, &same, cached.pools, ref.kind(), 1, PositionRefs{static_cast<std::int32_t>(ref.index)}, stats);
      open &= ~L::bits(same);
    }
    store_packet<Query::any>(args, first, count, packet);
  }
}

}  // namespace

template <Isa I, class Stats>
void ShadowCacheKernel<I, Stats>::any(const CachedBlockersView& cached, const TraceArgs& args, Counters* counters) noexcept {
  test_cached<Lanes<I>>(cached, args, CacheEvents<Stats>{Stats(counters)});
}

template struct ShadowCacheKernel<kKernelIsa, NoStats>;
template struct ShadowCacheKernel<kKernelIsa, CountStats>;

}  // namespace raymeter
