#pragma once

#include <initializer_list>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "core/scene/scene.h"

namespace raymeter {

// The Standard Procedural Databases: Haines, "A Proposal for Standard Graphics Environments", IEEE CG&A 7(11), 1987; release 3.14.
// Each function makes one of them at the given size; primitives come in the order of the original programs' output. All arithmetic is in double.

[[nodiscard]] Scene make_balls(int size);
[[nodiscard]] Scene make_gears(int size);
/// The same with the outlines split into triangles, as some programs read polygons.
[[nodiscard]] Scene make_split_gears(int size);
[[nodiscard]] Scene make_ear_gears(int size);
[[nodiscard]] Scene make_rim_gears(int size);
[[nodiscard]] Scene make_mount(int size);
[[nodiscard]] Scene make_rings(int size);
[[nodiscard]] Scene make_teapot(int size);
[[nodiscard]] Scene make_tetra(int size);
[[nodiscard]] Scene make_tree(int size);
[[nodiscard]] Scene make_lattice(int size);
[[nodiscard]] Scene make_shells(int size);
[[nodiscard]] Scene make_jacks(int size);
[[nodiscard]] Scene make_sombrero(int size);

// ---- What they share.

/// The cosine power of an SPD material without highlight.
inline constexpr double kNoHighlight = 100000;

/// The Phong cosine power whose highlight falls to one half at this angle.
[[nodiscard]] double phong_power(double half_angle_degrees) noexcept;

/// An empty scene with the SPD's usual background (a sky blue), resolution and field of view, seen from `eye`; lights without a colour of their own.
[[nodiscard]] Scene spd_scene(const glm::dvec3& eye, const glm::dvec3& look_at, const glm::dvec3& up, double hither, std::initializer_list<glm::dvec3> lights);

/// Counterclockwise about `axis` as seen from its tip.
[[nodiscard]] glm::dmat3 rotation(double radians, const glm::dvec3& axis);

}  // namespace raymeter
