#pragma once

#include <vector>

#include "accel/bvh/builders.h"
#include "accel/bvh/bvh_params.h"
#include "accel/technique.h"
#include "accel/volumes.h"

namespace raymeter {

/// `plane_bits` of nodes whose planes are floats.
inline constexpr int kFloatPlanes = 32;

struct BvhParams : SahParams, GoldsmithSalmonParams, SbvhParams, PlocParams, TreeParams, VolumeParams, TestParams {
  std::string volume = "aabb";
  std::string builder = "binned_sah";
  std::string traversal = "auto";
  int group = 256;
  int plane_bits = kFloatPlanes;
  std::string precision = "float";

  [[nodiscard]] static std::vector<Param<BvhParams>> fields();
  /// Whether the traversal needs the hierarchy of wide_tree.h.
  [[nodiscard]] bool is_wide() const noexcept { return traversal != "packet" && traversal != "heap"; }
};

/// As resolve_params; throws Error also where parameters contradict each other. traversal=auto becomes packet where the hierarchy of wide_tree.h cannot serve:
/// volumes other than boxes, nodes of another `width`, tests of packets alone.
[[nodiscard]] ParamValues resolve_bvh(const ParamValues& values);
[[nodiscard]] std::unique_ptr<Structure> build_bvh(const Scene& scene, const ParamValues& values, int threads);
/// Builds once more to look at the tree.
void add_bvh_quality(const Scene& scene, const ParamValues& values, int threads, BuildStats& stats);

inline constexpr StructureEntry kBvhEntry{"bvh",
                                          "bounding volume hierarchy: volume x builder x traversal",
                                          "Rubin, Whitted 1980; Goldsmith, Salmon 1987; Wald 2007 (binned SAH)",
                                          param_infos<BvhParams>,
                                          resolve_bvh,
                                          build_bvh,
                                          add_bvh_quality};

}  // namespace raymeter
