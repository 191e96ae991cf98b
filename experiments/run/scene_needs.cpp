#include "experiments/run/scene_needs.h"

#include <algorithm>
#include <array>

namespace raymeter {

std::string scene_needs(const Scene& scene) {
  std::string needs;
  const auto add = [&](bool needed, const char* what) {
    if (needed) needs.append(needs.empty() ? "" : " ").append(what);
  };
  constexpr std::array<const char*, kPrimKindCount> kinds{"sphere", "triangle", "polygon", "cone"};
  for (std::size_t kind = 0; kind < kPrimKindCount; ++kind) add(scene.pools().size(static_cast<PrimKind>(kind)) > 0, kinds[kind]);
  const auto runs = scene.material_runs();
  add(std::any_of(runs.begin(), runs.end(), [](const Scene::MaterialRun& run) { return run.material.reflects(); }), "reflection");
  add(std::any_of(runs.begin(), runs.end(), [](const Scene::MaterialRun& run) { return run.material.transmits(); }), "refraction");
  add(!scene.lights.empty(), "lights");
  return needs;
}

}  // namespace raymeter
