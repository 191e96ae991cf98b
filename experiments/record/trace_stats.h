#pragma once

#include <string>

#include "accel/registry.h"
#include "core/stats/counters.h"

namespace raymeter {

/// What `raymeter trace --stats` tells of one batch.
struct TraceStats {
  std::string scene;
  std::int32_t num_prims = 0;
  TechniqueSpec technique;
  std::string choice;  ///< what the structure settled on by looking at the rays, see Intersector
  std::string query;
  Isa isa = Isa::scalar;
  int packet = 1;
  int threads = 1;
  std::size_t rays = 0;
  std::size_t hits = 0;
  double build_ms = 0;
  double trace_ms = 0;
  BuildStats build;
  Counters counters;
};

[[nodiscard]] std::string trace_stats_json(const TraceStats& stats);

}  // namespace raymeter
