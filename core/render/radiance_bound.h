#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "core/scene/scene.h"

namespace raymeter {

/// The most radiance, by its absolute value in each channel, that a ray of a scene can carry: [r] where r generations are left, its own among them.
///
/// A ray sees the background or a surface. A surface gives back, of each light's colour, at most diffuse weight times colour, since no cosine exceeds 1, and
/// specular weight, since no power of one with an exponent from 0 does; and of what its reflection and refraction rays carry, who have one generation less, at
/// most the sum of both weights: on total internal reflection one ray carries both shares. So [r] = max(background, max over materials of what lights give +
/// (specular + transmittance) * [r - 1]), and [0] = 0. A negative exponent has no bound: infinite.
[[nodiscard]] std::vector<glm::dvec3> largest_radiance(const Scene& scene, int generations);

/// The most that a ray of that weight can bring to its pixel; nothing, where it has no weight.
[[nodiscard]] glm::dvec3 largest_share(const glm::vec3& weight, const glm::dvec3& radiance) noexcept;

/// How far a pixel of the value `sum` is at most from the one that has what was cut off. A ray's weight is rounded to float once a generation and so is what a
/// light brings, each of them by half a float's unit; a pixel is rounded once. Where what was cut off has no weight the pixel is the same bit for bit.
[[nodiscard]] glm::vec3 bound_of(const glm::dvec3& cut, const glm::dvec3& sum, int max_depth) noexcept;

}  // namespace raymeter
