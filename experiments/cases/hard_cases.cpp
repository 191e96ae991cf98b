#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "accel/params.h"
#include "core/base/error.h"
#include "experiments/cases/recipes.h"

namespace raymeter {

namespace {

using namespace cases;

constexpr double kTriangleUlps = 8;                                // what triangles' t may be off in the interiors of meshes
constexpr double kOpen = std::numeric_limits<double>::infinity();  // near silhouettes t means little

constexpr std::array kCases{
    // Planes of boxes, cells and splits; ends of intervals
    HardCase{"axis_rays", "along the axes at a box: in its faces, edges and corners, with zeros of either sign", axis_rays},
    HardCase{"beside_box", "along the axes, one rounding outside of a box's faces", beside_box},
    HardCase{"flat_plane", "a scene without height, met across and in its own plane", flat_plane},
    HardCase{"negative_zero", "directions with zeros of either sign, at two triangles", negative_zero},
    HardCase{"interval_ends", "t_min and t_max at a hit, and one rounding beside it; negative t", interval_ends},
    HardCase{"start_on_surface", "origins on faces, edges and corners of a box, in all 26 directions", start_on_surface},
    HardCase{"lattice", "squares and triangles that touch planes of cells; rays along the planes, edges and diagonals of cells", lattice},
    HardCase{"occluder", "one triangle in all cells, small ones before and behind it", occluder},
    HardCase{"far_behind", "a unit box behind origins 2^10 to 2^120 away: t_min = -infinity, and no t that is no float", far_behind, 1},
    HardCase{"denormal_directions", "boxes of 2^-25, directions below 2^-126 along all axes", denormal_directions},
    HardCase{"invalid_rays", "rays with NaN, infinity, no direction or an empty interval between valid ones", invalid_rays},
    HardCase{"box_edges", "boxes, rays aimed at their edges", box_edges<0>},
    HardCase{"box_edges_far", "the same 100,000 away from the origin", box_edges<100000>},
    HardCase{"turned_box_edges", "boxes turned by 45 degrees or any way, rays aimed at their edges", box_edges<0, true>},
    HardCase{"turned_box_edges_far", "the same 100,000 away from the origin", box_edges<100000, true>},
    HardCase{"cells_across", "small triangles in a flat box, rays from anywhere in it to anywhere: long ways through cells", cells_across},
    HardCase{"cell_corners", "the same, along the diagonal of x and y, 2^-28 to 2^-18 beside corners of cells", cell_corners},
    HardCase{"cell_rows", "the same, 2^-14 to 2^-6 off an axis", cell_rows},
    // Triangles and polygons
    HardCase{"ties", "diagonals and the middle of a fan: the smallest id of those that tie", ties},
    HardCase{"coplanar", "polygons and triangles that overlap in one plane: the smallest id, without speckle", coplanar},
    HardCase{"tilted_plane", "rays in planes of triangles and polygons and along sides of cones: misses, or hits within the declared errors", tilted_plane},
    HardCase{"coincident_triangles", "20,000 triangles in one place", coincident_triangles},
    HardCase{"degenerate", "triangles without area, a nearly collinear one of pbrt's among them: nothing to hit", degenerate},
    HardCase{"slivers", "triangles of 2^-20 to 2^-40 of their length", slivers},
    HardCase{"extreme_directions", "directions from 2^-149 to 2^126: t = 1 / d where that is a float", extreme_directions, 1},
    HardCase{"garbage", "random bits as coordinates and rays", garbage},
    HardCase{"spawned", "rays that leave triangles with coordinates from 1e-8 to 1e8: none meets its own triangle", spawned},
    HardCase{"contacts", "from one triangle to the next across gaps of 1 to 2048 roundings", contacts},
    HardCase{"shadow_ends", "lights in a surface, and beside the floor that they light: neither end blocks", shadow_ends},
    // Closed meshes
    HardCase{"closed_mesh", "20,480 triangles from inside, at vertices, edges and faces: no hole", closed_mesh<0>, kTriangleUlps},
    HardCase{"closed_mesh_tiny", "the same, 2^-40 in size", closed_mesh<-40>, kTriangleUlps},
    HardCase{"closed_mesh_tinier", "the same, 2^-50 in size", closed_mesh<-50>, kTriangleUlps},
    HardCase{"closed_mesh_large", "the same, 2^33 in size", closed_mesh<33>, kTriangleUlps},
    HardCase{"closed_mesh_larger", "the same, 2^50 in size", closed_mesh<50>, kTriangleUlps},
    HardCase{"closed_mesh_largest", "the same, 2^59 in size: coordinates up to 2^60 are supported", closed_mesh<59>, kTriangleUlps},
    HardCase{"closed_mesh_tiniest", "1,280 triangles, 2^-60 in size: at 2^-61 they would be lost", closed_mesh<-60, 3>, kTriangleUlps},
    HardCase{"closed_mesh_far", "1,280 triangles far from the origin, on a lattice of 1/64", closed_mesh_far},
    HardCase{"closed_polygons", "a solid of concave polygons and triangles, at its vertices and edges", closed_polygons},
    HardCase{"scaled_directions", "a closed mesh, directions scaled by 2^-60 to 2^60", scaled_directions, kTriangleUlps},
    HardCase{"height_field", "whole heights, vertical rays at corners and middles, borders included: t exact", height_field},
    HardCase{"mixed_scales", "a ball of 1,280 triangles and radius 1 in a box of 20,000", mixed_scales<10000>},
    HardCase{"mixed_scales_more", "the same in a box of 2,000,000", mixed_scales<1000000>},
    // Spheres and cones
    HardCase{"coincident_spheres", "20,000 spheres in one place", coincident_spheres},
    HardCase{"concentric", "cubes and spheres about one point", concentric, 1},
    HardCase{"far_sphere_1e1", "a unit sphere from 10 away, rays about its silhouette", far_sphere<1>, kOpen},
    HardCase{"far_sphere_1e2", "the same from 100", far_sphere<2>, kOpen},
    HardCase{"far_sphere_1e3", "the same from 1,000", far_sphere<3>, kOpen},
    HardCase{"far_sphere_1e4", "the same from 10,000", far_sphere<4>, kOpen},
    HardCase{"far_sphere_1e5", "the same from 100,000", far_sphere<5>, kOpen},
    HardCase{"far_sphere_1e6", "the same from 1,000,000", far_sphere<6>, kOpen},
    HardCase{"ground_sphere_1e3", "1 above a sphere of radius 1,000", ground_sphere<3>, 2e-5 * 0x1p24},
    HardCase{"ground_sphere_1e5", "1 above a sphere of radius 100,000", ground_sphere<5>, 2e-5 * 0x1p24},
    HardCase{"ground_sphere_1e7", "1 above a sphere of radius 10,000,000", ground_sphere<7>, 2e-5 * 0x1p24},
    HardCase{"tangents", "a sphere met within 64 roundings of its silhouette", tangents, 0},
    HardCase{"sphere_ends", "from a sphere's centre and surface; radius 0, 1e-20 and 2^60", sphere_ends, 1},
    HardCase{"nested_spheres", "64 spheres 2^-20 apart, one after another", nested_spheres, 1},
    HardCase{"cones", "at rims, apexes and along the sides of cones", cones},
};

constexpr std::string_view kPrefix = "hard:";

}  // namespace

std::span<const HardCase> hard_cases() noexcept { return kCases; }

const HardCase& hard_case(std::string_view spec) {
  const std::string_view wanted = spec.starts_with(kPrefix) ? spec.substr(kPrefix.size()) : spec;
  std::vector<std::string_view> names;
  for (const HardCase& row : kCases) {
    if (row.name == wanted) return row;
    names.push_back(row.name);
  }
  const std::string near = nearest_word(wanted, names);
  throw Error(
      fmt::format("{}: unknown hard case; {}", spec, near.empty() ? fmt::format("expected one of {}", fmt::join(names, ", ")) : "did you mean " + near + "?"));
}

}  // namespace raymeter
