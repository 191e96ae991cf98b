// RayCells: what cells list, and what is kept.

#include <algorithm>
#include <limits>
#include <numeric>

#include "accel/ray_classification/ray_cells.h"
#include "core/base/threads.h"

namespace raymeter {

ClassifiedScene::ClassifiedScene(const Scene& scene, const RayClassificationParams& params, int threads)
    : pools(scene.pools()),
      prims([&] {
        std::vector<PrimRef> all;
        for (std::size_t kind = 0; kind < kPrimKindCount; ++kind) {
          first_prim[kind] = all.size();
          for (std::size_t i = 0; i < pools.size(static_cast<PrimKind>(kind)); ++i) all.push_back(prim_ref(static_cast<PrimKind>(kind), i));
        }
        return all;
      }()),
      boxes(prims.size()),
      space([&] {
        on_threads(threads, [&] { for_each_index(prims.size(), [&](std::size_t i) { boxes[i] = padded_bounds(pools, prims[i]); }); });
        Aabb whole;
        for (const Aabb& box : boxes) whole.grow(box);
        return RaySpace(whole, params);
      }()) {}

std::size_t ClassifiedScene::mem_bytes() const noexcept { return prims.capacity() * sizeof(PrimRef) + boxes.capacity() * sizeof(Aabb) + space.mem_bytes(); }

RayCells::RayCells(const ClassifiedScene& scene, const RayClassificationParams& params)
    : scene_(scene),
      leaf_size_(params.leaf_size),
      min_rays_(params.min_rays),
      most_candidates_(params.most_candidates > 0 ? params.most_candidates : std::numeric_limits<std::int32_t>::max()),
      budget_(static_cast<std::size_t>(params.memory_mb * 0x1p20)) {
  class_cell_.fill(-1);
}

std::size_t RayCells::list_bytes(std::int32_t count) noexcept {
  constexpr std::size_t kAllocation = 16;  // what the heap adds, and to what it rounds
  return count == 0 ? 0 : (static_cast<std::size_t>(count) * sizeof(Candidate) + 2 * kAllocation - 1) / kAllocation * kAllocation;
}

std::size_t RayCells::least_bytes(const ClassifiedScene& scene) noexcept {
  return kRayClasses * (list_bytes(static_cast<std::int32_t>(scene.prims.size())) + sizeof(Cell));
}

/// Everything, in the order in which it begins.
std::vector<Candidate> RayCells::class_list(std::int32_t ray_class) const {
  const auto axis = static_cast<glm::length_t>(RaySpace::world_axis(ray_class, 2));
  std::vector<Candidate> list(scene_.prims.size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    const PrimRef prim = scene_.prims[i];
    const Aabb& box = scene_.boxes[i];
    list[i] = {(ray_class & 1) != 0 ? -box.max[axis] : box.min[axis], std::uint32_t{prim.kind_bits} << Candidate::kKindShift | prim.index};
  }
  std::sort(list.begin(), list.end(), [](Candidate a, Candidate b) { return a.start != b.start ? a.start < b.start : a.ref < b.ref; });
  return list;
}

/// From the list of the nearest ancestor that is kept, through every split on the way down: the list is the same wherever it begins.
std::vector<Candidate> RayCells::list_of(const Cell& cell) const {
  if (cell.list) return {cell.list.get(), cell.list.get() + cell.count};
  if (cell.parent < 0) return class_list(cell.address.ray_class);
  const Cell& parent = at(cell.parent);
  std::vector<Candidate> above;
  std::span<const Candidate> from;
  if (parent.list) {
    from = {parent.list.get(), static_cast<std::size_t>(parent.count)};
  } else {
    above = list_of(parent);
    from = above;
  }
  const int axis = scene_.space.split_axis(parent.address.ray_class, parent.address.depth);
  const int side = cell.address.index[static_cast<std::size_t>(axis)] & 1;
  const std::uint32_t planes = Beam::planes_changed(axis, side);
  const Beam beam(scene_.space, cell.address);
  std::vector<Candidate> list;
  list.reserve(from.size());
  for (const Candidate candidate : from) {
    if (!beam.meets(planes, scene_.box(candidate))) continue;
    const PrimRef prim = prim_ref(static_cast<PrimKind>(candidate.kind()), static_cast<std::size_t>(candidate.index()));
    if (beam.meets(planes, scene_.pools, prim)) list.push_back(candidate);
  }
  return list;
}

void RayCells::keep(Cell& cell, const std::vector<Candidate>& list) {
  cell.count = static_cast<std::int32_t>(list.size());
  if (!list.empty()) {
    cell.list = std::make_unique_for_overwrite<Candidate[]>(list.size());
    std::copy(list.begin(), list.end(), cell.list.get());
    take(list_bytes(cell.count));
  }
  if (cell.parent < 0) return;
  const Cell& parent = at(cell.parent);
  cell.shrunk_count = parent.shrunk_count;
  cell.shrunk_depth = parent.shrunk_depth;
  if (cell.count <= cell.shrunk_count - cell.shrunk_count / 4) {
    cell.shrunk_count = cell.count;
    cell.shrunk_depth = cell.address.depth;
  }
}

std::int32_t RayCells::new_cell(const CellAddress& address, std::int32_t parent) {
  std::int32_t place = static_cast<std::int32_t>(cells_.size());
  if (free_.empty()) {
    cells_.emplace_back();
  } else {
    place = free_.back();
    free_.pop_back();
  }
  Cell& cell = at(place);
  cell = Cell{};
  cell.address = address;
  cell.parent = parent;
  take(sizeof(Cell));
  return place;
}

void RayCells::take(std::size_t bytes) noexcept {
  bytes_ += bytes;
  most_bytes_ = std::max(most_bytes_, bytes_);
}

void RayCells::drop_list(Cell& cell) noexcept {
  if (!cell.list) return;
  cell.list.reset();
  bytes_ -= list_bytes(cell.count);
}

/// Makes `bytes` fit the budget: lists that do not serve the batch go, least recently used first, and cells that no batch uses any more.
void RayCells::make_room(std::size_t bytes) {
  if (bytes_ + bytes <= budget_) return;
  std::vector<std::int32_t> order;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(cells_.size()); ++i) {
    if (at(i).list && !at(i).held) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return at(a).used < at(b).used; });
  // More than needed, so that it does not have to be done for every few cells.
  const std::size_t wanted = budget_ - std::min(budget_, bytes + budget_ / 8);
  for (const std::int32_t i : order) {
    if (bytes_ <= wanted) return;
    drop_list(at(i));
  }
  remove_unused();
}

/// Children have higher depths than their parents: those go first.
void RayCells::remove_unused() noexcept {
  std::array<std::vector<std::int32_t>, 64> by_depth;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(cells_.size()); ++i) {
    if (at(i).used != 0 && at(i).used != batch_ && at(i).address.depth > 0) by_depth[at(i).address.depth].push_back(i);
  }
  for (std::size_t depth = by_depth.size(); depth-- > 0;) {
    for (const std::int32_t i : by_depth[depth]) {
      Cell& cell = at(i);
      if (cell.child[0] >= 0 || cell.child[1] >= 0) continue;
      Cell& parent = at(cell.parent);
      parent.child[parent.child[0] == i ? 0 : 1] = -1;
      cell.used = 0;
      free_.push_back(i);
      bytes_ -= sizeof(Cell);
    }
  }
}

}  // namespace raymeter
