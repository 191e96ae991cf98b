// Meshes of triangles: no holes at edges and vertices, wherever the mesh lies and however large it is.

#include <algorithm>
#include <cmath>

#include "core/geometry/error_bounds.h"
#include "experiments/verify/triangle_truth.h"
#include "experiments/verify/verify.h"
#include "tests/numerics/kernel_test.h"
#include "tests/support/random.h"
#include "tests/support/test_rays.h"
#include "tests/support/test_scenes.h"

namespace raymeter {
namespace {

using test::make_ray;
using test::Random;

constexpr float kInf = std::numeric_limits<float>::infinity();

class TriangleMeshes : public test::KernelTest {};

glm::dvec3 vertex(const Scene& scene, std::size_t triangle, std::size_t k) {
  const auto& v = scene.pools().triangles.vertex[k];
  return {v[0][triangle], v[1][triangle], v[2][triangle]};
}

/// Rays from within `half` of the centre at vertices, points of edges and points of faces of a mesh, a third each.
RayBatch rays_at_mesh(const Scene& mesh, const glm::dvec3& center, double half, int count, std::uint64_t seed) {
  Random random(seed);
  RayBatch rays;
  for (int i = 0; i < count; ++i) {
    const std::size_t triangle = random.below(mesh.pools().triangles.size()), k = random.below(3);
    const glm::dvec3 a = vertex(mesh, triangle, k), b = vertex(mesh, triangle, (k + 1) % 3), c = vertex(mesh, triangle, (k + 2) % 3);
    const double s = random.uniform(), r = random.uniform(0.1, 0.9);
    const glm::dvec3 at = i % 3 == 0 ? a : i % 3 == 1 ? a + s * (b - a) : a + r * (b - a) + (1 - r) * 0.5 * (c - a);
    // The origin is rounded first, so that the direction is off by its own rounding only.
    const glm::dvec3 org(glm::vec3(center + random.in_cube(half)));
    rays.push_back(make_ray(org, at - org));
  }
  return rays;
}

std::ptrdiff_t misses(const HitBatch& hits) { return std::count(hits.prim.begin(), hits.prim.end(), -1); }

TEST_P(TriangleMeshes, ClosedMeshHasNoHoles) {
  const Scene mesh = test::icosphere(5);
  ASSERT_EQ(mesh.prim_count(), 20480);
  const RayBatch rays = rays_at_mesh(mesh, {0, 0, 0}, 0.1, 300000, 31);
  const HitBatch hits = trace(mesh, rays, "bvh");
  EXPECT_EQ(misses(hits), 0);
  const Oracle oracle(mesh);
  const Accuracy accuracy = verify_closest(oracle, rays, hits, {600.0 * mesh.prim_count(), 1, 1});
  EXPECT_EQ(accuracy.rays_checked, 600);
  EXPECT_EQ(accuracy.mismatches(), 0);
  const RayBatch few = rays_at_mesh(mesh, {0, 0, 0}, 0.1, 1500, 32);
  EXPECT_EQ(misses(trace(mesh, few)), 0);
}

/// Where a line passes the plane of a triangle that it is not parallel to; exact but for the last rounding.
double plane_depth(const Ray& ray, const verify::TriangleShape& triangle) {
  using namespace verify;
  return decide(Arithmetic::filtered, [&]<class N>() {
    const Vec<N> org = vec<N>(ray.org), dir = vec<N>(ray.dir);
    const Vec<N> a = vec<N>(triangle.vertex[0]) - org, b = vec<N>(triangle.vertex[1]) - org, c = vec<N>(triangle.vertex[2]) - org;
    const Vec<N> normal = cross(b - a, c - a);
    return to_double(dot(normal, a)) / to_double(dot(normal, dir));
  });
}

/// Errors of all hits of a mesh, each against the plane of the triangle that it names: the same as against the triangle where the ray truly meets that.
struct DepthErrors {
  std::vector<double> ulps;  ///< of t, in order
  std::size_t beside = 0;    ///< rays that truly pass their triangle by: at vertices and edges, where rounded rays meet a neighbour
  double passed_by = 0;      ///< how far, at most, relative to the way

  DepthErrors(const Scene& mesh, const RayBatch& rays, const HitBatch& hits) {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (hits.prim[i] < 0) continue;
      const Ray ray = rays[i];
      const verify::TriangleShape triangle = verify::triangle_at(mesh.pools(), static_cast<std::size_t>(hits.prim[i]));
      const double t = plane_depth(ray, triangle);
      ulps.push_back(raymeter::ulps(hits.t[i], t));
      if (verify::true_hits(ray, triangle).count > 0) continue;
      ++beside;
      const verify::Point dir = verify::point(ray.dir);
      passed_by = std::max(passed_by, verify::distance(triangle, verify::along(verify::point(ray.org), t, dir)) / (t * verify::length(dir)));
    }
    std::sort(ulps.begin(), ulps.end());
  }
};

/// Numerics case 11: t from inside of a unit icosphere, a million rays each at vertices, edges and faces. No ray is lost, none is left out.
TEST_P(TriangleMeshes, DepthInsideAClosedMeshIsGoodToAFewUlps) {
  const Scene mesh = test::icosphere(5);
  const RayBatch rays = rays_at_mesh(mesh, {0, 0, 0}, 0.1, 3'000'000, 36);
  const DepthErrors errors(mesh, rays, trace(mesh, rays, "bvh"));
  ASSERT_EQ(errors.ulps.size(), rays.size()) << "misses";
  const double p99 = errors.ulps[errors.ulps.size() * 99 / 100];
  RecordProperty("t_ulp_p99", std::to_string(p99));
  RecordProperty("t_ulp_max", std::to_string(errors.ulps.back()));
  RecordProperty("beside", std::to_string(errors.beside));
  RecordProperty("passed_by_roundings", std::to_string(errors.passed_by / double{kUnitRoundoff}));
  EXPECT_LE(p99, 3);
  EXPECT_LE(errors.ulps.back(), 8);
  EXPECT_LE(errors.beside, rays.size() * 2 / 3) << "a ray into a face misses what it names";
  EXPECT_LE(errors.passed_by, double{kSeenVertexError});
}

/// What the kernel may err in t: 5 roundings of it and 12 of the triangle's spread along the ray; and what vertices are seen off by across the ray, by which a
/// plane that is seen at a grazing angle moves along it.
double promised_error(const Scene& mesh, std::size_t triangle, const Ray& ray, double t) {
  const glm::dvec3 org(ray.org[0], ray.org[1], ray.org[2]), dir(ray.dir[0], ray.dir[1], ray.dir[2]);
  const glm::dvec3 a = vertex(mesh, triangle, 0), b = vertex(mesh, triangle, 1), c = vertex(mesh, triangle, 2);
  const glm::dvec3 size = glm::abs(dir), z = size.x >= std::max(size.y, size.z) ? glm::dvec3(1, 0, 0)
                                             : size.y >= size.z                 ? glm::dvec3(0, 1, 0)
                                                                                : glm::dvec3(0, 0, 1);
  const auto [nearest, farthest] = std::minmax({glm::dot(a, z), glm::dot(b, z), glm::dot(c, z)});
  const double spread = (farthest - nearest) / glm::dot(size, z);
  const double away = std::max({glm::distance(a, org), glm::distance(b, org), glm::distance(c, org)});
  const double slope = std::abs(glm::dot(glm::normalize(glm::cross(b - a, c - a)), dir));
  return double{kUnitRoundoff} * (5 * t + 12 * spread) + double{kSeenVertexError} * away / slope;
}

/// Lines at any angle, half of them past a point of the mesh and all but in the plane of what they meet there.
TEST_P(TriangleMeshes, DepthOfLinesIsAsPromised) {
  const Scene mesh = test::icosphere(5);
  Random random(37);
  RayBatch rays;
  while (rays.size() < 1'000'000) {
    const glm::dvec3 org(glm::vec3(random.in_cube(1.5)));
    const std::size_t triangle = random.below(mesh.pools().triangles.size());
    const glm::dvec3 a = vertex(mesh, triangle, 0), b = vertex(mesh, triangle, 1), c = vertex(mesh, triangle, 2);
    const glm::dvec3 middle = (a + b + c) / 3.0, along = random.uniform() * (b - a) + random.uniform(-1, 1) * (c - a);
    const bool grazing = rays.size() % 2 != 0;
    const glm::dvec3 near = middle - std::pow(10.0, random.uniform(-1, 2)) * along + std::pow(10.0, random.uniform(-8, -2)) * middle;
    rays.push_back(grazing ? make_ray(near, middle - glm::dvec3(glm::vec3(near))) : make_ray(org, random.direction()));
  }
  const HitBatch hits = trace(mesh, rays, "bvh");
  double worst = 0, random_max = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (hits.prim[i] < 0) continue;
    const auto triangle = static_cast<std::size_t>(hits.prim[i]);
    const verify::TrueHits met = verify::true_hits(rays[i], verify::triangle_at(mesh.pools(), triangle));
    if (met.count == 0) continue;
    worst = std::max(worst, std::abs(double{hits.t[i]} - met.t[0]) / promised_error(mesh, triangle, rays[i], met.t[0]));
    if (i % 2 == 0) random_max = std::max(random_max, ulps(hits.t[i], met.t[0]));
  }
  RecordProperty("share_of_promise", std::to_string(worst));
  RecordProperty("random_t_ulp_max", std::to_string(random_max));
  EXPECT_LE(worst, 1);
}

/// Two tetrahedra on one triangle ABD, A the origin: a solid that is hollow along AB, so that the plane of ABC passes through its inside.
struct HollowSolid {
  glm::dvec3 b, c, d, e;

  [[nodiscard]] static double side(const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) { return glm::dot(glm::cross(p, q), r); }
  /// Whether C and E lie on either side of ABD, and `at` within ABDE.
  [[nodiscard]] bool holds(const glm::dvec3& at) const {
    const double volume = side(b, d, e);
    const auto inside = [&](double part) { return part * volume > 0; };
    return side(b, d, c) * volume < 0 && inside(side(b, d, at)) && inside(side(at, d, e)) && inside(side(b, at, e)) &&
           inside(volume - side(b, d, at) - side(at, d, e) - side(b, at, e));
  }
  /// With ABC, or without it.
  [[nodiscard]] Scene scene(bool whole) const {
    const glm::dvec3 a(0.0);
    Scene mesh;
    if (whole) mesh.add_triangle(a, b, c);
    mesh.add_triangle(b, c, d);
    mesh.add_triangle(c, a, d);
    mesh.add_triangle(a, b, e);
    mesh.add_triangle(b, d, e);
    mesh.add_triangle(d, a, e);
    mesh.finish();
    return mesh;
  }
};

/// Why a ray in the plane of a triangle may be reported to meet it (C3): from inside of a solid, along a facet in whole numbers, that facet is at times all
/// that is seen around the ray. To leave it out would be a hole.
TEST_P(TriangleMeshes, RaysAlongAFacetOfASolidFindNoHole) {
  Random random(38);
  const auto whole = [&](int reach) {
    const auto number = [&] { return static_cast<double>(random.below(static_cast<std::size_t>(2 * reach + 1))) - reach; };
    const double x = number(), y = number();
    return glm::dvec3(x, y, number());
  };
  int rays_traced = 0, facet_alone = 0;
  while (rays_traced < 50'000) {
    const glm::dvec3 x = whole(6), y = whole(6);
    const HollowSolid solid{8.0 * x, 8.0 * y, 8.0 * whole(12), 8.0 * whole(12)};
    const glm::dvec3 org = (1.0 + static_cast<double>(random.below(7))) * x - (1.0 + static_cast<double>(random.below(6))) * y;
    if (glm::cross(x, y) == glm::dvec3(0.0) || !solid.holds(org)) continue;
    RayBatch rays;
    for (int k = 0; k < 50; ++k) {
      const auto at = static_cast<double>(1 + random.below(62));
      rays.push_back(make_ray(org, at * x + static_cast<double>(1 + random.below(static_cast<std::size_t>(63 - at))) * y - 8.0 * org));
    }
    ASSERT_EQ(misses(trace(solid.scene(true), rays)), 0);
    facet_alone += static_cast<int>(misses(trace(solid.scene(false), rays)));
    rays_traced += static_cast<int>(rays.size());
  }
  RecordProperty("facet_alone", facet_alone);
  EXPECT_GT(facet_alone, 0);
}

TEST_P(TriangleMeshes, ClosedMeshFarFromTheOriginHasNoHoles) {
  const glm::dvec3 center(148376, 1234, -223423);
  const Scene mesh = test::icosphere(3, 2, center);
  const RayBatch rays = rays_at_mesh(mesh, center, 0.5, 100000, 33);
  EXPECT_EQ(misses(trace(mesh, rays, "bvh")), 0);
}

/// Numerics case 13. What underflows makes weights of triangles that are seen small less exact, or 0, until the triangles are lost, all at once: twice the area
/// of each here is 2^-9.8 to 2^-9.4 of the mesh's radius squared.
TEST_P(TriangleMeshes, ScaleOfTheMeshIsThatOfT) {
  enum class Same { bits, depth, nearly, lost };  // as at scale 1: all of it; t, and ids but for ties; triangles, within the declared errors; nothing
  const Scene unit = test::icosphere(5);
  const RayBatch rays = rays_at_mesh(unit, {0, 0, 0}, 0.1, 20'000, 34);
  const HitBatch expected = trace(unit, rays, "bvh");
  for (const auto& [exponent, same] : {std::pair{-66, Same::lost},
                                       {-59, Same::lost},
                                       {-58, Same::nearly},
                                       {-56, Same::nearly},
                                       {-53, Same::nearly},
                                       {-50, Same::depth},
                                       {-40, Same::bits},
                                       {33, Same::bits},
                                       {50, Same::bits},
                                       {59, Same::bits}}) {
    SCOPED_TRACE("2^" + std::to_string(exponent));
    const double scale = std::ldexp(1.0, exponent);
    Scene mesh;
    for (std::size_t i = 0; i < unit.pools().triangles.size(); ++i) {
      mesh.add_triangle(scale * vertex(unit, i, 0), scale * vertex(unit, i, 1), scale * vertex(unit, i, 2));
    }
    mesh.finish();
    RayBatch scaled;  // origins scaled, directions as they are: t is scaled
    for (std::size_t i = 0; i < rays.size(); ++i) {
      Ray ray = rays[i];
      for (float& x : ray.org) x *= static_cast<float>(scale);
      scaled.push_back(ray);
    }
    HitBatch hits = trace(mesh, scaled, "bvh");
    ASSERT_EQ(misses(hits), same == Same::lost ? static_cast<std::ptrdiff_t>(rays.size()) : 0);
    if (same == Same::lost) continue;
    for (float& t : hits.t) t /= static_cast<float>(scale);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_TRUE(same != Same::bits || hits.prim[i] == expected.prim[i]) << "ray " << i;
      ASSERT_TRUE(same == Same::nearly || hits.t[i] == expected.t[i]) << "ray " << i;
    }
    const DepthErrors errors(unit, rays, hits);
    EXPECT_LE(errors.ulps.back(), 8);
    EXPECT_LE(errors.passed_by, double{kSeenVertexError});
  }
}

TEST_P(TriangleMeshes, IntegerHeightFieldUnderVerticalRays) {
  constexpr int kSize = 24;
  Random random(35);
  std::vector<int> height;
  for (int i = 0; i < (kSize + 1) * (kSize + 1); ++i) height.push_back(static_cast<int>(random.below(8)));
  const auto at = [&](int x, int y) { return glm::dvec3(x, y, height[static_cast<std::size_t>(y * (kSize + 1) + x)]); };
  Scene field;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      field.add_triangle(at(x, y), at(x + 1, y), at(x + 1, y + 1));
      field.add_triangle(at(x, y), at(x + 1, y + 1), at(x, y + 1));
    }
  }
  field.finish();
  RayBatch rays;
  std::vector<double> expected;
  for (int signs = 0; signs < 4; ++signs) {
    for (int y = 0; y <= 2 * kSize; ++y) {
      for (int x = 0; x <= 2 * kSize; ++x) {
        rays.push_back({{0.5f * static_cast<float>(x), 0.5f * static_cast<float>(y), 100}, 0, {signs & 1 ? -0.0f : 0.0f, signs & 2 ? -0.0f : 0.0f, -1}, kInf});
        // Middles of edges and diagonals, all of which run from (x, y) to (x + 1, y + 1).
        expected.push_back(100 - (at(x / 2, y / 2).z + at((x + 1) / 2, (y + 1) / 2).z) / 2);
      }
    }
  }
  const HitBatch hits = trace(field, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_GE(hits.prim[i], 0) << rays[i].org[0] << ' ' << rays[i].org[1];
    ASSERT_EQ(double{hits.t[i]}, expected[i]) << rays[i].org[0] << ' ' << rays[i].org[1];
  }
}

TEST_P(TriangleMeshes, SliversAreMetInTheirMiddle) {
  for (const int exponent : {20, 23, 40}) {
    const double h = std::ldexp(1.0, -exponent);
    Scene scene;
    scene.add_triangle({0, 0, 0}, {1, 0, 0}, {1, h, 0});
    scene.finish();
    const Hit hit = trace(scene, Ray{{0.75f, static_cast<float>(h / 4), -1}, 0, {0, 0, 1}, kInf});
    EXPECT_EQ(hit.prim, 0) << "2^-" << exponent;
    EXPECT_EQ(hit.t, 1) << "2^-" << exponent;
    EXPECT_EQ(hit.u, 0.5f) << "2^-" << exponent;
    EXPECT_EQ(hit.v, 0.25f) << "2^-" << exponent;
  }
}

INSTANTIATE_TEST_SUITE_P(Isas, TriangleMeshes, testing::ValuesIn(kIsas), [](const testing::TestParamInfo<Isa>& isa) { return std::string(name(isa.param)); });

}  // namespace
}  // namespace raymeter
