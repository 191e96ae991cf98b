#pragma once

#include <glm/vec3.hpp>

#include "core/scene/scene.h"

namespace raymeter {

/// Adds the teapot as one object of 64 divisions^2 - 8 divisions triangles with vertex normals: each of the 32 patches is cut into divisions x divisions quads.
/// Points go to origin + scale * point; unscaled it is 3.15 high.
void add_teapot(Scene& scene, int divisions, double scale, const glm::dvec3& origin);

}  // namespace raymeter
