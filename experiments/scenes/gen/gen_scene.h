#pragma once

#include <glm/vec3.hpp>

#include "core/scene/scene.h"

namespace raymeter {

// Scenes of our own, each made to stress one thing; generators.cpp says what `size` is and what it may be. Random ones are the same on every machine.

[[nodiscard]] Scene make_hairball(int strands);
[[nodiscard]] Scene make_stadium(int teapot_divisions);
[[nodiscard]] Scene make_terrain(int triangles);
[[nodiscard]] Scene make_cloud(int triangles);
[[nodiscard]] Scene make_spheres(int spheres);
[[nodiscard]] Scene make_icosphere(int subdivisions);

// ---- What they share.

/// An empty scene under a pale sky with one white light.
[[nodiscard]] Scene gen_scene(const glm::dvec3& eye, const glm::dvec3& look_at, const glm::dvec3& up, double fov_degrees, const glm::dvec3& light);

}  // namespace raymeter
