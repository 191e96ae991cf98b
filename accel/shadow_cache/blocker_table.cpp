#include "accel/shadow_cache/blocker_table.h"

namespace raymeter {

namespace {

/// The number of each primitive's object.
std::shared_ptr<const Column<std::int32_t>> object_numbers(const Scene& scene) {
  const auto shared = std::make_shared<Column<std::int32_t>>(static_cast<std::size_t>(scene.prim_id_count()));
  Column<std::int32_t>& numbers = *shared;
  std::int32_t next = 0;
  for (std::int32_t id = 0; id < scene.prim_id_count(); ++next) {
    const Object* const object = scene.object_of(id);
    const std::int32_t end = object != nullptr ? object->end_prim : id + 1;
    for (; id < end; ++id) numbers[static_cast<std::size_t>(id)] = next;
  }
  return shared;
}

std::size_t entries_per_light(const ShadowCacheParams& params, const Column<std::int32_t>* objects) {
  if (objects != nullptr) return objects->empty() ? 1 : static_cast<std::size_t>(objects->back()) + 1;
  return params.key == "light_tree" ? static_cast<std::size_t>(RayTree::kNodes) : 1;
}

}  // namespace

BlockerTable::BlockerTable(const Scene& scene, const ShadowCacheParams& params)
    : scene_(scene),
      by_node_(params.key == "light_tree"),
      forgets_(params.forget),
      object_(params.key == "light_object" ? object_numbers(scene) : nullptr),
      stride_(entries_per_light(params, object_.get())),
      entries_(scene.lights.size() * stride_) {}

}  // namespace raymeter
