#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "accel/registry.h"
#include "core/ray/ray_batch.h"
#include "core/ray/shadow_origins.h"
#include "core/render/occlusion.h"
#include "tests/support/traces.h"

namespace raymeter::test {

/// The shadow cache with these parameters before an intersector.
inline std::unique_ptr<Occlusion> cache_of(const Scene& scene, std::string_view variant, const SlotOptions& options, Intersector& intersector) {
  const Chosen<OcclusionEntry> chosen = parse_technique("list+shadow_cache:" + std::string(variant)).occlusion;
  return chosen.entry->make(scene, {options.isa, options.packet, options.threads, chosen.params}, intersector);
}

struct Shadow {
  RayBatch rays;
  ShadowOrigins origins;
};

/// Answers shadow rays, and what that counted.
inline Counters find(Occlusion& occlusion, const Shadow& shadow, int threads, Blockers& blockers) {
  Counters counters;
  occlusion.find(shadow.rays, shadow.origins, blockers, threads, &counters);
  return counters;
}

}  // namespace raymeter::test
