// RayCells: which cells serve a batch.

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include <tbb/parallel_for.h>

#include "accel/ray_classification/ray_cells.h"

namespace raymeter {

namespace {

/// Where lists do not become shorter, as those of objects that lie on each other, splitting ends: so many splits have to take away a quarter.
constexpr int kPatience = 25;
/// Candidates that are looked at between two looks at the memory.
constexpr std::int64_t kRoundCandidates = 1 << 20;

/// The first of rays [begin, end) whose keys are not below `key`.
std::int32_t lower_bound(const RayOrder& rays, std::int32_t begin, std::int32_t end, std::uint64_t key) noexcept {
  const std::uint64_t* const first = rays.key.data();
  return static_cast<std::int32_t>(std::lower_bound(first + begin, first + end, key) - first);
}

}  // namespace

void RayCells::serve(const RayOrder& rays) {
  ++batch_;
  for (const Share& leaf : leaves_) leaf.cell->held = false;
  leaves_.clear();
  held_bytes_ = 0;
  begin_with_classes(rays);

  bool full = false;
  std::vector<Share> now, round;
  for (std::size_t level = waiting_.size(); level-- > 0;) {
    while (!waiting_[level].empty()) {
      now.swap(waiting_[level]);
      waiting_[level].clear();
      std::int64_t candidates = 0;
      for (const Share& share : now) {
        const std::size_t cost = 2 * (list_bytes(share.cell->count) + cell_bytes());
        if (full || !worth_splitting(share)) {
          leaves_.push_back(share);
          continue;
        }
        if (candidates > kRoundCandidates) {
          split_round(rays, round);
          candidates = 0;
        }
        full = held_bytes_ + cost > budget_;
        if (full) {
          leaves_.push_back(share);
          continue;
        }
        held_bytes_ += cost;
        candidates += share.cell->count;
        round.push_back(share);
      }
      split_round(rays, round);
      now.clear();
    }
  }
  publish(rays);
}

void RayCells::begin_with_classes(const RayOrder& rays) {
  const auto ray_count = static_cast<std::int32_t>(rays.key.size());
  for (std::int32_t c = 0; c < kRayClasses; ++c) {
    const int bits = scene_.space.key_bits();
    const std::int32_t begin = lower_bound(rays, 0, ray_count, static_cast<std::uint64_t>(c) << bits);
    const std::int32_t end = lower_bound(rays, begin, ray_count, static_cast<std::uint64_t>(c + 1) << bits);
    if (begin == end) {
      held_bytes_ += cell_bytes();  // another batch may have left it here, and it stays
      continue;
    }
    std::unique_ptr<Cell>& cell = class_cell_[static_cast<std::size_t>(c)];
    if (!cell) {
      make_room(cell_bytes());
      cell = new_cell({{}, static_cast<std::uint8_t>(c), 0}, nullptr);
      cell->count = static_cast<std::int32_t>(scene_.prims.size());
    }
    wait({cell.get(), begin, end});
  }
}

bool RayCells::worth_splitting(const Share& share) const noexcept {
  const Cell& cell = *share.cell;
  return cell.count > leaf_size_ && share.end - share.begin >= min_rays_ && cell.address.depth < scene_.space.depth(cell.address.ray_class) &&
         cell.address.depth - cell.shrunk_depth < kPatience;
}

/// Puts a cell that has rays where the next to be split are looked for.
void RayCells::wait(const Share& share) {
  Cell& cell = *share.cell;
  cell.used = batch_;
  cell.held = true;
  held_bytes_ += list_bytes(cell.count) + cell_bytes();
  const std::uint64_t work = static_cast<std::uint64_t>(share.end - share.begin) * static_cast<std::uint64_t>(cell.count);
  waiting_[work > 0 ? static_cast<std::size_t>(std::bit_width(work)) - 1 : 0].push_back(share);
}

/// Replaces the cells of `round`, whose halves held_bytes_ has room for, by those of their halves that have rays.
void RayCells::split_round(const RayOrder& rays, std::vector<Share>& round) {
  std::vector<std::int32_t> middle(round.size());
  tbb::parallel_for(std::size_t{0}, round.size(), [&](std::size_t i) {
    const Share& share = round[i];
    const int bit = scene_.space.key_bits() - 1 - share.cell->address.depth;
    const std::uint64_t upper = ((rays.key[static_cast<std::size_t>(share.begin)] >> bit) | 1u) << bit;
    middle[i] = lower_bound(rays, share.begin, share.end, upper);
  });

  make_halves(round, middle);
  for (std::size_t i = 0; i < round.size(); ++i) {
    const Share share = round[i];
    Cell& cell = *share.cell;
    cell.held = false;
    held_bytes_ -= 3 * list_bytes(cell.count) + 2 * cell_bytes();  // the cell itself goes on to count
    if (middle[i] > share.begin) wait({cell.child[0].get(), share.begin, middle[i]});
    if (middle[i] < share.end) wait({cell.child[1].get(), middle[i], share.end});
  }
  round.clear();
}

/// Makes those halves that have rays and are not there, from the lists of the cells that are split. Halves that are there are the batch's from now on: else
/// making room for the others might remove them, to be made again.
void RayCells::make_halves(const std::vector<Share>& round, const std::vector<std::int32_t>& middle) {
  const auto has_rays = [&](std::size_t i, std::size_t side) noexcept { return side == 0 ? middle[i] > round[i].begin : middle[i] < round[i].end; };
  for (std::size_t i = 0; i < round.size(); ++i) {
    for (std::size_t side = 0; side < 2; ++side) {
      if (const auto& child = round[i].cell->child[side]; has_rays(i, side) && child) child->used = batch_;
    }
  }
  std::size_t needed = 0;
  std::vector<Cell*> without_list, fresh;
  for (std::size_t i = 0; i < round.size(); ++i) {
    const Cell& cell = *round[i].cell;
    bool makes = false;
    for (std::size_t side = 0; side < 2; ++side) {
      if (!has_rays(i, side) || cell.child[side]) continue;
      makes = true;
      needed += list_bytes(cell.count) + cell_bytes();
    }
    if (!makes || cell.list) continue;
    needed += list_bytes(cell.count);
    without_list.push_back(round[i].cell);
  }
  if (needed > 0) make_room(needed);
  make_lists(without_list);
  for (std::size_t i = 0; i < round.size(); ++i) {
    for (std::size_t side = 0; side < 2; ++side) {
      Cell& parent = *round[i].cell;
      if (!has_rays(i, side) || parent.child[side]) continue;
      CellAddress address = parent.address;
      std::uint16_t& index = address.index[static_cast<std::size_t>(scene_.space.split_axis(address.ray_class, address.depth++))];
      index = static_cast<std::uint16_t>(2 * index + side);
      parent.child[side] = new_cell(address, &parent);
      fresh.push_back(parent.child[side].get());
    }
  }
  make_lists(fresh);
}

/// Of cells of which none is another's ancestor. All threads find lists, but one keeps them: the heap gives threads memory of their own, and what lists of one
/// leave free would not serve those of another. Lists that are longer than a block are found one by one.
void RayCells::make_lists(const std::vector<Cell*>& cells) {
  std::vector<std::vector<Candidate>> found;
  for (std::size_t first = 0, last = 0; first < cells.size(); first = last) {
    for (std::size_t candidates = 0; last < cells.size(); ++last) {
      candidates += made_from(*cells[last]);
      if (candidates > block_ && last > first) break;
    }
    found.resize(last - first);
    tbb::parallel_for(first, last, [&](std::size_t i) { found[i - first] = list_of(*cells[i]); });
    std::size_t found_bytes = 0;
    for (const auto& list : found) found_bytes += list.size() * sizeof(Candidate);
    for (std::size_t i = first; i < last; ++i) {
      std::vector<Candidate>& list = found[i - first];
      keep(*cells[i], list);
      most_bytes_ = std::max(most_bytes_, bytes_ + found_bytes);
      found_bytes -= list.size() * sizeof(Candidate);
      list = {};
    }
  }
}

/// Makes the lists that serving cells lack, and tells each ray its cell.
void RayCells::publish(const RayOrder& rays) {
  std::vector<Cell*> missing;
  std::size_t needed = 0;
  for (const Share& leaf : leaves_) {
    const Cell& cell = *leaf.cell;
    if (cell.list || cell.count == 0) continue;
    missing.push_back(leaf.cell);
    needed += list_bytes(cell.count);
  }
  if (needed > 0) make_room(needed);
  make_lists(missing);

  cell_of_rays_.resize(rays.key.size());
  served_.resize(leaves_.size());
  tbb::parallel_for(std::size_t{0}, leaves_.size(), [&](std::size_t i) {
    const Cell& cell = *leaves_[i].cell;
    served_[i] = {cell.list.get(), std::min(cell.count, most_candidates_), cell.address.ray_class};
    std::fill(cell_of_rays_.data() + leaves_[i].begin, cell_of_rays_.data() + leaves_[i].end, static_cast<std::int32_t>(i));
  });
  const auto prim_count = static_cast<std::int32_t>(scene_.prims.size());
  const int bits = scene_.space.key_bits();
  const auto ray_count = static_cast<std::int32_t>(rays.key.size());
  std::int32_t begin = lower_bound(rays, 0, ray_count, static_cast<std::uint64_t>(kUnclassified) << bits);
  const std::int32_t nowhere = lower_bound(rays, begin, ray_count, static_cast<std::uint64_t>(kNowhere) << bits);
  for (const auto& [ray_class, end] : {std::pair{kUnclassified, nowhere}, std::pair{kNowhere, ray_count}}) {
    std::fill(cell_of_rays_.data() + begin, cell_of_rays_.data() + end, static_cast<std::int32_t>(served_.size()));
    served_.push_back({nullptr, prim_count, ray_class});
    begin = end;
  }
  find_stats();
}

void RayCells::find_stats() noexcept {
  stats_ = {};
  stats_.cells = static_cast<std::int64_t>(leaves_.size());
  double part = 0, leaf_bytes = 0;
  for (const Share& leaf : leaves_) {
    const Cell& cell = *leaf.cell;
    stats_.candidates += cell.count;
    part += std::ldexp(1.0 / kRayClasses, -cell.address.depth);
    leaf_bytes += static_cast<double>(list_bytes(cell.count) + cell_bytes());
  }
  stats_.bytes = bytes_;
  stats_.full_bytes = part > 0 ? leaf_bytes / part : 0;
}

}  // namespace raymeter
