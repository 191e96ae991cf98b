#pragma once

#include <optional>
#include <string>

#include "accel/registry.h"
#include "core/render/whitted.h"

namespace raymeter {

/// The scale of a heat map.
struct HeatScale {
  std::string event;
  std::uint64_t most = 0;  ///< of all pixels
  double mean = 0;
};

/// What `raymeter image --stats` tells of one image.
struct ImageStats {
  std::string scene;
  std::int32_t num_prims = 0;
  TechniqueSpec technique;
  CameraModel model;
  Termination termination;
  Isa isa = Isa::scalar;
  int packet = 1;
  int threads = 1;
  RayCounts rays;
  DepthCounts depth;
  FrameTotals totals;
  std::string choice;  ///< what the structure settled on by looking at the rays, see choices()
  std::optional<HeatScale> heatmap;
};

[[nodiscard]] std::string image_stats_json(const ImageStats& stats);

}  // namespace raymeter
