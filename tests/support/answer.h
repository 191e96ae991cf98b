#pragma once

#include <string_view>

#include "accel/registry.h"
#include "core/trace/trace.h"

namespace raymeter::test {

/// What a technique found, and the counts of the closest hits.
struct Answer {
  HitBatch hits;
  Column<std::int32_t> blocker;
  Counters closest;
};

inline Answer answer(const Scene& scene, const RayBatch& rays, std::string_view technique, Isa isa, int packet) {
  const TechniqueSpec spec = parse_technique(technique);
  const auto structure = spec.structure->build(scene, spec.params, 2);
  const auto intersector = structure->intersector({isa, packet, spec.params});
  Answer out;
  trace_closest(*intersector, rays, out.hits, 2, &out.closest);
  trace_any(*intersector, rays, out.blocker, 2);
  return out;
}

}  // namespace raymeter::test
