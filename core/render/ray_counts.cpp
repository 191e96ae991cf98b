#include "core/render/ray_counts.h"

namespace raymeter {

void RayCounts::add(const RayCounts& other) noexcept {
  primary += other.primary;
  primary_hit += other.primary_hit;
  reflection += other.reflection;
  reflection_hit += other.reflection_hit;
  refraction += other.refraction;
  refraction_hit += other.refraction_hit;
  tir += other.tir;
  shadow += other.shadow;
  shadow_blocked += other.shadow_blocked;
}

void DepthCounts::add(const DepthCounts& other) {
  if (generation.size() < other.generation.size()) generation.resize(other.generation.size());
  for (std::size_t depth = 0; depth < other.generation.size(); ++depth) generation[depth] += other.generation[depth];
  deepest_sum += other.deepest_sum;
}

}  // namespace raymeter
