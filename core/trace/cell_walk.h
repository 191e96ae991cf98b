#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/bounds/aabb.h"
#include "core/ray/views.h"

namespace raymeter {

/// Intersectors whose rays walk through the cells of one grid are this too, so that the walk itself can be held against the truth: lists reach a little beyond
/// their cells, which hides its errors from the answers. Cell (i, j, k) is number i + (j + k * ny) * nx.
class CellWalk {
public:
  static constexpr std::int32_t kEverywhere = -1;

  /// What the walk is about: cells between planes, as far as the box goes that holds all hits.
  struct Cells {
    std::array<std::vector<float>, 3> planes;  ///< of each axis those between cells, ascending; cells at the border have none outside
    std::array<double, 3> cell_size;
    std::array<double, 3> margin;  ///< how far beyond its cell a list reaches
    Aabb box;
    [[nodiscard]] std::size_t resolution(std::size_t axis) const noexcept { return planes[axis].size() + 1; }
    /// The most cells that a ray can visit.
    [[nodiscard]] std::size_t most() const noexcept { return planes[0].size() + planes[1].size() + planes[2].size() + 1; }
  };

  virtual ~CellWalk() = default;
  [[nodiscard]] virtual Cells cells() const = 0;
  /// The cells in which rays stand one after another on their way through the box, as if nothing were in it: those of ray i from visited[i * most()] on, their
  /// number in count[i], kEverywhere where the ray does not walk but is tested against everything.
  virtual void walk(const RayView& rays, std::int32_t* visited, std::int32_t* count) const noexcept = 0;
};

}  // namespace raymeter
