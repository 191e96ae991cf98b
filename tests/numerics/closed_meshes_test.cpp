// No structure loses a ray at a vertex, an edge or a face of a closed mesh: near, far from the origin, and in planes of the axes, where rays run along the
// faces of boxes and cells.

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <ostream>

#include <gtest/gtest.h>

#include "core/ray/generators.h"
#include "experiments/scenes/scene_source.h"
#include "tests/support/mesh_path.h"
#include "tests/support/random.h"
#include "tests/support/test_scenes.h"
#include "tests/support/traces.h"

namespace raymeter {
namespace {

using test::Random;

constexpr float kInf = std::numeric_limits<float>::infinity();

/// Rays of a class, and the most primitives that `list` tests with all of them. Builds that check instead of being fast take many times as long.
#ifdef NDEBUG
constexpr std::int32_t kRays = 100'000, kListed = 20480;
#else
constexpr std::int32_t kRays = 10'000, kListed = 2000;
#endif

/// With RAYMETER_ALL_RAYS in the environment all of a mesh's rays look for their nearest hits whatever it takes (`list`: hours), on all threads.
const bool kAllRays = std::getenv("RAYMETER_ALL_RAYS") != nullptr;

struct Case {
  std::string technique;
  std::vector<int> packets;  ///< sizes that meshes are traced with, on every instruction set

  [[nodiscard]] bool is(std::string_view structure) const { return technique == structure; }
};

/// Every structure with default parameters, and the traversals and bounding volumes of each that are not the default.
std::vector<Case> all_cases() {
  const std::vector<int> all_packets{1, 3, 16, 64}, one{16};
  std::vector<Case> cases;
  const auto add = [&](std::string_view technique, const std::vector<int>& packets) { cases.push_back({std::string(technique), packets}); };
  for (const char* of_own_tests : {"bvh:traversal=beam", "bvh:traversal=stream"}) add(of_own_tests, all_packets);  // of triangles
  for (const char* other :
       {"bvh:traversal=packet", "bvh:traversal=single", "bvh:traversal=heap", "bvh:traversal=stream,plane_bits=8", "bvh:traversal=single,plane_bits=5",
        "bvh:volume=sphere", "bvh:volume=obb", "bvh:volume=kdop", "bvh:volume=kdop,k=26", "grid:traversal=slices", "kdtree:traversal=packet",
        "bsp:traversal=packet", "octree:tracking=neighbour", "octree:tracking=point_location"}) {
    add(other, one);
  }
  for (const StructureEntry& entry : structures()) add(entry.name, all_packets);
  return cases;
}

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << test::test_name(c.technique); }

/// A scene's rays at vertices, edges and faces; made once.
struct Mesh {
  Scene scene;
  RayBatch rays;
  RayBatch some_rays;  ///< every hundredth

  Mesh(Scene mesh, std::int32_t rays_a_class) : scene(std::move(mesh)) {
    const StructureEntry& bvh = structure_entry("bvh");
    const ParamValues params = bvh.resolve({});
    const auto structure = bvh.build(scene, params, 1);
    const auto tracer = structure->intersector({Isa::scalar, 1, params});
    for (const RayKind kind : {RayKind::vertices, RayKind::edges, RayKind::faces}) {
      const RaySet set = make_rays(scene, kind, {scene.camera, CameraConvention::pixel, rays_a_class, 1}, 31, *tracer, 1);
      EXPECT_EQ(set.expected.prim.size(), set.rays.size()) << "not closed";
      rays.append(set.rays);
    }
    for (std::size_t i = 0; i < rays.size(); i += 100) some_rays.push_back(rays[i]);
  }
};

struct Found {
  HitBatch hits;
  test::Blockers blockers;
};

Found trace(const Structure& structure, const QueryOptions& options, const RayBatch& closest, const RayBatch& any) {
  const auto intersector = structure.intersector(options);
  const int threads = kAllRays ? 0 : 1;
  Found found;
  intersector->prepare(closest.view(), Query::closest, threads);
  trace_closest(*intersector, closest, found.hits, threads);
  intersector->prepare(any.view(), Query::any, threads);
  trace_any(*intersector, any, found.blockers, threads);
  return found;
}

/// One test for all instruction sets, as a scan and its rays take longer to make than to trace.
class ClosedMeshes : public testing::TestWithParam<Case> {
protected:
  /// Any hits are looked for in full by one size on each instruction set, all of them in turn: they run other kernels of nearly the same tests.
  template <class Sizes>
  [[nodiscard]] static int size_of_any(const Sizes& sizes, Isa isa) {
    return sizes[static_cast<std::size_t>(isa) % sizes.size()];
  }
  /// Whether all rays of a closed mesh fit the time that tests may take; else a hundredth is traced. Two structures take far longer than others on large
  /// meshes: `list` tests all primitives with every register of rays, and `ray_classification` makes its lists again for every query and size. They look for
  /// any hits in a hundredth there, and `list` in the scan for all, unless RAYMETER_ALL_RAYS is set.
  [[nodiscard]] static bool affordable(const Scene& scene, Query query, Isa isa, int packet) {
    constexpr std::int32_t kFew = 2000;
    const std::int32_t size = scene.prim_count();
    if (size <= kFew) return true;
    const bool list = GetParam().is("list");
    if (query == Query::any) return !list && !GetParam().is("ray_classification") && packet == size_of_any(GetParam().packets, isa);
    return kAllRays || !list || size <= kListed;
  }
  /// No ray is lost, the nearest hit or any being asked for.
  static void expect_no_holes(const Mesh& mesh) {
    const TechniqueSpec spec = parse_technique(GetParam().technique);
    const auto structure = spec.structure->build(mesh.scene, spec.params, 1);
    for (const Isa isa : kIsas) {
      if (!available(isa)) continue;
      for (const int packet : GetParam().packets) {
        const auto rays_for = [&](Query query) -> const RayBatch& { return affordable(mesh.scene, query, isa, packet) ? mesh.rays : mesh.some_rays; };
        const auto [hits, blockers] = trace(*structure, {isa, packet, spec.params}, rays_for(Query::closest), rays_for(Query::any));
        EXPECT_EQ(std::count(hits.prim.begin(), hits.prim.end(), -1), 0) << name(isa) << ", packets of " << packet;
        EXPECT_EQ(std::count(blockers.begin(), blockers.end(), -1), 0) << name(isa) << ", packets of " << packet;
      }
    }
  }
};

TEST_P(ClosedMeshes, HaveNoHoles) {
  static const Mesh mesh(test::icosphere(5), kRays);
  ASSERT_EQ(mesh.scene.prim_count(), 20480);
  expect_no_holes(mesh);
}

TEST_P(ClosedMeshes, HaveNoHolesFarFromTheOrigin) {
  static const Mesh mesh(test::icosphere(3, 2, {148376, 1234, -223423}), kRays / 5);
  expect_no_holes(mesh);
}

TEST_P(ClosedMeshes, HaveNoHolesInAScan) {
  const std::string& technique = GetParam().technique;
  if (technique.find("volume=") != std::string::npos || technique.find("heap") != std::string::npos)
    GTEST_SKIP() << "their volumes and traversals are slow, and meet whatever there is on the sphere and the height field";
  const std::string path = test::mesh_path("armadillo");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  static const Mesh mesh(load_scene(path), kRays);
  expect_no_holes(mesh);
}

/// Steps of whole heights: everything lies in planes that boxes, cells and splits have too.
struct HeightField {
  static constexpr int kSize = 128;
  Scene scene;
  RayBatch rays;
  std::vector<float> t;

  HeightField() {
    Random random(35);
    std::vector<int> height;
    for (int i = 0; i < (kSize + 1) * (kSize + 1); ++i) height.push_back(static_cast<int>(random.below(8)));
    const auto at = [&](int x, int y) { return glm::dvec3(x, y, height[static_cast<std::size_t>(y * (kSize + 1) + x)]); };
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        scene.add_triangle(at(x, y), at(x + 1, y), at(x + 1, y + 1));
        scene.add_triangle(at(x, y), at(x + 1, y + 1), at(x, y + 1));
      }
    }
    scene.finish();
    for (int signs = 0; signs < 4; ++signs) {
      for (int y = 0; y <= 2 * kSize; ++y) {
        for (int x = 0; x <= 2 * kSize; ++x) {
          rays.push_back(
              {{0.5f * static_cast<float>(x), 0.5f * static_cast<float>(y), 100}, 0, {signs & 1 ? -0.0f : 0.0f, signs & 2 ? -0.0f : 0.0f, -1}, kInf});
          // Middles of edges and diagonals, all of which run from (x, y) to (x + 1, y + 1).
          t.push_back(static_cast<float>(100 - (at(x / 2, y / 2).z + at((x + 1) / 2, (y + 1) / 2).z) / 2));
        }
      }
    }
  }
};

TEST_P(ClosedMeshes, VerticalRaysMeetAnIntegerHeightFieldExactly) {
  static const HeightField field;
  const TechniqueSpec spec = parse_technique(GetParam().technique);
  const auto structure = spec.structure->build(field.scene, spec.params, 1);
  RayBatch some_rays;
  std::vector<float> some_t;
  for (std::size_t i = 0; i < field.rays.size(); i += 251) {  // in all columns: a row is of 257 rays
    some_rays.push_back(field.rays[i]);
    some_t.push_back(field.t[i]);
  }
  const bool all = kAllRays || !GetParam().is("list");
  const RayBatch& closest = all ? field.rays : some_rays;
  const std::vector<float>& expected = all ? field.t : some_t;
  constexpr std::array kSizes{1, 16, 64};
  for (const Isa isa : kIsas) {
    if (!available(isa)) continue;
    for (const int packet : kSizes) {
      const RayBatch& any = all && packet == size_of_any(kSizes, isa) ? field.rays : some_rays;
      const auto [hits, blockers] = trace(*structure, {isa, packet, spec.params}, closest, any);
      for (std::size_t i = 0; i < closest.size(); ++i)
        ASSERT_EQ(hits.t[i], expected[i]) << closest.org[0][i] << ' ' << closest.org[1][i] << ", " << name(isa) << ", packets of " << packet;
      for (std::size_t i = 0; i < any.size(); ++i)
        ASSERT_GE(blockers[i], 0) << any.org[0][i] << ' ' << any.org[1][i] << ", " << name(isa) << ", packets of " << packet;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Structures, ClosedMeshes, testing::ValuesIn(all_cases()), testing::PrintToStringParamName());

}  // namespace
}  // namespace raymeter
