#include "accel/bvh/beam_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace raymeter {

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr int kSamples = 4;  ///< groups of a slice, and rays of a group

/// Some rays of a group: origins, unit directions and lengths of their intervals, in columns.
struct Sample {
  double org[3][kSamples];
  double dir[3][kSamples];
  double begin = 0;  ///< where rays begin and end, on the mean
  double end = 0;
  int count = 0;
  bool spoilt = false;  ///< some of those looked at are no rays

  /// Whether it tells how wide the group is: where rays were left out, one alone does not.
  [[nodiscard]] bool tells() const noexcept { return count > (spoilt ? 1 : 0); }
};

/// Of `group` rays from `first` on: of a square of pixels the diagonal, as wide as all of it.
Sample sample_of(const RayView& rays, std::int32_t first, int group) noexcept {
  Sample sample;
  for (int s = 0; s < kSamples; ++s) {
    const std::int32_t i = first + s * (group - 1) / (kSamples - 1);
    if (i >= rays.count) break;
    const double x{rays.dir[0][i]}, y{rays.dir[1][i]}, z{rays.dir[2][i]};
    const double length2 = x * x + y * y + z * z;
    double farthest = 0;  // NaN and infinity stay
    for (int a = 0; a < 3; ++a) farthest += std::abs(double{rays.org[a][i]});
    if (!(length2 > 0 && length2 < kInf && farthest < kInf && rays.t_min[i] <= rays.t_max[i])) {
      sample.spoilt = true;
      continue;
    }
    const double length = std::sqrt(length2), per_length = 1 / length;
    for (int a = 0; a < 3; ++a) {
      sample.org[a][sample.count] = double{rays.org[a][i]};
      sample.dir[a][sample.count] = double{rays.dir[a][i]} * per_length;
    }
    sample.begin += double{rays.t_min[i]} * length;
    sample.end += double{rays.t_max[i]} * length;
    ++sample.count;
  }
  sample.begin /= sample.count;
  sample.end /= sample.count;
  return sample;
}

std::array<double, 3> mean(const double (&column)[3][kSamples], int count) noexcept {
  std::array<double, 3> sum{};
  for (int a = 0; a < 3; ++a) {
    for (int s = 0; s < count; ++s) sum[static_cast<std::size_t>(a)] += column[a][s];
    sum[static_cast<std::size_t>(a)] /= count;
  }
  return sum;
}

/// The mean ray of a sample and the distances between which it is inside the box; begin > end where it is not.
struct MeanRay {
  std::array<double, 3> org, dir;
  double begin, end;
};

MeanRay mean_ray(const Sample& sample, const float* box) noexcept {
  MeanRay ray{mean(sample.org, sample.count), mean(sample.dir, sample.count), std::max(sample.begin, 0.0), sample.end};
  for (std::size_t a = 0; a < 3; ++a) {
    const double per_dir = 1 / ray.dir[a];
    const double first = (double{box[a]} - ray.org[a]) * per_dir, last = (double{box[a + 3]} - ray.org[a]) * per_dir;
    ray.begin = std::max(ray.begin, std::min(first, last));  // NaN drops out
    ray.end = std::min(ray.end, std::max(first, last));
  }
  return ray;
}

/// The side of a square that would scatter as the rays do, across their mean direction, at a distance.
double width_at(const Sample& sample, const MeanRay& ray, double distance) noexcept {
  const auto& [org, dir, begin, end] = ray;
  const double length2 = dir[0] * dir[0] + dir[1] * dir[1] + dir[2] * dir[2];
  double across2 = 0;
  for (int s = 0; s < sample.count; ++s) {
    double apart2 = 0, along = 0;
    for (int a = 0; a < 3; ++a) {
      const auto i = static_cast<std::size_t>(a);
      const double apart = sample.org[a][s] - org[i] + distance * (sample.dir[a][s] - dir[i]);
      apart2 += apart * apart;
      along += apart * dir[i];
    }
    across2 += apart2 - along * along / length2;
  }
  return std::sqrt(6 * std::max(across2, 0.0) / sample.count);  // a square's variance is a sixth of its area
}

}  // namespace

LeafSizes leaf_sizes(std::span<const WideNode> nodes) {
  double count = 0, sizes = 0, areas = 0;
  for (const WideNode& node : nodes) {
    for (int c = 0; c < kWideChildren; ++c) {
      double side[3];
      for (int a = 0; a < 3; ++a) side[a] = double{node.plane[a + 3][c]} - double{node.plane[a][c]};
      if (!(side[0] >= 0) || node.child[c].tag() == WideRef::Tag::inner) continue;
      const double area = 0.5 * (side[0] * side[1] + side[1] * side[2] + side[2] * side[0]);
      count += 1;
      sizes += std::sqrt(area);
      areas += area;
    }
  }
  return areas > 0 ? LeafSizes{2 * sizes / areas, count / areas} : LeafSizes{};
}

double leaves_per_ray(const RayView& slice, const float* box, const LeafSizes& leaves) noexcept {
  constexpr double kMost = kBeamRays;
  const std::int32_t groups = (slice.count + kBeamRays - 1) / kBeamRays;
  const std::int32_t taken = std::min<std::int32_t>(groups, kSamples);
  double sum = 0, counted = 0;
  for (std::int32_t g = 0; g < taken; ++g) {
    const Sample sample = sample_of(slice, g * groups / taken * kBeamRays, kBeamRays);
    if (!sample.tells()) continue;
    const MeanRay ray = mean_ray(sample, box);
    const double width = ray.begin <= ray.end ? width_at(sample, ray, 0.5 * (ray.begin + ray.end)) : 0;  // a beam beside the box ends at once, as its rays do
    const double met = 1 + width * (leaves.per_width + width * leaves.per_area);
    sum += met < kMost ? met : kMost;
    counted += 1;
  }
  return counted > 0 ? sum / counted : kMost;
}

double group_width(const RayView& slice, const float* box) noexcept {
  double widest = 0, extent = 0;
  for (int a = 0; a < 3; ++a) extent = std::max(extent, double{box[a + 3]} - double{box[a]});
  for (std::int32_t first = 0; first < slice.count; first += kMaxGroupRays) {
    const Sample sample = sample_of(slice, first, kMaxGroupRays);
    if (!sample.tells()) continue;
    const MeanRay ray = mean_ray(sample, box);
    if (ray.begin <= ray.end) widest = std::max({widest, width_at(sample, ray, ray.begin), width_at(sample, ray, ray.end)});
  }
  return extent > 0 ? widest / extent : 0;
}

}  // namespace raymeter
