#pragma once

#include <array>
#include <string>

#include "core/scene/scene.h"

namespace raymeter {

/// What a scene has of all that a tracer can model; the renderer leaves out the rest.
struct SceneNeeds {
  std::array<bool, kPrimKindCount> prims{};  ///< by PrimKind
  bool vertex_normals = false;
  bool reflection = false;
  bool refraction = false;
  bool lights = false;

  /// A hit matters beside that there is one: something lights it, or it sends rays on.
  [[nodiscard]] bool shading() const noexcept { return lights || reflection || refraction; }
  /// Some surface may lie in another's shadow.
  [[nodiscard]] bool shadows() const noexcept { return lights && prims != std::array<bool, kPrimKindCount>{}; }
  /// The names of what there is, separated by spaces: "sphere polygon reflection lights shadows".
  [[nodiscard]] std::string text() const;
  friend bool operator==(const SceneNeeds&, const SceneNeeds&) = default;
};

[[nodiscard]] SceneNeeds needs_of(const Scene& scene);
/// Everything: what a tracer that knows nothing of the scene has to be ready for.
[[nodiscard]] SceneNeeds all_needs() noexcept;

}  // namespace raymeter
