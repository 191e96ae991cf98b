// What every row of the table of builders must keep.

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "accel/bvh/builders.h"
#include "accel/bvh/bvh.h"
#include "core/bounds/aabb_volume.h"
#include "core/trace/trace.h"
#include "tests/support/answer.h"
#include "tests/support/grid_rays.h"
#include "tests/support/random.h"

namespace raymeter {
namespace {

bool equal(const Aabb& a, const Aabb& b) { return a.min == b.min && a.max == b.max; }

bool inside(const Aabb& inner, const Aabb& outer) {
  return glm::all(glm::greaterThanEqual(inner.min, outer.min)) && glm::all(glm::lessThanEqual(inner.max, outer.max));
}

bool inside(const glm::dvec3& point, const Aabb& box) {
  return glm::all(glm::greaterThanEqual(point, glm::dvec3(box.min))) && glm::all(glm::lessThanEqual(point, glm::dvec3(box.max)));
}

std::uint32_t key(PrimRef ref) { return static_cast<std::uint32_t>(ref.kind_bits) << 29 | ref.index; }

BvhParams with(const std::string& builder, int reinsertion = 0, int width = 0) {
  BvhParams params;
  params.builder = builder;
  params.reinsertion = reinsertion;
  params.width = width;
  return params;
}

/// All builders as they are, optimised, and with nodes of several widths.
std::vector<BvhParams> all_params() {
  std::vector<BvhParams> all;
  for (const std::string_view name : bvh_builder_names()) {
    for (const auto& [reinsertion, width] : {std::pair{0, 0}, {2, 0}, {0, 2}, {0, 4}, {1, 8}}) all.push_back(with(std::string(name), reinsertion, width));
  }
  all.push_back(with("goldsmith_salmon"));
  all.back().leaf_boxes = false;
  return all;
}

std::string text(const BvhParams& params) {
  return params.builder + " reinsertion " + std::to_string(params.reinsertion) + " width " + std::to_string(params.width) + (params.leaf_boxes ? "" : " bare");
}

double inner_area(const BvhTree& tree) {
  double sum = 0;
  for (const BvhTree::Node& node : tree.nodes) sum += node.child_count > 0 ? AabbVolume().half_area(node.box) : 0;
  return sum;
}

/// Nodes nest, are reached once each, and the leaves share out the order among them.
void expect_well_formed(const BvhTree& tree) {
  std::vector<int> reached(tree.nodes.size(), 0), held(tree.order.size(), 0);
  reached[0] = 1;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(tree.nodes.size()); ++n) {
    const BvhTree::Node& node = tree.node(n);
    ASSERT_NE(node.child_count > 0, node.prim_count > 0);
    for (std::int32_t c = node.first; c < node.first + node.child_count; ++c) {
      ASSERT_GT(c, n);
      ASSERT_TRUE(inside(tree.node(c).box, node.box));
      ++reached[static_cast<std::size_t>(c)];
    }
    for (std::int32_t i = node.first; i < node.first + node.prim_count; ++i) ++held[static_cast<std::size_t>(i)];
  }
  EXPECT_TRUE(std::ranges::all_of(reached, [](int count) { return count == 1; }));
  EXPECT_TRUE(std::ranges::all_of(held, [](int count) { return count == 1; }));
}

/// The boxes of the leaves that hold each primitive.
std::map<std::uint32_t, std::vector<Aabb>> leaf_boxes(const BvhTree& tree) {
  std::map<std::uint32_t, std::vector<Aabb>> boxes;
  for (const BvhTree::Node& node : tree.nodes) {
    for (std::int32_t i = node.first; i < node.first + node.prim_count; ++i) boxes[key(tree.order[static_cast<std::size_t>(i)])].push_back(node.box);
  }
  return boxes;
}

TEST(Builders, HoldEveryPrimitiveInsideItsLeaves) {
  const Scene scene = test::mixed_scene(3000, 0.2);
  test::Random random(1);
  for (const BvhParams& params : all_params()) {
    SCOPED_TRACE(text(params));
    const BvhTree tree = build_bvh_tree(scene, params, 2);
    expect_well_formed(tree);
    const auto boxes = leaf_boxes(tree);
    ASSERT_EQ(boxes.size(), static_cast<std::size_t>(scene.prim_count()));
    for (std::int32_t id = 0; id < scene.prim_id_count(); ++id) {
      const std::vector<Aabb>& parts = boxes.at(key(scene.prim(id)));
      if (parts.size() == 1) {
        EXPECT_TRUE(inside(padded_bounds(scene.pools(), scene.prim(id)), parts[0])) << "primitive " << id;
        continue;
      }
      ASSERT_EQ(params.builder, "sbvh");
      if (scene.prim(id).kind() != PrimKind::triangle) continue;
      for (int k = 0; k < 50; ++k) {
        glm::dvec3 vertex[3];
        for (std::size_t v = 0; v < 3; ++v) {
          const FloatColumns3& column = scene.pools().triangles.vertex[v];
          const std::size_t i = scene.prim(id).index;
          vertex[v] = {double{column[0][i]}, double{column[1][i]}, double{column[2][i]}};
        }
        double u = random.uniform(), v = random.uniform();
        if (u + v > 1) {
          u = 1 - u;
          v = 1 - v;
        }
        const glm::dvec3 point = (1 - u - v) * vertex[0] + u * vertex[1] + v * vertex[2];
        EXPECT_TRUE(std::ranges::any_of(parts, [&](const Aabb& part) { return inside(point, part); })) << "primitive " << id;
      }
    }
  }
}

TEST(Builders, DoNotDependOnThreads) {
  const Scene scene = test::mixed_scene(9000, 0.03);  // more than one task builds
  for (const BvhParams& params : all_params()) {
    SCOPED_TRACE(text(params));
    const BvhTree one = build_bvh_tree(scene, params, 1);
    for (const int threads : {2, 7}) {
      const BvhTree many = build_bvh_tree(scene, params, threads);
      // The links of the traversal are laid out depth first from any numbering.
      const BvhTree a = depth_first(one), b = depth_first(many);
      EXPECT_TRUE(a.order == b.order);
      EXPECT_TRUE(std::ranges::equal(a.nodes, b.nodes, [](const BvhTree::Node& p, const BvhTree::Node& q) {
        return equal(p.box, q.box) && p.first == q.first && p.child_count == q.child_count && p.prim_count == q.prim_count;
      }));
    }
  }
}

Scene spheres(int count, auto&& center, auto&& radius) {
  Scene scene;
  for (int i = 0; i < count; ++i) scene.add_sphere(center(i), radius(i));
  scene.finish();
  return scene;
}

/// With corners from a generator.
template <class Corner>
Scene triangles(int count, Corner corner) {
  Scene scene;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 a = corner(), b = corner();
    scene.add_triangle(a, b, corner());
  }
  scene.finish();
  return scene;
}

/// Inputs on which builders are known to hang, to recurse without end or to take quadratic time.
std::vector<Scene> hard_inputs() {
  const auto named = [](const char* name, Scene scene) {
    scene.name = name;
    return scene;
  };
  const auto same = [](auto value) { return [value](int) { return value; }; };
  test::Random random(3);
  std::vector<Scene> scenes;
  scenes.push_back(named("none", Scene()));
  scenes.push_back(named("one", spheres(1, same(glm::dvec3(1, 2, 3)), same(1.0))));
  scenes.push_back(named("identical", spheres(100000, same(glm::dvec3(1, 2, 3)), same(1.0))));
  scenes.push_back(named("concentric", spheres(2000, same(glm::dvec3(0.0)), [](int i) { return 1.0 + i; })));
  scenes.push_back(named("shrinking", spheres(2000, same(glm::dvec3(0.0)), [](int i) { return 2000.0 - i; })));
  scenes.push_back(named("flat", triangles(2000, [&] { return glm::dvec3(random.uniform(0, 4), random.uniform(0, 4), 2); })));
  scenes.push_back(named("linear", spheres(
                                       5000, [](int i) { return glm::dvec3(8e-4 * i, 2, 2); }, same(0.25))));
  scenes.push_back(named("on a line", triangles(2000, [&] { return random.uniform(0, 4) * glm::dvec3(1, 1, 1); })));
  scenes.push_back(named("growing", spheres(
                                        76, [](int i) { return glm::dvec3(std::pow(10.0, i - 38), 0, 0); }, same(0.0))));
  scenes.push_back(named("doubling", spheres(
                                         120, [](int i) { return glm::dvec3(std::ldexp(1.0, i), 0, 0); }, [](int i) { return std::ldexp(1.0, i); })));
  scenes.push_back(
      named("huge among tiny", spheres(
                                   2000, [&](int i) { return i == 700 ? glm::dvec3(0.0) : random.in_cube(); }, [](int i) { return i == 700 ? 1e6 : 1e-4; })));
  return scenes;
}

TEST(Builders, EndOnHardInputsWithRightHits) {
  const StructureEntry& list = structure_entry("list");
  for (const Scene& scene : hard_inputs()) {
    const RayBatch rays = test::random_rays(60, 4);
    HitBatch expected, found;
    trace_closest(*list.build(scene, {}, 1)->intersector({Isa::scalar, 1, {}}), rays, expected, 1);
    const auto hits = std::ranges::count_if(expected.prim.span(), [](std::int32_t prim) { return prim >= 0; });
    EXPECT_TRUE(hits > 0 || scene.name == "none" || scene.name == "on a line" || scene.name == "growing") << scene.name;
    for (BvhParams params : all_params()) {
      for (const char* order : {"file", "sorted", "shuffled"}) {
        params.insertion_order = order;
        const bool of_insertion = params.builder == "goldsmith_salmon" && params.reinsertion == 0 && params.width == 0;
        if (!of_insertion && params.insertion_order != "shuffled") continue;
        if (params.width == 2 || params.width == 4) continue;  // for time's sake
        SCOPED_TRACE(scene.name + ", " + text(params) + ", " + order);
        const ParamValues values = resolved(params);
        const auto structure = build_bvh(scene, values, 2);
        trace_closest(*structure->intersector({Isa::scalar, 4, values}), rays, found, 1);
        EXPECT_TRUE(bits_equal(found, expected));
      }
    }
  }
}

TEST(Builders, EndOnHardInputsWithAnyVolumeAndTraversal) {
  const StructureEntry& list = structure_entry("list");
  for (const Scene& scene : hard_inputs()) {
    const RayBatch rays = test::random_rays(40, 4);
    HitBatch expected, found;
    trace_closest(*list.build(scene, {}, 1)->intersector({Isa::scalar, 1, {}}), rays, expected, 1);
    for (const std::string_view builder : bvh_builder_names()) {
      for (const char* volume : {"sphere", "aabb", "obb", "kdop"}) {
        const std::string technique = "bvh:builder=" + std::string(builder) + ",volume=" + volume;
        const TechniqueSpec spec = parse_technique(technique + ",traversal=packet");
        const auto structure = spec.structure->build(scene, spec.params, 2);
        for (const char* traversal : {",traversal=packet", ",traversal=heap"}) {
          SCOPED_TRACE(scene.name + ", " + technique + traversal);
          trace_closest(*structure->intersector({Isa::scalar, 4, parse_technique(technique + traversal).params}), rays, found, 1);
          EXPECT_TRUE(bits_equal(found, expected));
        }
      }
      SCOPED_TRACE(scene.name + ", beam, " + std::string(builder));
      const TechniqueSpec spec = parse_technique("bvh:traversal=beam,builder=" + std::string(builder));
      trace_closest(*spec.structure->build(scene, spec.params, 2)->intersector({Isa::scalar, 4, spec.params}), rays, found, 1);
      EXPECT_TRUE(bits_equal(found, expected));
    }
  }
}

TEST(Builders, WidthBoundsTheChildren) {
  const Scene scene = test::mixed_scene(3000, 0.1);
  for (const std::string_view name : bvh_builder_names()) {
    for (const int width : {2, 3, 4, 8}) {
      const BvhTree tree = build_bvh_tree(scene, with(std::string(name), 0, width), 1);
      std::int32_t most = 0;
      for (const BvhTree::Node& node : tree.nodes) most = std::max(most, node.child_count);
      EXPECT_EQ(most, width) << name;
    }
  }
  EXPECT_THROW(static_cast<void>(build_bvh_tree(scene, with("lbvh", 0, 1), 1)), Error);
}

TEST(Builders, ReinsertionNeverAddsArea) {
  const Scene scene = test::mixed_scene(3000, 0.1);
  for (const std::string_view name : bvh_builder_names()) {
    double before = inner_area(build_bvh_tree(scene, with(std::string(name), 0, 2), 1));
    for (const int passes : {1, 2, 5}) {
      const double after = inner_area(build_bvh_tree(scene, with(std::string(name), passes), 1));
      // Each move gains in double; the sum has some thousand terms, each rounded.
      EXPECT_LE(after, before * (1 + 1e-12)) << name << " " << passes;
      before = after;
    }
  }
}

}  // namespace
}  // namespace raymeter
