#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "accel/params.h"
#include "core/bounds/aabb_volume.h"
#include "core/bounds/kdop_volume.h"
#include "core/bounds/obb_volume.h"
#include "core/bounds/sphere_volume.h"

namespace raymeter {

/// How bounding volumes are fitted.
struct VolumeParams {
  bool tight = false;
  std::string axes = "best";
  int k = 14;
  std::string directions;
};

/// The rows of these parameters.
template <class Params>
[[nodiscard]] std::vector<Param<Params>> volume_fields() {
  using Field = Param<Params>;
  return {
      where<Params>([](const Params& p) { return p.volume == "sphere"; },
                    Field{"tight", &Params::tight, "sphere: nearly the smallest one, instead of one about the box's centre"}),
      where<Params>([](const Params& p) { return p.volume == "obb"; },
                    Field{"axes",
                          &Params::axes,
                          "obb: of the composite object's own space, the principal components, or those of least area",
                          0,
                          0,
                          {"best", "pca", "object"}}),
      where<Params>([](const Params& p) { return p.volume == "kdop" && p.directions.empty(); },
                    Field{"k", &Params::k, "kdop without directions: planes; 6, 8, 12, 14, 18, 20 or 26", 6, 26}),
      where<Params>([](const Params& p) { return p.volume == "kdop"; },
                    Field{"directions", &Params::directions, "kdop: own directions instead, as in 1 0 0/0 1 0/0 0.6 0.8"}),
  };
}

/// THE table of volumes: calls visit(volume) with the one of this name. Throws Error where the parameters make none.
template <class Visit>
auto with_volume(std::string_view name, const VolumeParams& params, const Scene& scene, Visit&& visit) {
  if (name == "sphere") return visit(SphereVolume{params.tight});
  if (name == "obb") return visit(ObbVolume{params.axes == "object" ? ObbAxes::object : params.axes == "pca" ? ObbAxes::pca : ObbAxes::best});
  if (name == "kdop") return visit(params.directions.empty() ? KdopVolume(scene, params.k) : KdopVolume(scene, params.directions));
  return visit(AabbVolume{});
}

/// Throws Error where the parameters name no volume, before any scene is known.
inline void check_volume(std::string_view name, const VolumeParams& params) {
  with_volume(name, params, Scene(), [](const auto&) {});
}

}  // namespace raymeter
