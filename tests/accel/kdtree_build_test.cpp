#include <array>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "accel/kdtree/kd_topology.h"
#include "accel/kdtree/kd_tree.h"
#include "tests/support/grid_rays.h"
#include "tests/support/test_scenes.h"

namespace raymeter {
namespace {

using namespace test;

KdTopology by_heuristic(const Scene& scene, const KdTreeParams& params = {}, int threads = 1) {
  return build_kd_topology(
      scene, params, [&](std::span<const SplitReference> references, const Aabb& cell, int) { return cheapest_kd_plane(references, cell, params); }, threads);
}

KdTopology by_halves(const Scene& scene, const BspParams& params = {}, int threads = 1) {
  return build_kd_topology(
      scene, params, [](std::span<const SplitReference>, const Aabb& cell, int depth) { return median_kd_plane(cell, depth); }, threads);
}

bool same(const KdTopology& a, const KdTopology& b) {
  const auto same_node = [](const KdTopology::Node& m, const KdTopology::Node& n) {
    return m.axis == n.axis && m.position == n.position && m.link == n.link && m.count == n.count;
  };
  return a.references == b.references && std::ranges::equal(a.nodes, b.nodes, same_node);
}

/// Calls body(leaf, its cell, its depth) for each leaf.
template <class Body>
void for_each_leaf(const KdTopology& tree, Body&& body, std::size_t at, const Aabb& cell, int depth) {
  const KdTopology::Node& node = tree.nodes[at];
  if (node.axis < 0) return body(node, cell, depth);
  Aabb low = cell, high = cell;
  low.max[node.axis] = high.min[node.axis] = node.position;
  for_each_leaf(tree, body, at + 1, low, depth + 1);
  for_each_leaf(tree, body, static_cast<std::size_t>(node.link), high, depth + 1);
}
template <class Body>
void for_each_leaf(const KdTopology& tree, Body&& body) {
  for_each_leaf(tree, body, 0, tree.cell, 0);
}

bool lists(const KdTopology& tree, const KdTopology::Node& leaf, PrimRef prim) {
  const auto begin = tree.references.begin() + leaf.link;
  return std::find(begin, begin + leaf.count, prim) != begin + leaf.count;
}

/// Whether a leaf whose closed cell, grown by `slack`, holds the point lists the primitive.
bool finds(const KdTopology& tree, PrimRef prim, const glm::dvec3& p, double slack) {
  std::vector<std::size_t> open{0};
  while (!open.empty()) {
    const std::size_t at = open.back();
    open.pop_back();
    const KdTopology::Node& node = tree.nodes[at];
    if (node.axis < 0) {
      if (lists(tree, node, prim)) return true;
      continue;
    }
    if (p[node.axis] <= double{node.position} + slack) open.push_back(at + 1);
    if (p[node.axis] >= double{node.position} - slack) open.push_back(static_cast<std::size_t>(node.link));
  }
  return false;
}

Scene triangles_of(int count, double size, unsigned seed) {
  std::mt19937 random(seed);
  Scene scene;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 p = point(random), e = size * (point(random) - 0.5), f = size * (point(random) - 0.5);
    scene.add_triangle(p, p + e, p + f);
  }
  scene.finish();
  return scene;
}

/// Unit cubes with a gap of one between them, each of six squares in planes of the axes.
Scene row_of_cubes(int count) {
  Scene scene;
  for (int i = 0; i < count; ++i) {
    for (glm::length_t a = 0; a < 3; ++a) {
      for (const double side : {0.0, 1.0}) {
        glm::dvec3 corner(2.0 * i, 0, 0), u(0.0), v(0.0);
        corner[a] += side;
        u[(a + 1) % 3] = v[(a + 2) % 3] = 1;
        scene.add_polygon(std::array{corner, corner + u, corner + u + v, corner + v});
      }
    }
  }
  scene.finish();
  return scene;
}

TEST(KdTreeBuild, PointsOfTrianglesAreInLeavesThatListThem) {
  for (const double size : {0.05, 0.5, 2.0}) {
    const Scene scene = triangles_of(500, size, 3);
    for (const KdTopology& tree : {by_heuristic(scene), by_halves(scene)}) {
      std::mt19937 random(4);
      for (std::size_t i = 0; i < 500; ++i) {
        const PrimRef ref = prim_ref(PrimKind::triangle, i);
        glm::dvec3 corner[3];
        for (std::size_t v = 0; v < 3; ++v) {
          const FloatColumns3& c = scene.pools().triangles.vertex[v];
          corner[v] = {c[0][i], c[1][i], c[2][i]};
        }
        for (int k = 0; k < 40; ++k) {
          double s = uniform(random), t = uniform(random) * (1 - s);
          if (k % 4 == 0) s = t = 0;  // a vertex
          if (k % 4 == 1) t = 0;      // on an edge
          // The point's own rounding is all that is allowed for.
          ASSERT_TRUE(finds(tree, ref, corner[0] + s * (corner[1] - corner[0]) + t * (corner[2] - corner[0]), 0x1p-48)) << "triangle " << i << " point " << k;
        }
      }
    }
  }
}

TEST(KdTreeBuild, BoxesOfOtherKindsAreInEveryLeafThatTheyReachInto) {
  const Scene scene = mixed_scene(200, 0.3);
  for (const KdTopology& tree : {by_heuristic(scene), by_halves(scene)}) {
    for_each_leaf(tree, [&](const KdTopology::Node& leaf, const Aabb& cell, int) {
      for (std::int32_t id = 0; id < scene.prim_id_count(); ++id) {
        const PrimRef ref = scene.prim(id);
        const Aabb box = tight_bounds(scene.pools(), ref);
        const bool inside = glm::all(glm::lessThan(box.min, cell.max)) && glm::all(glm::greaterThan(box.max, cell.min));
        const bool touches = glm::all(glm::lessThanEqual(box.min, cell.max)) && glm::all(glm::greaterThanEqual(box.max, cell.min));
        const bool listed = lists(tree, leaf, ref);
        ASSERT_TRUE(listed || !inside || ref.kind() == PrimKind::triangle) << id;
        ASSERT_TRUE(touches || !listed) << id;
      }
    });
  }
}

TEST(KdTreeBuild, DoesNotDependOnThreads) {
  const Scene scene = mixed_scene(20000, 0.02);
  const KdTopology tree = by_heuristic(scene), halves = by_halves(scene);
  for (const int threads : {2, 7}) {
    EXPECT_TRUE(same(tree, by_heuristic(scene, {}, threads))) << threads;
    EXPECT_TRUE(same(halves, by_halves(scene, {}, threads))) << threads;
  }
}

/// The least cost of any plane where a reference begins or ends, by trying them all.
double least_cost(std::span<const SplitReference> references, const Aabb& cell, const KdTreeParams& params, const std::function<double(const KdPlane&)>& cost) {
  double least = params.intersection_cost * static_cast<double>(references.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (const SplitReference& reference : references) {
      for (const float x : {reference.box.min[axis], reference.box.max[axis]}) {
        if (cell.min[axis] < x && x < cell.max[axis]) least = std::min({least, cost({axis, x, true}), cost({axis, x, false})});
      }
    }
  }
  return least;
}

TEST(KdTreeBuild, PlanesAreTheCheapest) {
  const KdTreeParams params;
  for (const int count : {1, 2, 5, 20, 32, 33, 100, 1000, 3000}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const Scene scene = triangles_of(count, 0.1, seed);
      std::vector<SplitReference> references;
      Aabb cell;
      for (std::int32_t id = 0; id < count; ++id) {
        references.push_back({tight_bounds(scene.pools(), scene.prim(id)), scene.prim(id)});
        cell.grow(references.back().box);
      }
      const auto cost = [&](const KdPlane& plane) {
        if (plane.axis < 0) return params.intersection_cost * count;
        Aabb low = cell, high = cell;
        low.max[plane.axis] = high.min[plane.axis] = plane.position;
        int below = 0, above = 0;
        for (const SplitReference& r : references) {
          const bool in_low = r.box.min[plane.axis]<plane.position, in_high = r.box.max[plane.axis]> plane.position;
          below += in_low || (!in_high && plane.flat_below) ? 1 : 0;
          above += in_high || (!in_low && !plane.flat_below) ? 1 : 0;
        }
        const double tests = (double{low.half_area()} * below + double{high.half_area()} * above) / double{cell.half_area()};
        return (params.traversal_cost + params.intersection_cost * tests) * (below == 0 || above == 0 ? 1 - params.empty_bonus : 1.0);
      };
      // The heuristic gives every extent a millionth more; the bins that are swept need not hold the very cheapest plane.
      const double slack = count <= 32 ? 1 + 1e-5 : 1.005;
      EXPECT_LE(cost(cheapest_kd_plane(references, cell, params)), slack * least_cost(references, cell, params, cost)) << count << " seed " << seed;
    }
  }
}

TEST(KdTreeBuild, CutsOffEmptySpaceAtItsEnd) {
  Scene scene;
  for (int i = 0; i < 16; ++i) scene.add_sphere({i < 8 ? 0 : 10, 0, 0}, 0.5);
  scene.finish();
  const KdTopology tree = by_heuristic(scene);
  ASSERT_EQ(tree.nodes[0].axis, 0);
  EXPECT_TRUE(tree.nodes[0].position == 0.5f || tree.nodes[0].position == 9.5f) << tree.nodes[0].position;
  EXPECT_EQ(kd_stats(tree).empty_leaves, 1);
}

TEST(KdTreeBuild, PlanesStandInWallsAndCutNone) {
  const Scene scene = row_of_cubes(16);
  const BuildStats stats = kd_stats(by_heuristic(scene));
  EXPECT_EQ(stats.references, scene.prim_count());  // no square is in two leaves
}

TEST(KdTreeBuild, BspHalvesTheAxesInTurn) {
  const Scene scene = triangles_of(300, 0.2, 8);
  BspParams params;
  params.reference_budget = 1000;
  const KdTopology tree = by_halves(scene, params);
  const std::function<void(std::size_t, const Aabb&, int)> check = [&](std::size_t at, const Aabb& cell, int depth) {
    const KdTopology::Node& node = tree.nodes[at];
    if (node.axis < 0) {
      EXPECT_TRUE(node.count <= 2 || depth == 16);
      return;
    }
    EXPECT_EQ(node.axis, depth % 3);
    EXPECT_EQ(node.position, static_cast<float>((double{cell.min[node.axis]} + double{cell.max[node.axis]}) / 2));
    Aabb low = cell, high = cell;
    low.max[node.axis] = high.min[node.axis] = node.position;
    check(at + 1, low, depth + 1);
    check(static_cast<std::size_t>(node.link), high, depth + 1);
  };
  check(0, tree.cell, 0);
}

TEST(KdTreeBuild, ParametersAreKept) {
  const Scene scene = triangles_of(2000, 0.1, 9);
  for (const int max_depth : {1, 5, 12}) {
    KdTreeParams params;
    params.max_depth = max_depth;
    EXPECT_LE(*kd_stats(by_heuristic(scene, params)).max_depth, max_depth);
  }
  EXPECT_LE(*kd_stats(by_heuristic(scene)).max_depth, 22);  // 8 + 1.3 log2 2000
  BspParams few;
  few.reference_budget = 1;
  EXPECT_LE(kd_stats(by_halves(scene, few)).references, 2000 + 4096);
  EXPECT_GT(kd_stats(by_halves(scene)).references, 2000 + 4096);
  KdTreeParams boxes;
  boxes.clip = false;
  EXPECT_GT(kd_stats(by_heuristic(scene, boxes)).references, kd_stats(by_heuristic(scene)).references);
}

TEST(KdTreeBuild, EndsOnDegenerateInput) {
  const auto build_both = [](const Scene& scene) {
    for (const KdTopology& tree : {by_heuristic(scene, {}, 2), by_halves(scene, {}, 2)}) {
      const BuildStats stats = kd_stats(tree);
      EXPECT_LE(stats.references, 32 * scene.prim_count() + 4096);
      EXPECT_EQ(lay_out(scene, tree).refs.size(), static_cast<std::size_t>(stats.references));
    }
  };
  build_both(Scene());
  Scene triangles, spheres, points, line, flat, nested;
  for (int i = 0; i < 100000; ++i) {
    triangles.add_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 1});
    spheres.add_sphere({1, 2, 3}, 0.5);
    points.add_sphere({0, 0, 0}, 0);
    line.add_sphere({i, 0, 0}, 0);
  }
  for (int i = 0; i < 2000; ++i) {
    flat.add_triangle({i, 0, 2}, {i + 1, 0, 2}, {i, 5, 2});
    nested.add_sphere({0, 0, 0}, std::pow(0.99, i));
  }
  nested.add_sphere({1e6, 0, 0}, 1e5);
  for (Scene* scene : {&triangles, &spheres, &points, &line, &flat, &nested}) {
    scene->finish();
    build_both(*scene);
  }
  EXPECT_LT(*kd_stats(by_heuristic(line)).sah_cost, 100);  // where there is no area, lengths tell
}

TEST(ClippedTriangle, HasTheBoxOfThePartInside) {
  Scene scene;
  scene.add_triangle({0, 0, 0}, {4, 0, 0}, {0, 4, 4});
  scene.finish();
  const PrimRef ref = scene.prim(0);
  const Aabb part = clipped(scene.pools(), ref, {{1, -1, 1}, {2, 5, 5}});
  // Between x = 1 and x = 2, above z = 1: corners (1, 1, 1), (2, 1, 1), (2, 2, 2), (1, 3, 3). The rounding outwards takes a unit in the last place.
  EXPECT_EQ(part.min.x, 1);
  EXPECT_EQ(part.max.x, 2);
  EXPECT_FLOAT_EQ(part.min.y, 1);
  EXPECT_LE(part.min.y, 1);
  EXPECT_EQ(part.min.z, 1);
  EXPECT_FLOAT_EQ(part.max.y, 3);
  EXPECT_FLOAT_EQ(part.max.z, 3);
  EXPECT_GE(part.max.z, 3);
  EXPECT_TRUE(clipped(scene.pools(), ref, {{2, 2.5f, 0}, {4, 4, 4}}).empty());  // its box meets the triangle's, but not the triangle
  EXPECT_FALSE(clipped(scene.pools(), ref, {{4, 0, 0}, {5, 1, 1}}).empty());    // a vertex on the border
  const Aabb whole = clipped(scene.pools(), ref, {{-1, -1, -1}, {9, 9, 9}});
  EXPECT_EQ(whole.min, glm::vec3(0.0f));
  EXPECT_EQ(whole.max, glm::vec3(4.0f));
}

}  // namespace
}  // namespace raymeter
