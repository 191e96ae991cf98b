#pragma once

#include <string>

namespace raymeter {

// Parameters of `bvh`, a group for each thing that has some. BvhParams (bvh.h) is all groups together and says what is allowed; a builder takes the groups that
// it reads. Defaults stand here.

/// Builders that weigh splits, or the merging of leaves, by the surface area heuristic.
struct SahParams {
  int bins = 32;
  int max_leaf_size = 8;
  double node_cost = 1.0;
};

struct GoldsmithSalmonParams {
  std::string insertion_order = "shuffled";
  int insertion_seed = 1;
  int shuffles = 8;
  bool inherited = true;
  bool leaf_boxes = true;
};

struct SbvhParams {
  double split_overlap = 1e-5;
  double split_budget = 1.0;
};

struct PlocParams {
  int ploc_radius = 14;
};

/// Any value but the default gives up right answers for speed (core/geometry/weak_tests.h); accel/weak_settings.h has the names.
struct TestParams {
  std::string box_test = "padded";
  int box_padding = 0;
  std::string box_bounds = "padded";
  std::string reciprocal = "divide";
  std::string triangle_test = "woop_kahan";
  int triangle_epsilon = 0;
  std::string sphere_test = "robust";
  friend bool operator==(const TestParams&, const TestParams&) = default;
};

/// What is done to a hierarchy once it is built.
struct TreeParams {
  int reinsertion = 0;
  int width = 0;
};

}  // namespace raymeter
