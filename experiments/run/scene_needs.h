#pragma once

#include <string>

#include "core/scene/scene.h"

namespace raymeter {

/// What a renderer of the scene must be able to do: its kinds of primitives, "reflection", "refraction", "lights", separated by spaces.
[[nodiscard]] std::string scene_needs(const Scene& scene);

}  // namespace raymeter
