#include "accel/bvh/build_prims.h"

namespace raymeter {

std::vector<PrimRef> prims_that_can_be_hit(const Scene& scene) {
  std::vector<PrimRef> refs(static_cast<std::size_t>(scene.prim_count()));
  for_each_prim_that_can_be_hit(scene, [&](std::size_t i, PrimRef ref) { refs[i] = ref; });
  return refs;
}

std::vector<BuildPrim> build_prims(const Scene& scene) {
  std::vector<BuildPrim> prims(static_cast<std::size_t>(scene.prim_count()));
  for_each_prim_that_can_be_hit(scene, [&](std::size_t i, PrimRef ref) { prims[i] = {padded_bounds(scene.pools(), ref), ref}; });
  return prims;
}

}  // namespace raymeter
