#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/base/threads.h"
#include "core/bounds/aabb.h"
#include "core/scene/scene.h"

namespace raymeter {

/// What builders put into leaves: a primitive and its padded box.
struct BuildPrim {
  Aabb box;
  PrimRef ref;
};

/// Calls body(place, primitive) for all primitives that can be hit, in parallel; places count them in the order of their ids. Runs in the caller's task arena.
template <class Body>
void for_each_prim_that_can_be_hit(const Scene& scene, Body&& body) {
  constexpr std::size_t kPart = 4096;
  const auto ids = static_cast<std::size_t>(scene.prim_id_count());
  std::vector<std::size_t> first((ids + kPart - 1) / kPart, 0);  // place of each part
  const auto each = [&](std::size_t part, auto&& visit) {
    for (std::size_t id = part * kPart; id < std::min(ids, (part + 1) * kPart); ++id) {
      if (const PrimRef prim = scene.prim(static_cast<std::int32_t>(id)); !prim.dropped()) visit(prim);
    }
  };
  if (scene.dropped_count() > 0) {
    for_each_task(first.size(), [&](std::size_t part) { each(part, [&](PrimRef) { ++first[part]; }); });
    std::exclusive_scan(first.begin(), first.end(), first.begin(), std::size_t{0});
  } else {
    for (std::size_t part = 0; part < first.size(); ++part) first[part] = part * kPart;
  }
  for_each_task(first.size(), [&](std::size_t part) { each(part, [&, place = first[part]](PrimRef prim) mutable { body(place++, prim); }); });
}

/// All primitives that can be hit, in the order of their ids. Runs in the caller's task arena.
[[nodiscard]] std::vector<BuildPrim> build_prims(const Scene& scene);

/// Their ids alone.
[[nodiscard]] std::vector<PrimRef> prims_that_can_be_hit(const Scene& scene);

}  // namespace raymeter
