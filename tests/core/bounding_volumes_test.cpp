// Bounding volumes hold what they bound, in exact arithmetic: every float is a rational, and the points of surfaces that are tried are rational too.

#include <gtest/gtest.h>

#include <cmath>

#include <gmpxx.h>

#include "accel/bvh/bvh_structure.h"
#include "accel/registry.h"
#include "core/bounds/aabb_volume.h"
#include "core/bounds/kdop_volume.h"
#include "core/bounds/obb_volume.h"
#include "core/bounds/sphere_volume.h"
#include "core/geometry/error_bounds.h"
#include "experiments/scenes/generators.h"
#include "tests/support/expect_error.h"
#include "tests/support/random.h"

namespace raymeter {
namespace {

using test::Random;
using Exact = std::array<mpq_class, 3>;

Exact exact(const glm::dvec3& p) { return {p.x, p.y, p.z}; }
Exact operator-(const Exact& a, const Exact& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Exact operator+(const Exact& a, const Exact& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Exact operator*(const mpq_class& s, const Exact& a) { return {s * a[0], s * a[1], s * a[2]}; }
mpq_class dot(const Exact& a, const Exact& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Exact cross(const Exact& a, const Exact& b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }

bool holds(const AabbVolume&, const Aabb& box, const Exact& p) {
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<glm::length_t>(a);
    if (p[a] < double{box.min[axis]} || p[a] > double{box.max[axis]}) return false;
  }
  return true;
}
bool holds(const SphereVolume&, const BoundingSphere& sphere, const Exact& p) {
  const Exact d = p - exact(glm::dvec3(sphere.center));
  const mpq_class radius(double{sphere.radius});
  return dot(d, d) <= radius * radius;
}
bool holds(const ObbVolume&, const Obb& box, const Exact& p) {
  const Exact d = p - exact(glm::dvec3(box.center));
  for (std::size_t i = 0; i < 3; ++i) {
    const mpq_class half(double{box.half[static_cast<glm::length_t>(i)]});
    if (abs(dot(exact(glm::dvec3(box.axis[i])), d)) > half) return false;
  }
  return true;
}
bool holds(const KdopVolume& volume, const Kdop& kdop, const Exact& p) {
  const Exact d = p - exact(glm::dvec3(volume.origin()));
  for (std::size_t i = 0; i < volume.directions().size(); ++i) {
    const mpq_class at = dot(exact(glm::dvec3(volume.directions()[i])), d);
    if (at < double{kdop.min[i]} || at > double{kdop.max[i]}) return false;
  }
  return true;
}

/// A rational vector along v, no longer than 1 and shorter by at most 1e-12.
Exact almost_unit(const Exact& v) {
  const mpq_class length2 = dot(v, v);
  mpq_class scale(1 / std::sqrt(length2.get_d()));
  while (scale * scale * length2 > 1) scale *= mpq_class(1 - 0x1p-44);
  return scale * v;
}

/// A point of the surface, or inside of it by 1e-12 of its size at most.
Exact surface_point(const Pools& pools, PrimRef ref, Random& random) {
  const std::size_t i = ref.index;
  const auto at = [](const FloatColumns3& columns, std::size_t k) { return exact(glm::dvec3(columns[0][k], columns[1][k], columns[2][k])); };
  switch (ref.kind()) {
    case PrimKind::sphere: return at(pools.spheres.center, i) + mpq_class(double{pools.spheres.radius[i]}) * almost_unit(exact(random.direction()));
    case PrimKind::triangle: {
      const mpq_class u(random.uniform()), v(random.uniform() * (1 - u.get_d()));
      const Exact a = at(pools.triangles.vertex[0], i), b = at(pools.triangles.vertex[1], i), c = at(pools.triangles.vertex[2], i);
      switch (random.below(4)) {
        case 0: return a;
        case 1: return b;
        case 2: return c;
        default: return a + u * (b - a) + v * (c - a);
      }
    }
    case PrimKind::polygon: {
      const auto first = static_cast<std::size_t>(pools.polygons.first_vertex[i]), end = static_cast<std::size_t>(pools.polygons.first_vertex[i + 1]);
      return at(pools.polygons.vertex, first + random.below(end - first));
    }
    case PrimKind::cone: {
      const Exact axis = at(pools.cones.axis, i);
      Exact across = cross(axis, exact(random.direction()));
      if (dot(across, across) == 0) across = exact(random.direction());
      const mpq_class y(random.below(3) == 0 ? 0.0 : random.below(2) == 0 ? 1.0 : random.uniform());
      const mpq_class radius = (1 - y) * double{pools.cones.radius[0][i]} + y * double{pools.cones.radius[1][i]};
      return at(pools.cones.base, i) + y * axis + radius * almost_unit(across);
    }
  }
  return {};
}

/// How far a hit may be off, as far as that is relative to the primitive's size: for boxes per axis, else in any direction (error_bounds.h). A little less, for
/// the roundings here.
Exact error_for(const AabbVolume&, const Aabb& box, Random& random) {
  const double extent = double{std::max({box.extent().x, box.extent().y, box.extent().z})};
  return exact(random.in_cube(double{kPrimitiveError} * extent * 0.999));
}
template <class V>
Exact error_for(const V&, const Aabb& box, Random& random) {
  return exact(double{kSurfaceError} * glm::length(glm::dvec3(box.extent())) * 0.999 * random.direction());
}

std::vector<PrimRef> prims_of(const Scene& scene) {
  std::vector<PrimRef> prims;
  for (std::int32_t id = 0; id < scene.prim_id_count(); ++id) {
    if (!scene.prim(id).dropped()) prims.push_back(scene.prim(id));
  }
  return prims;
}

/// Around single primitives, pairs, runs of neighbours, and merged from halves.
template <class V>
void expect_holds(const V& volume, const Scene& scene, int tries) {
  Random random(31);
  const std::vector<PrimRef> prims = prims_of(scene);
  for (int k = 0; k < tries; ++k) {
    const std::size_t first = random.below(prims.size()), count = std::min(prims.size() - first, std::size_t{1} << random.below(6));
    const std::span<const PrimRef> some(prims.data() + first, count);
    auto merged = volume.fit(scene, some.front());
    for (const PrimRef prim : some.subspan(1)) merged = volume.merge(merged, volume.fit(scene, prim));
    const auto tight = volume.fit(scene, some);
    for (int point = 0; point < 8; ++point) {
      const PrimRef prim = some[random.below(count)];
      const Exact p = surface_point(scene.pools(), prim, random) + error_for(volume, tight_bounds(scene.pools(), prim), random);
      ASSERT_TRUE(holds(volume, volume.fit(scene, prim), p)) << scene.name << " try " << k << " kind " << prim.kind_bits;
      ASSERT_TRUE(holds(volume, tight, p)) << scene.name << " try " << k << " of " << count;
      ASSERT_TRUE(holds(volume, merged, p)) << scene.name << " try " << k << " of " << count;
    }
  }
}

void expect_all_hold(const Scene& scene, int tries) {
  expect_holds(AabbVolume{}, scene, tries);
  expect_holds(SphereVolume{false}, scene, tries);
  expect_holds(SphereVolume{true}, scene, tries / 4);
  for (const ObbAxes axes : {ObbAxes::object, ObbAxes::pca, ObbAxes::best}) expect_holds(ObbVolume{axes}, scene, tries);
  for (const int k : {6, 8, 12, 14, 18, 20, 26}) expect_holds(KdopVolume(scene, k), scene, tries / 4);
  expect_holds(KdopVolume(scene, "1 0.25 0/-0.5 2 0.125/3 1 -4/0 0 1"), scene, tries);
}

TEST(BoundingVolumes, HoldTheirPrimitives) {
  for (const SceneGenerator& generator : scene_generators()) {
    Scene scene = generator.make(std::min(generator.default_size, std::max(generator.min_size, 3)));
    scene.name = std::string(generator.spec_prefix);
    expect_all_hold(scene, 60);
  }
}

TEST(BoundingVolumes, HoldPrimitivesOfAnySize) {
  Random random(32);
  Scene scene;
  const auto magnitude = [&] { return std::pow(10.0, random.uniform(-8, 8)); };
  for (int i = 0; i < 4000; ++i) {
    const double size = magnitude();
    const glm::dvec3 p = magnitude() * random.in_cube(), e = size * random.direction(), f = size * random.uniform(0, 1) * random.direction();
    const std::array<glm::dvec3, 4> quad{p, p + e, p + e + f, p + f};
    switch (i % 4) {
      case 0: scene.add_triangle(p, p + e, p + f); break;
      case 1: scene.add_sphere(p, size); break;
      case 2: scene.add_cone(p, size * random.uniform(), p + f, size * random.uniform()); break;
      default: scene.add_polygon(quad);
    }
  }
  scene.finish();
  expect_all_hold(scene, 1000);
}

/// Every node's volume holds what is below it, in trees of two shapes.
template <class V>
void expect_ancestors_hold(const V& volume, const Scene& scene) {
  Random random(33);
  for (const char* technique : {"bvh:builder=binned_sah", "bvh:builder=goldsmith_salmon"}) {
    const BvhTree tree = build_bvh_tree(scene, raymeter::bind<BvhParams>(parse_technique(technique).params), 1);
    const FlatTree flat = flatten(tree);
    const auto bounds = link_bounds(volume, scene, tree, flat, 1);
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      const FlatTree::Source& source = flat.sources[i];
      for (int point = 0; source.node >= 0 && point < 3; ++point) {
        const PrimRef prim =
            flat.order[static_cast<std::size_t>(source.first_prim) + random.below(static_cast<std::size_t>(source.end_prim - source.first_prim))];
        const Exact p = surface_point(scene.pools(), prim, random) + error_for(volume, tight_bounds(scene.pools(), prim), random);
        ASSERT_TRUE(holds(volume, bounds[i], p)) << scene.name << " " << technique << " node " << i;
      }
    }
  }
}

TEST(BoundingVolumes, OfNodesHoldWhatIsBelow) {
  for (const SceneGenerator& generator : scene_generators()) {
    Scene scene = generator.make(std::min(generator.default_size, std::max(generator.min_size, 3)));
    scene.name = std::string(generator.spec_prefix);
    expect_ancestors_hold(AabbVolume{}, scene);
    expect_ancestors_hold(SphereVolume{}, scene);
    expect_ancestors_hold(ObbVolume{}, scene);
    expect_ancestors_hold(KdopVolume(scene, 18), scene);
  }
}

TEST(BoundingVolumes, AreAsTightAsTheirKindAllows) {
  Scene scene;
  scene.add_sphere({1, 2, 3}, 2);
  scene.begin_object("tilted", glm::dmat4(glm::dvec4(0.6, 0.8, 0, 0), glm::dvec4(-0.8, 0.6, 0, 0), glm::dvec4(0, 0, 1, 0), glm::dvec4(0, 0, 0, 1)));
  scene.add_triangle({0, 0, 0}, {6, 8, 0}, {-0.8, 0.6, 0});
  scene.end_object();
  scene.add_cone({0, 0, 0}, 1, {0, 0, 4}, 1);
  scene.finish();
  const double padding = 2 * double{kSurfaceError};  // of the diagonal, on either side
  EXPECT_NEAR(SphereVolume{}.fit(scene, scene.prim(0)).radius, 2, padding * 7);
  EXPECT_NEAR(SphereVolume{}.fit(scene, scene.prim(2)).radius, std::sqrt(5.0), padding * 5);
  EXPECT_NEAR(SphereVolume{true}.fit(scene, scene.prim(1)).radius, std::sqrt(101.0) / 2, 0.01 * 5);  // to a percent, as declared
  for (const ObbAxes axes : {ObbAxes::object, ObbAxes::best}) {
    const ObbVolume obb{axes};
    EXPECT_NEAR(obb.half_area(obb.fit(scene, scene.prim(1))), 10 * 1, padding * 10.6 * (2 * 10 + 2 * 1)) << static_cast<int>(axes);
  }
  const ObbVolume pca{ObbAxes::pca};
  EXPECT_NEAR(pca.half_area(pca.fit(scene, scene.prim(2))), 2 * 2 + 2 * 4 + 4 * 2, padding * 5.1 * (2 * 2 + 2 * 2 + 2 * 4));
}

TEST(Kdop, AreaIsThatOfItsPolytope) {
  Scene scene;
  scene.add_sphere({5, -3, 8}, 1);
  scene.finish();
  const auto area = [&](const KdopVolume& volume) { return 2 * volume.half_area(volume.fit(scene, scene.prim(0))); };
  const double kRoundings = 2 * double{kSurfaceError} * std::sqrt(12.0) * 1.01 * 30;               // the padding on a radius of 1 changes an area twice as much
  EXPECT_NEAR(area(KdopVolume(scene, 6)), 24, kRoundings);                                         // cube
  EXPECT_NEAR(area(KdopVolume(scene, 8)), 12 * std::sqrt(3.0), kRoundings);                        // octahedron of inradius 1
  EXPECT_NEAR(area(KdopVolume(scene, 12)), 12 * std::sqrt(2.0), kRoundings);                       // rhombic dodecahedron of inradius 1
  EXPECT_NEAR(area(KdopVolume(scene, "1 0 0/0 1 0/0.6 0 0.8")), 2 * 5 + 4 * 2.5 * 2, kRoundings);  // prism of height 2 over a rhombus
  const double finest = area(KdopVolume(scene, 26));
  EXPECT_GT(finest, 4 * 3.14159);
  EXPECT_LT(finest, area(KdopVolume(scene, 18)));
}

TEST(Kdop, DirectionsThatDoNotSpanSpaceAreErrors) {
  const Scene scene;
  const auto error_of = [&](std::string_view text, const std::string& why) {
    expect_error_message([&] { (void)KdopVolume(scene, text); },
                         "directions: '" + std::string(text) + "': " + why + ", expected 3 to 13 vectors that span space, as in 1 0 0/0 1 0/0 0.6 0.8");
  };
  error_of("1 0 0/0 1 0/1 1 0", "they do not span space");
  error_of("1 0 0/0 1 0", "2 vectors");
  error_of("1 0 0/0 1 0/0 0 0", "a direction is zero or infinite");
  error_of("1 0 0/0 1/0 0 1", "three numbers are missing at position 9");
  error_of("1 0 0;0 1 0", "unexpected ';'");
  expect_error_message([&] { (void)KdopVolume(scene, 10); }, "k: 10, expected 6, 8, 12, 14, 18, 20 or 26");
}

}  // namespace
}  // namespace raymeter
