#include "core/scene/scene_needs.h"

#include <algorithm>

namespace raymeter {

std::string SceneNeeds::text() const {
  std::string names;
  const auto add = [&](bool needed, const char* what) {
    if (needed) names.append(names.empty() ? "" : " ").append(what);
  };
  constexpr std::array<const char*, kPrimKindCount> kKinds{"sphere", "triangle", "polygon", "cone"};
  for (std::size_t kind = 0; kind < kPrimKindCount; ++kind) add(prims[kind], kKinds[kind]);
  add(vertex_normals, "vertex_normals");
  add(reflection, "reflection");
  add(refraction, "refraction");
  add(lights, "lights");
  add(shadows(), "shadows");
  return names;
}

SceneNeeds needs_of(const Scene& scene) {
  SceneNeeds needs;
  for (std::size_t kind = 0; kind < kPrimKindCount; ++kind) needs.prims[kind] = scene.pools().size(static_cast<PrimKind>(kind)) > 0;
  needs.vertex_normals = !scene.pools().triangles.normal_index.empty();
  const auto any_material = [&](bool (Material::*has)() const noexcept) {
    const auto runs = scene.material_runs();
    return std::any_of(runs.begin(), runs.end(), [&](const Scene::MaterialRun& run) { return (run.material.*has)(); });
  };
  needs.reflection = any_material(&Material::reflects);
  needs.refraction = any_material(&Material::transmits);
  needs.lights = !scene.lights.empty();
  return needs;
}

SceneNeeds all_needs() noexcept {
  SceneNeeds needs{{}, true, true, true, true};
  needs.prims.fill(true);
  return needs;
}

}  // namespace raymeter
