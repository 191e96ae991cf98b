#pragma once

#include <array>

#include "accel/technique.h"

namespace raymeter {

struct RayClassificationParams {
  int leaf_size = 8;
  std::string split = "widest";
  int max_depth = 40;
  int position_bits = 10;
  int direction_bits = 10;
  int min_rays = 16;
  bool beams = false;
  int most_candidates = 0;
  double memory_mb = 256;

  static auto fields() {
    using Field = Param<RayClassificationParams>;
    return std::array{
        Field{"leaf_size", &RayClassificationParams::leaf_size, "a cell of so many candidates is not split", 1, 4096, {}, ParamUse::query},
        Field{"split", &RayClassificationParams::split, "the axis to split on: where cells spread the beam most, or each in turn", 0, 0, {"widest", "cycle"}},
        Field{"max_depth", &RayClassificationParams::max_depth, "splits, each into halves, from one of the six directions to a cell, at most", 0, 56},
        Field{"position_bits", &RayClassificationParams::position_bits, "splits of each axis of the rays' origins, at most", 0, 12},
        Field{"direction_bits", &RayClassificationParams::direction_bits, "splits of each axis of the rays' directions, at most", 0, 12},
        Field{"min_rays", &RayClassificationParams::min_rays, "a cell with fewer rays of a batch is not split for it", 1, 1 << 20, {}, ParamUse::query},
        Field{"beams",
              &RayClassificationParams::beams,
              "packets test of long lists only what their own beams meet, which are thinner than cells",
              0,
              0,
              {},
              ParamUse::query},
        Field{"most_candidates",
              &RayClassificationParams::most_candidates,
              "candidates of a cell that its rays are tested against, those that begin first; 0: all; fewer: hits on the others are lost",
              0,
              1 << 20,
              {},
              ParamUse::query},
        Field{"memory_mb", &RayClassificationParams::memory_mb, "megabytes (2^20) for the cells of one set of queries", 1.0 / 16, 1 << 20, {}, ParamUse::query},
    };
  }
};

[[nodiscard]] std::unique_ptr<Structure> build_ray_classification(const Scene& scene, const ParamValues& values, int threads);

inline constexpr StructureEntry kRayClassificationEntry{"ray_classification",
                                                        "5D subdivision of rays: cells of origins and directions list what their rays can meet",
                                                        "Arvo, Kirk 1987",
                                                        param_infos<RayClassificationParams>,
                                                        resolve_params<RayClassificationParams>,
                                                        build_ray_classification};

}  // namespace raymeter
