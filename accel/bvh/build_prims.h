#pragma once

#include <cstdint>
#include <vector>

#include "core/bounds/aabb.h"
#include "core/scene/scene.h"

namespace raymeter {

/// What builders put into leaves: a primitive and its padded box.
struct BuildPrim {
  Aabb box;
  PrimRef ref;
};

/// All primitives that can be hit, in the order of their ids. Runs in the caller's task arena.
[[nodiscard]] std::vector<BuildPrim> build_prims(const Scene& scene);

/// Their ids alone.
[[nodiscard]] std::vector<PrimRef> prims_that_can_be_hit(const Scene& scene);

}  // namespace raymeter
