#include "accel/bvh/build_prims.h"

#include <tbb/parallel_for.h>

namespace raymeter {

std::vector<PrimRef> prims_that_can_be_hit(const Scene& scene) {
  std::vector<PrimRef> refs;
  refs.reserve(static_cast<std::size_t>(scene.prim_count()));
  for (std::int32_t id = 0; id < scene.prim_id_count(); ++id) {
    if (!scene.prim(id).dropped()) refs.push_back(scene.prim(id));
  }
  return refs;
}

std::vector<BuildPrim> build_prims(const Scene& scene) {
  const std::vector<PrimRef> refs = prims_that_can_be_hit(scene);
  std::vector<BuildPrim> prims(refs.size());
  tbb::parallel_for(std::size_t{0}, refs.size(), [&](std::size_t i) { prims[i] = {padded_bounds(scene.pools(), refs[i]), refs[i]}; });
  return prims;
}

}  // namespace raymeter
