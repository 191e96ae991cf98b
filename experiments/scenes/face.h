#pragma once

#include <span>

#include <glm/vec3.hpp>

#include "core/scene/scene.h"

namespace raymeter {

/// Adds a mesh's face of at least 3 vertices; `normals` has one for each vertex or is empty. A face of more than 3 becomes one polygon where it is planar and
/// loses no shading by that, otherwise a fan of triangles about its first vertex. Concave faces are always polygons, since a fan would cover what is outside.
void add_face(Scene& scene, std::span<const glm::dvec3> vertices, std::span<const glm::dvec3> normals);

}  // namespace raymeter
