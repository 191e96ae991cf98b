#pragma once

#include <vector>

#include "accel/slots.h"

namespace raymeter {

struct ShadowCacheParams {
  std::string key = "light_object";
  std::string update = "batch";
  int batch = 512;
  bool forget = false;

  static auto fields() {
    using Field = Param<ShadowCacheParams>;
    constexpr ParamUse kQuery = ParamUse::query;
    return std::vector<Field>{
        {"key",
         &ShadowCacheParams::key,
         "what has an entry of its own: each light; each light and object that is lit; each light and position in the ray tree",
         0,
         0,
         {"light", "light_object", "light_tree"},
         kQuery},
        {"update",
         &ShadowCacheParams::update,
         "serial: after each ray, on one thread, as in 1987; batch: after so many rays that are traced together",
         0,
         0,
         {"serial", "batch"},
         kQuery},
        where<ShadowCacheParams>([](const ShadowCacheParams& p) { return p.update == "batch"; },
                                 {"batch",
                                  &ShadowCacheParams::batch,
                                  "rays of a batch, in images within a tile of 4096 pixels: fewer learn sooner, more share packets and threads",
                                  1,
                                  1 << 20,
                                  {},
                                  kQuery}),
        {"forget", &ShadowCacheParams::forget, "a ray that nothing blocks empties its entry", 0, 0, {}, kQuery}};
  }
};

[[nodiscard]] std::unique_ptr<Occlusion> make_shadow_cache(const Scene& scene, const SlotOptions& options, Intersector& intersector);

inline constexpr OcclusionEntry kShadowCacheEntry{"shadow_cache",
                                                  "what blocked the last ray from there is tested first",
                                                  "Haines, Greenberg 1986, IEEE CG&A 6(9); Haines 1987, IEEE CG&A 7(11)",
                                                  param_infos<ShadowCacheParams>,
                                                  resolve_params<ShadowCacheParams>,
                                                  make_shadow_cache};

}  // namespace raymeter
