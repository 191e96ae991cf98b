// RayCells: what cells list, and what is kept.

#include <algorithm>
#include <iterator>
#include <limits>

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

namespace {

/// Lists that are being made take one part in so many of the memory, or one class' list.
constexpr std::size_t kBlockShare = 64;
/// And so much is left for what lies free between allocations.
constexpr std::size_t kFreeShare = 16;

/// What the heap takes for an allocation: it adds 8 bytes and rounds to 16; lists are counted as if it added 16, for what lies free between them.
constexpr std::size_t kHeapAdds = 8, kHeapStep = 16;
constexpr std::size_t heap_bytes(std::size_t bytes) noexcept { return (bytes + kHeapAdds + kHeapStep - 1) / kHeapStep * kHeapStep; }

}  // namespace

RayCells::RayCells(const ClassifiedScene& scene, const RayClassificationParams& params)
    : scene_(scene),
      leaf_size_(params.leaf_size),
      min_rays_(params.min_rays),
      most_candidates_(params.most_candidates > 0 ? params.most_candidates : std::numeric_limits<std::int32_t>::max()) {
  constexpr std::size_t kMostBlock = 1 << 17;
  const auto memory = static_cast<std::size_t>(params.memory_mb * 0x1p20);
  block_ = std::min(memory / (kBlockShare * sizeof(Candidate)), kMostBlock);
  const std::size_t making = std::max(memory / kBlockShare, list_bytes(static_cast<std::int32_t>(scene.prims.size())));
  budget_ = memory - std::min(memory, making + memory / kFreeShare);
}

std::size_t RayCells::list_bytes(std::int32_t count) noexcept {
  return count == 0 ? 0 : heap_bytes(static_cast<std::size_t>(count) * sizeof(Candidate) + kHeapAdds);
}

/// With the share of a batch that waits there, and its place among those that serve.
std::size_t RayCells::cell_bytes() noexcept { return heap_bytes(sizeof(Cell)) + sizeof(Share) + sizeof(RayCell); }

std::size_t RayCells::least_bytes(const ClassifiedScene& scene) noexcept {
  const std::size_t list = list_bytes(static_cast<std::int32_t>(scene.prims.size())), kept = kRayClasses * (list + cell_bytes());
  const std::size_t with_making = std::max(kept + list, kept + kept / (kBlockShare / 2));  // more than a part of the whole
  return with_making + with_making / (kFreeShare - 1) + 1;
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
  if (cell.parent == nullptr) return class_list(cell.address.ray_class);
  const Cell& parent = *cell.parent;
  const int axis = scene_.space.split_axis(parent.address.ray_class, parent.address.depth);
  const int side = cell.address.index[static_cast<std::size_t>(axis)] & 1;
  const std::uint32_t planes = Beam::planes_changed(axis, side);
  const Beam beam(scene_.space, cell.address);
  const auto meets = [&](Candidate candidate) {
    if (!beam.meets(planes, scene_.box(candidate))) return false;
    return beam.meets(planes, scene_.pools, prim_ref(static_cast<PrimKind>(candidate.kind()), static_cast<std::size_t>(candidate.index())));
  };
  std::vector<Candidate> list;
  if (parent.list) {
    list.reserve(static_cast<std::size_t>(parent.count));
    std::copy_if(parent.list.get(), parent.list.get() + parent.count, std::back_inserter(list), meets);
  } else {
    list = list_of(parent);
    std::erase_if(list, [&](Candidate candidate) { return !meets(candidate); });
  }
  return list;
}

/// How many candidates list_of() begins with.
std::size_t RayCells::made_from(const Cell& cell) const noexcept {
  const Cell* from = &cell;
  while (!from->list && from->parent != nullptr) from = from->parent;
  return static_cast<std::size_t>(from->count);
}

void RayCells::keep(Cell& cell, const std::vector<Candidate>& list) {
  cell.count = static_cast<std::int32_t>(list.size());
  if (!list.empty()) {
    cell.list = std::make_unique_for_overwrite<Candidate[]>(list.size());
    std::copy(list.begin(), list.end(), cell.list.get());
    take(list_bytes(cell.count));
  }
  if (cell.parent == nullptr) return;
  const Cell* shrunk = cell.parent;
  while (shrunk->address.depth > cell.parent->shrunk_depth) shrunk = shrunk->parent;
  cell.shrunk_depth = cell.count <= shrunk->count - shrunk->count / 4 ? cell.address.depth : shrunk->address.depth;
}

std::unique_ptr<RayCells::Cell> RayCells::new_cell(const CellAddress& address, Cell* parent) {
  auto cell = std::make_unique<Cell>();
  cell->address = address;
  cell->parent = parent;
  take(cell_bytes());
  return cell;
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

/// Makes `bytes` fit the budget: lists that do not serve the batch go, those of the batches that are longest ago first, with the cells that none has used
/// since. Of such a batch all goes at once: where cells stayed among short lists that went, these would leave no room for long ones.
void RayCells::make_room(std::size_t bytes) {
  if (bytes_ + bytes <= budget_) return;
  std::vector<Cell*> spare;
  const auto find_spare = [&](const auto& self, const std::unique_ptr<Cell>& cell) -> void {
    if (!cell) return;
    if (cell->list && !cell->held) spare.push_back(cell.get());
    for (const auto& child : cell->child) self(self, child);
  };
  for (const auto& cell : class_cell_) find_spare(find_spare, cell);
  std::ranges::stable_sort(spare, {}, [](const Cell* cell) { return cell->used; });
  // More than needed, so that it does not have to be done for every few cells.
  const std::size_t wanted = budget_ - std::min(budget_, bytes + budget_ / 8);
  std::uint32_t last = 0;  // batch that loses something
  for (Cell* const cell : spare) {
    if (bytes_ <= wanted && (cell->used == batch_ || cell->used != last)) break;
    last = cell->used;
    drop_list(*cell);
  }
  for (const auto& cell : class_cell_) {
    if (cell) (void)unused(*cell, std::min(last, batch_ - 1));
  }
}

/// Whether neither a batch after `last` nor a cell below uses the cell, whose list is not kept; removes those below of which that is so.
bool RayCells::unused(Cell& cell, std::uint32_t last) noexcept {
  for (auto& child : cell.child) {
    if (!child || !unused(*child, last)) continue;
    child.reset();
    bytes_ -= cell_bytes();
  }
  return !cell.child[0] && !cell.child[1] && !cell.list && cell.used <= last;
}

}  // namespace raymeter
