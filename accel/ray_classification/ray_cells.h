#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "accel/ray_classification/beam.h"
#include "accel/ray_classification/ray_order.h"
#include "core/trace/on_demand.h"

namespace raymeter {

/// What cells are made from: the scene's primitives with their padded boxes, and how its rays are divided. Of the parameters those of a build count.
struct ClassifiedScene {
  ClassifiedScene(const Scene& scene, const RayClassificationParams& params, int threads);

  const Pools& pools;
  std::array<std::size_t, kPrimKindCount> first_prim{};  ///< of each kind in `prims`
  std::vector<PrimRef> prims;
  std::vector<Aabb> boxes;  ///< padded, of each of `prims`
  RaySpace space;

  [[nodiscard]] const Aabb& box(Candidate candidate) const noexcept {
    return boxes[first_prim[candidate.kind()] + static_cast<std::size_t>(candidate.index())];
  }
  [[nodiscard]] std::size_t mem_bytes() const noexcept;
};

/// The tree of cells, made where rays fall, and which of them serve a batch.
///
/// What a cell lists depends on the cell alone, and which cells serve a batch on the batch alone: they are found anew from the classes downwards, the cell
/// whose rays have most candidates to test first, until nothing is worth a split or the next one might not fit the budget. Whatever else is kept, from other
/// batches or on the way down, only saves making it again, and goes, least recently used first, where memory is needed. So neither answers nor counts depend
/// on threads or on what was traced before.
class RayCells {
public:
  /// Of the parameters those of a query count.
  RayCells(const ClassifiedScene& scene, const RayClassificationParams& params);

  /// The least memory in which every batch can be served: the lists of all six classes, and one that is being made.
  [[nodiscard]] static std::size_t least_bytes(const ClassifiedScene& scene) noexcept;

  /// Finds the cells of a batch. Call in an arena of the wanted threads.
  void serve(const RayOrder& rays);

  /// The cells of the batch, and which of them each ray is in, in the order of the rays.
  [[nodiscard]] const std::vector<RayCell>& cells() const noexcept { return served_; }
  [[nodiscard]] const Column<std::int32_t>& cell_of_rays() const noexcept { return cell_of_rays_; }
  [[nodiscard]] const DemandStats& stats() const noexcept { return stats_; }
  /// The most that cells, their lists and those that were being made have taken at any time: never more than memory_mb.
  [[nodiscard]] std::size_t most_bytes() const noexcept { return most_bytes_; }

private:
  /// Each an allocation of its own: what one batch leaves free serves the lists of another.
  struct Cell {
    Cell* parent = nullptr;
    std::array<std::unique_ptr<Cell>, 2> child;
    std::unique_ptr<Candidate[]> list;  ///< null: not kept
    CellAddress address;
    std::int32_t count = 0;         ///< candidates, known also while the list is not kept
    std::uint32_t used = 0;         ///< the last batch that had rays here
    std::uint8_t shrunk_depth = 0;  ///< of the ancestor from which on lists have to have shrunk
    bool held = false;              ///< serves the batch, or may yet
  };
  /// Rays [begin, end) of the batch, which are those of a cell.
  struct Share {
    Cell* cell;
    std::int32_t begin;
    std::int32_t end;
  };

  // ray_cells_build.cpp: which cells serve
  [[nodiscard]] bool worth_splitting(const Share& share) const noexcept;
  void wait(const Share& share);
  void begin_with_classes(const RayOrder& rays);
  void split_round(const RayOrder& rays, std::vector<Share>& round);
  void make_halves(const std::vector<Share>& round, const std::vector<std::int32_t>& middle);
  void make_lists(const std::vector<Cell*>& cells);
  void publish(const RayOrder& rays);
  void find_stats() noexcept;
  // ray_cells_lists.cpp: what they list, and what is kept
  [[nodiscard]] std::vector<Candidate> list_of(const Cell& cell) const;
  [[nodiscard]] std::vector<Candidate> class_list(std::int32_t ray_class) const;
  [[nodiscard]] std::size_t made_from(const Cell& cell) const noexcept;
  void keep(Cell& cell, const std::vector<Candidate>& list);
  [[nodiscard]] std::unique_ptr<Cell> new_cell(const CellAddress& address, Cell* parent);
  void drop_list(Cell& cell) noexcept;
  void make_room(std::size_t bytes);
  void take(std::size_t bytes) noexcept;
  [[nodiscard]] bool unused(Cell& cell, std::uint32_t last) noexcept;
  [[nodiscard]] static std::size_t list_bytes(std::int32_t count) noexcept;
  [[nodiscard]] static std::size_t cell_bytes() noexcept;

  const ClassifiedScene& scene_;
  int leaf_size_;
  int min_rays_;
  std::int32_t most_candidates_;  ///< that serve rays (weak where lists hold more)
  std::size_t block_;             ///< candidates that lists are made from, at most, before these are kept: much for the threads, little of the memory
  std::size_t budget_;            ///< for what is kept
  std::array<std::unique_ptr<Cell>, kRayClasses> class_cell_;
  std::size_t bytes_ = 0;       ///< of cells and lists
  std::size_t most_bytes_ = 0;  ///< at any time
  std::uint32_t batch_ = 0;

  std::array<std::vector<Share>, 64> waiting_;  ///< by the logarithm of rays * candidates
  std::vector<Share> leaves_;
  std::size_t held_bytes_ = 0;  ///< of what serves the batch
  std::vector<RayCell> served_;
  Column<std::int32_t> cell_of_rays_;
  DemandStats stats_;
};

}  // namespace raymeter
