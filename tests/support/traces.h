#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "accel/registry.h"
#include "core/trace/trace.h"

namespace raymeter::test {

using Blockers = Column<std::int32_t>;

/// The hard scenes, made once.
[[nodiscard]] const std::vector<Scene>& scenes();
[[nodiscard]] const Scene& scene_named(std::string_view name);

struct Traced {
  HitBatch hits;
  Blockers blockers;
  Counters closest, any;
};

/// Both queries, by timed and by counting kernels; expects the two to agree.
[[nodiscard]] Traced trace(const Structure& structure, const QueryOptions& options, const RayBatch& rays, int threads = 1);

/// The reference: the list, one ray at a time.
[[nodiscard]] Traced trace_list(const Scene& scene, Isa isa, const RayBatch& rays);

/// A scene's rays, hard, coherent and cut at their hits, and what the list finds.
struct Reference {
  RayBatch rays;
  Traced list;

  Reference(const Scene& scene, Isa isa);
};

/// Every structure with default parameters, and the settings whose kernels or volumes are others: as texts for parse_technique.
[[nodiscard]] std::vector<std::string> all_traversals();
/// The same as the name of a test.
[[nodiscard]] std::string test_name(std::string_view technique);

/// Expects equal bits; shows the first rays that differ.
void expect_same_hits(const HitBatch& hits, const HitBatch& expected, const RayBatch& rays);

}  // namespace raymeter::test
