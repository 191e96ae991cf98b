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

/// What the list answers.
struct Listed {
  HitBatch hits;
  Blockers blockers;
};

/// The reference: the list, by packets of 16. Packets of other sizes and counting kernels are held against it like any other structure's.
[[nodiscard]] Listed trace_list(const Scene& scene, Isa isa, const RayBatch& rays);

/// A scene's rays, hard, coherent and cut at the hits that the list finds.
[[nodiscard]] RayBatch reference_rays(const Scene& scene, Isa isa);

/// These rays, and what the list finds.
struct Reference {
  RayBatch rays;
  Listed list;

  Reference(const Scene& scene, Isa isa) : rays(reference_rays(scene, isa)), list(trace_list(scene, isa, rays)) {}
};

/// Every structure with default parameters, and the settings whose kernels or volumes are others: as texts for parse_technique.
[[nodiscard]] std::vector<std::string> all_traversals();
/// The same as the name of a test.
[[nodiscard]] std::string test_name(std::string_view technique);

/// Expects equal bits; shows the first rays that differ.
void expect_same_hits(const HitBatch& hits, const HitBatch& expected, const RayBatch& rays);

}  // namespace raymeter::test
