#pragma once

#include <string_view>
#include <vector>

#include "accel/bvh/bvh_tree.h"

namespace raymeter {

struct BvhParams;
struct TreeParams;

/// A row of the table of builders. A tree does not depend on `threads` (0: all).
struct BvhBuilder {
  std::string_view name;
  BvhTree (*build)(const Scene& scene, const BvhParams& params, int threads);
};

/// The names of all builders, in the order of the table.
[[nodiscard]] std::vector<std::string_view> bvh_builder_names();

/// Throws Error where a width is asked for that no tree can have.
void check_tree_params(const TreeParams& params);

/// The tree that the parameters describe: by their builder, and what is to be done to it afterwards.
[[nodiscard]] BvhTree build_bvh_tree(const Scene& scene, const BvhParams& params, int threads);

}  // namespace raymeter
