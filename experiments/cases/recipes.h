#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include <glm/vec3.hpp>

#include "experiments/cases/hard_case.h"
#include "experiments/cases/random.h"

namespace raymeter::cases {

// The recipes; hard_cases.cpp says what each is about.

// ---- Boxes, planes and intervals: box_cases.cpp
[[nodiscard]] Problem axis_rays(int count, std::uint64_t seed);
[[nodiscard]] Problem beside_box(int count, std::uint64_t seed);
[[nodiscard]] Problem flat_plane(int count, std::uint64_t seed);
[[nodiscard]] Problem negative_zero(int count, std::uint64_t seed);
[[nodiscard]] Problem interval_ends(int count, std::uint64_t seed);
[[nodiscard]] Problem start_on_surface(int count, std::uint64_t seed);
[[nodiscard]] Problem lattice(int count, std::uint64_t seed);
[[nodiscard]] Problem occluder(int count, std::uint64_t seed);
[[nodiscard]] Problem far_behind(int count, std::uint64_t seed);
[[nodiscard]] Problem denormal_directions(int count, std::uint64_t seed);
[[nodiscard]] Problem invalid_rays(int count, std::uint64_t seed);
template <int kOffset, bool kTurned = false>
[[nodiscard]] Problem box_edges(int count, std::uint64_t seed);

// ---- Long ways through cells: cell_cases.cpp
[[nodiscard]] Problem cells_across(int count, std::uint64_t seed);
[[nodiscard]] Problem cell_corners(int count, std::uint64_t seed);
[[nodiscard]] Problem cell_rows(int count, std::uint64_t seed);

// ---- Triangles and polygons: facet_cases.cpp
[[nodiscard]] Problem ties(int count, std::uint64_t seed);
[[nodiscard]] Problem coplanar(int count, std::uint64_t seed);
[[nodiscard]] Problem tilted_plane(int count, std::uint64_t seed);
[[nodiscard]] Problem coincident_triangles(int count, std::uint64_t seed);
[[nodiscard]] Problem degenerate(int count, std::uint64_t seed);
[[nodiscard]] Problem slivers(int count, std::uint64_t seed);
[[nodiscard]] Problem extreme_directions(int count, std::uint64_t seed);
[[nodiscard]] Problem garbage(int count, std::uint64_t seed);
[[nodiscard]] Problem spawned(int count, std::uint64_t seed);
[[nodiscard]] Problem contacts(int count, std::uint64_t seed);
[[nodiscard]] Problem shadow_ends(int count, std::uint64_t seed);

// ---- Closed meshes: mesh_cases.cpp. Of 20 4^kLevel triangles, scaled by 2^kExponent.
template <int kExponent, int kLevel = 5>
[[nodiscard]] Problem closed_mesh(int count, std::uint64_t seed);
[[nodiscard]] Problem closed_mesh_far(int count, std::uint64_t seed);
[[nodiscard]] Problem closed_polygons(int count, std::uint64_t seed);
[[nodiscard]] Problem scaled_directions(int count, std::uint64_t seed);
[[nodiscard]] Problem height_field(int count, std::uint64_t seed);
template <int kSize>
[[nodiscard]] Problem mixed_scales(int count, std::uint64_t seed);

// ---- Spheres and cones: round_cases.cpp. kDistance, kRadius: powers of ten.
[[nodiscard]] Problem coincident_spheres(int count, std::uint64_t seed);
[[nodiscard]] Problem concentric(int count, std::uint64_t seed);
template <int kDistance>
[[nodiscard]] Problem far_sphere(int count, std::uint64_t seed);
template <int kRadius>
[[nodiscard]] Problem ground_sphere(int count, std::uint64_t seed);
[[nodiscard]] Problem tangents(int count, std::uint64_t seed);
[[nodiscard]] Problem sphere_ends(int count, std::uint64_t seed);
[[nodiscard]] Problem nested_spheres(int count, std::uint64_t seed);
[[nodiscard]] Problem cones(int count, std::uint64_t seed);

// ---- What they share.
inline constexpr float kInf = std::numeric_limits<float>::infinity();
inline constexpr double kUnknownT = std::numeric_limits<double>::quiet_NaN();

/// Rounded to floats; from 0 to infinity.
[[nodiscard]] Ray ray(const glm::dvec3& org, const glm::dvec3& dir, float t_min = 0, float t_max = kInf);
/// Adds a ray and what it is to meet.
void add(Problem& problem, const Ray& ray, std::int32_t prim, double t = kUnknownT);
/// Ends a problem: finishes its scene, and finds by exact arithmetic what rays meet of which nothing has been said. With many primitives that takes long.
[[nodiscard]] Problem solved(Problem problem);
[[nodiscard]] Problem finished(Problem problem);
/// Adds a rectangle of two triangles, from `at` along x and y: the first holds x, the second y.
void add_rectangle(Scene& scene, const glm::dvec3& at, const glm::dvec3& x, const glm::dvec3& y);
/// Adds an axis-parallel box of 12 triangles: faces in the order -x, +x, -y, +y, -z, +z, two triangles each.
void add_box(Scene& scene, const glm::dvec3& low, const glm::dvec3& high);
/// The corners of a box; bit a of the number is set where the corner is high along the box's axis a.
using Corners = std::array<glm::dvec3, 8>;
/// `low` and, of each axis, `low` and the axis.
[[nodiscard]] Corners corners_at(const glm::dvec3& low, const std::array<glm::dvec3, 3>& axes);
/// The same triangles for any axes.
void add_box(Scene& scene, const Corners& corners);

}  // namespace raymeter::cases
