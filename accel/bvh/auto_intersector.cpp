#include "accel/bvh/auto_intersector.h"

#include <algorithm>

#include "accel/bvh/coherence.h"
#include "core/trace/slices.h"

namespace raymeter {

namespace {

/// Beams pay where neighbours are within 4 milliradians of their mean direction: eye rays at 1024 x 1024 do, at 256 x 256 streams are faster.
constexpr double kCoherent = 1 - 1e-5;
constexpr int kSamples = 4;
/// Smaller packets have beams of too few rays.
constexpr int kLeastPacket = 16;

}  // namespace

bool AutoIntersector::suits_beams(const RayView& slice) const noexcept { return packet_ >= kLeastPacket && coherence(slice, kSamples) >= kCoherent; }

void AutoIntersector::prepare(const RayView& rays, Query query, int) {
  int found = none;
  for (std::int32_t first = 0; first < rays.count; first += kSliceRays) {
    RayView slice = rays;
    for (int a = 0; a < 3; ++a) {
      slice.org[a] += first;
      slice.dir[a] += first;
    }
    slice.t_min += first;
    slice.t_max += first;
    slice.count = std::min(kSliceRays, rays.count - first);
    found |= query == Query::closest && suits_beams(slice) ? beam : stream;
  }
  choice_[static_cast<std::size_t>(query)] = found;
}

std::string AutoIntersector::choice(Query query) const {
  switch (choice_[static_cast<std::size_t>(query)]) {
    case beam: return "traversal=beam";
    case stream: return "traversal=stream";
    case both: return "traversal=beam|stream";
    default: return {};
  }
}

std::size_t AutoIntersector::scratch_bytes() const noexcept { return std::max(beams_->scratch_bytes(), streams_->scratch_bytes()); }

void AutoIntersector::closest_hit(const RayView& rays, const HitView& hits, Counters* counters, std::byte* scratch) const noexcept {
  suited(rays).closest_hit(rays, hits, counters, scratch);
}

void AutoIntersector::any_hit(const RayView& rays, std::int32_t* blocker, Counters* counters, std::byte* scratch) const noexcept {
  streams_->any_hit(rays, blocker, counters, scratch);
}

}  // namespace raymeter
