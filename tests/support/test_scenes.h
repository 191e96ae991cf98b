#pragma once

#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace raymeter::test {

/// A closed sphere of 20 * 4^level triangles.
[[nodiscard]] Scene icosphere(int level, double radius = 1, const glm::dvec3& center = glm::dvec3(0.0));

/// Small scenes that are hard for structures and kernels, named; the generators' smallest among them.
[[nodiscard]] std::vector<Scene> hard_scenes();

}  // namespace raymeter::test
