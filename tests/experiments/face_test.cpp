#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "experiments/scenes/face.h"

namespace raymeter {
namespace {

struct Added {
  std::size_t triangles, polygons;
  std::int32_t ids;
  bool operator==(const Added&) const = default;
};

Added added(const std::vector<glm::dvec3>& vertices, const std::vector<glm::dvec3>& normals = {}) {
  Scene scene;
  add_face(scene, vertices, normals);
  return {scene.pools().triangles.size(), scene.pools().polygons.size(), scene.prim_id_count()};
}

const std::vector<glm::dvec3> kSquare{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

TEST(Face, OfThreeVerticesIsATriangle) { EXPECT_EQ(added({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}), (Added{1, 0, 1})); }

TEST(Face, IsAPolygonWherePlanarAndATriangleFanWhereNot) {
  EXPECT_EQ(added(kSquare), (Added{0, 1, 1}));
  EXPECT_EQ(added({{0, 0, 0}, {1, 0, 0}, {1, 1, 1e-3}, {0, 1, 0}}), (Added{2, 0, 2}));
  EXPECT_EQ(added({{0, 0, 0}, {2, 0, 0}, {3, 1, 0.5}, {2, 2, 0}, {0, 2, 0}}), (Added{3, 0, 3}));
}

TEST(Face, IsAPolygonWhereConcave) { EXPECT_EQ(added({{0, 0, 0}, {1, 0, 0}, {0.2, 0.2, 0.1}, {0, 1, 0}}), (Added{0, 1, 1})); }

TEST(Face, KeepsVertexNormalsThatDiffer) {
  EXPECT_EQ(added(kSquare, {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}}), (Added{0, 1, 1}));
  EXPECT_EQ(added(kSquare, {{0, 0, 1}, {0, 0, 1}, {0, 1, 1}, {0, 0, 1}}), (Added{2, 0, 2}));
}

TEST(Face, WithoutAreaOrFiniteCoordinatesTakesOneId) {
  EXPECT_EQ(added({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}), (Added{0, 1, 1}));
  EXPECT_EQ(added({{0, 0, 0}, {1, 0, 0}, {1, std::numeric_limits<double>::quiet_NaN(), 0}, {0, 1, 0}}), (Added{0, 0, 1}));
  EXPECT_EQ(added({{0, 0, 0}, {1, 0, 0}, {1, std::numeric_limits<double>::infinity(), 0}, {0, 1, 0}}), (Added{0, 0, 1}));
}

}  // namespace
}  // namespace raymeter
