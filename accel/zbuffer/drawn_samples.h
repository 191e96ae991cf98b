#pragma once

#include <array>

#include "accel/zbuffer/cell_runs.h"
#include "core/ray/ray_batch.h"

namespace raymeter {

/// The samples of a z-buffer that lie between those of a run, in tiles of 4 x 4, and which of them stands for each of the run's.
struct DrawnSamples {
  RayBatch rays;
  Column<float> x, y;
  std::array<Column<float>, 4> rect;  ///< of packets: least and greatest x, least and greatest y
  Column<std::int32_t> of_ray;

  /// The z-buffer has about `resolution` samples for each of the image's along an axis, about the same centre.
  void make(const ImagePlane& plane, const CellRun& run, double resolution, int packet);
};

}  // namespace raymeter
