#include "accel/bvh/auto_intersector.h"

#include <algorithm>

namespace raymeter {

namespace {

// Where the traversals overtake each other, on every scene that was measured (DESIGN, decision 20).

/// Fewer rays than these go alone; so do those of packets that make smaller groups of a stream.
constexpr int kLeastRays = 4;
/// Streams gain by rays of the same octant; of batches that have fewer in each, rays go alone.
constexpr int kLeastOfOctant = 8;
/// Beams of fewer rays, or of less than a register, lose to streams.
constexpr int kLeastBeam = 8;
/// Beams lose to streams where they meet this many times as many leaves as one of their rays, by query: rays that any hit ends part sooner.
constexpr double kMostLeaves[2] = {3, 1.1};
/// Nearest hits: beams may meet more leaves where they share their way down, in whole groups no wider than this share of the scene.
constexpr double kMostLeavesOfSlim = 5;
constexpr double kSlimGroupWidth = 0.04;

/// Whether the rays are too few to make groups of one octant.
bool is_sparse(const RayView& rays) noexcept {
  if (rays.count >= 8 * kLeastOfOctant) return false;
  unsigned octants = 0;
  for (std::int32_t i = 0; i < rays.count; ++i) {
    unsigned octant = 0;
    for (int a = 0; a < 3; ++a) octant |= static_cast<unsigned>(__builtin_signbit(rays.dir[a][i]) != 0) << a;
    octants |= 1u << octant;
  }
  return rays.count < kLeastOfOctant * __builtin_popcount(octants);
}

}  // namespace

AutoIntersector::AutoIntersector(Traversals traversals, int packet, int simd_width, int group, const LeafSizes& leaves, const float (&box)[6])
    : traversals_(std::move(traversals)),
      packet_(packet),
      least_beam_(std::max(kLeastBeam, simd_width)),
      whole_groups_(group == kMaxGroupRays),
      leaves_(leaves),
      box_(std::to_array(box)) {}

AutoIntersector::Choice AutoIntersector::chosen_for(const RayView& slice, Query query) const noexcept {
  if (packet_ < kLeastRays || slice.count < kLeastRays) return single;
  if (packet_ >= least_beam_ && suits_beams(slice, query)) return beam;
  return is_sparse(slice) ? single : stream;
}

bool AutoIntersector::suits_beams(const RayView& slice, Query query) const noexcept {
  const double leaves = leaves_per_ray(slice, box_.data(), leaves_);
  if (leaves < kMostLeaves[static_cast<int>(query)]) return true;
  return whole_groups_ && query == Query::closest && leaves < kMostLeavesOfSlim && group_width(slice, box_.data()) < kSlimGroupWidth;
}

const Intersector& AutoIntersector::of(Choice choice) const noexcept {
  return choice == single ? *traversals_.singles : choice == beam ? *traversals_.beams : *traversals_.streams;
}

const Intersector& AutoIntersector::take(const RayView& slice, Query query) const noexcept {
  const Choice choice = chosen_for(slice, query);
  std::atomic<unsigned>& chosen = chosen_[static_cast<std::size_t>(query)];
  if ((chosen.load(std::memory_order_relaxed) & choice) == 0) chosen.fetch_or(choice, std::memory_order_relaxed);
  return of(choice);
}

std::string AutoIntersector::choice(Query query) const {
  const unsigned chosen = chosen_[static_cast<std::size_t>(query)];
  std::string text;
  const auto add = [&](Choice one, const char* name) {
    if ((chosen & one) != 0) text.append(text.empty() ? "traversal=" : "|").append(name);
  };
  add(single, "single");
  add(beam, "beam");
  add(stream, "stream");
  return text;
}

std::size_t AutoIntersector::scratch_bytes() const noexcept {
  return std::max({traversals_.beams->scratch_bytes(), traversals_.streams->scratch_bytes(), traversals_.singles->scratch_bytes()});
}

void AutoIntersector::closest_hit(const RayView& rays, const HitView& hits, Counters* counters, std::byte* scratch) const noexcept {
  take(rays, Query::closest).closest_hit(rays, hits, counters, scratch);
}

void AutoIntersector::any_hit(const RayView& rays, std::int32_t* blocker, Counters* counters, std::byte* scratch) const noexcept {
  take(rays, Query::any).any_hit(rays, blocker, counters, scratch);
}

}  // namespace raymeter
