#pragma once

#include <array>
#include <string>

#include "accel/technique.h"

namespace raymeter {

struct EmbreeParams {
  std::string mode = "best";
  std::string coherence = "coherent";
  bool robust = false;
  std::string quality = "medium";
  std::string layout = "slice";

  static auto fields() {
    using Field = Param<EmbreeParams>;
    return std::array{
        Field{"mode",
              &EmbreeParams::mode,
              "how rays are handed over; best measures all modes on the rays and takes the fastest",
              0,
              0,
              {"best", "single", "packet4", "packet8", "packet16", "stream", "stream_soa"},
              ParamUse::query},
        where<EmbreeParams>(
            [](const EmbreeParams& p) { return p.mode != "best"; },
            {"coherence", &EmbreeParams::coherence, "what Embree is told of the rays; best tries both", 0, 0, {"coherent", "incoherent"}, ParamUse::query}),
        Field{"robust", &EmbreeParams::robust, "watertight node and edge tests (its ROBUST scene flag, which ignores quality=high in version 3.13)"},
        Field{"quality", &EmbreeParams::quality, "medium: binned SAH; high: with spatial splits", 0, 0, {"medium", "high"}},
        Field{"layout",
              &EmbreeParams::layout,
              "when rays are brought into Embree's layout: slice by slice, or ahead of tracing, where it is prepare's time",
              0,
              0,
              {"slice", "ahead"},
              ParamUse::query},
    };
  }
};

/// Intel's Embree 3 on the scene's triangles, spheres and polygons, which it gets as triangles. Throws Error for the reasons that why_not_embree() gives.
[[nodiscard]] std::unique_ptr<Structure> build_embree(const Scene& scene, const ParamValues& values, int threads);
/// Cones and cylinders, an instruction set that it has no code for, or a build without it.
[[nodiscard]] std::string why_not_embree(const Scene& scene, Isa isa);

inline constexpr StructureEntry kEmbreeEntry{.name = "embree",
                                             .summary = "the peer: Intel's Embree 3, asked in the mode that suits the rays best",
                                             .source = "Wald, Woop, Benthin, Johnson, Ernst 2014",
                                             .params = param_infos<EmbreeParams>,
                                             .resolve = resolve_params<EmbreeParams>,
                                             .build = build_embree,
                                             .peer = true,
                                             .why_not = why_not_embree};

}  // namespace raymeter
