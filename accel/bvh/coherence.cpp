#include "accel/bvh/coherence.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raymeter {

double coherence(const RayView& rays, int samples) noexcept {
  constexpr std::int32_t kNeighbours = 16;
  const std::int32_t groups = (rays.count + kNeighbours - 1) / kNeighbours;
  const std::int32_t taken = std::min(groups, samples);
  double length = 0, counted = 0;
  for (std::int32_t s = 0; s < taken; ++s) {
    const std::int32_t first = static_cast<std::int32_t>(std::int64_t{s} * groups / taken) * kNeighbours;
    double sum[3] = {}, valid = 0;
    for (std::int32_t i = first; i < std::min(first + kNeighbours, rays.count); ++i) {
      const double x{rays.dir[0][i]}, y{rays.dir[1][i]}, z{rays.dir[2][i]};
      const double per_length = 1 / std::sqrt(x * x + y * y + z * z);
      if (!(per_length > 0 && per_length < std::numeric_limits<double>::infinity())) continue;
      sum[0] += x * per_length;
      sum[1] += y * per_length;
      sum[2] += z * per_length;
      valid += 1;
    }
    length += std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    counted += valid;
  }
  return counted > 0 ? length / counted : 1;
}

}  // namespace raymeter
