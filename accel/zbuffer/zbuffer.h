#pragma once

#include <memory>
#include <vector>

#include "accel/slots.h"

namespace raymeter {

struct ZbufferParams {
  std::string mode = "list";
  double resolution = 1;

  static auto fields() {
    using Field = Param<ZbufferParams>;
    return std::vector<Field>{
        Field{"mode",
              &ZbufferParams::mode,
              "list: each eye ray tests the primitives that may cover its sample, exact; seed: a z-buffer's primitive ends its traversal early, exact; "
              "final: the z-buffer's primitive is the answer, not exact",
              0,
              0,
              {"list", "seed", "final"}},
        where<ZbufferParams>([](const ZbufferParams& p) { return p.mode != "list"; },
                             Field{"resolution", &ZbufferParams::resolution, "the z-buffer's samples for each of the image's, along an axis", 0.25, 8}),
    };
  }
};

[[nodiscard]] std::unique_ptr<FirstHit> make_zbuffer(const Scene& scene, const SlotOptions& options, Intersector& intersector);

inline constexpr FirstHitEntry kZbufferEntry{
    "zbuffer",
    "eye rays start from a rasterised image of the scene: lists of candidates, a nearest primitive to begin with, or the answer itself",
    "Weghorst, Hooper, Greenberg 1984, ACM TOG 3(1)",
    param_infos<ZbufferParams>,
    resolve_params<ZbufferParams>,
    make_zbuffer};

}  // namespace raymeter
