#include "accel/zbuffer/drawn_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "core/ray/pixel_order.h"

namespace raymeter {

namespace {

/// One axis of the z-buffer.
struct Axis {
  double resolution;
  int last;  ///< sample

  Axis(int image_samples, double res) noexcept : resolution(res), last(std::max(1, static_cast<int>(std::ceil(image_samples * res))) - 1) {}
  /// The sample nearest to x in half samples of the image, of two the one nearer to the first.
  [[nodiscard]] int nearest(float x) const noexcept {
    return static_cast<int>(std::clamp(std::ceil((double{x} * resolution + last - 1) / 2), 0.0, static_cast<double>(last)));
  }
  [[nodiscard]] double position(int sample) const noexcept { return (2 * sample - last) / resolution; }
};

}  // namespace

void DrawnSamples::make(const ImagePlane& plane, const CellRun& run, double resolution, int packet) {
  const Axis across(plane.width, resolution), down(plane.height, resolution);
  const auto [min_x, max_x] = std::minmax_element(run.x, run.x + run.count);
  const auto [min_y, max_y] = std::minmax_element(run.y, run.y + run.count);
  const int left = across.nearest(*min_x), width = across.nearest(*max_x) - left + 1;
  const int top = down.nearest(*min_y), height = down.nearest(*max_y) - top + 1;

  Column<std::int32_t> pixels;
  const PixelOrder order(width, height);
  for (std::int32_t block = 0; block < order.block_count(); ++block) order.append_block(block, pixels);
  Column<std::int32_t> place(pixels.size());
  rays.resize(pixels.size());
  x.resize(pixels.size());
  y.resize(pixels.size());
  const glm::dvec3 right = plane.right / glm::dot(plane.right, plane.right), lower = plane.down / glm::dot(plane.down, plane.down);
  const glm::vec3 org(plane.eye);
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    place[static_cast<std::size_t>(pixels[k])] = static_cast<std::int32_t>(k);
    const double at_x = across.position(left + pixels[k] % width), at_y = down.position(top + pixels[k] / width);
    const glm::vec3 dir(glm::normalize(plane.center + at_x * right + at_y * lower));
    rays.set(k, {{org.x, org.y, org.z}, 0, {dir.x, dir.y, dir.z}, std::numeric_limits<float>::infinity()});
    x[k] = static_cast<float>(at_x);
    y[k] = static_cast<float>(at_y);
  }
  of_ray.resize(static_cast<std::size_t>(run.count));
  for (int k = 0; k < run.count; ++k) {
    of_ray[static_cast<std::size_t>(k)] = place[static_cast<std::size_t>((down.nearest(run.y[k]) - top) * width + across.nearest(run.x[k]) - left)];
  }

  for (Column<float>& side : rect) side.clear();
  for (std::size_t begin = 0; begin < x.size(); begin += static_cast<std::size_t>(packet)) {
    const std::size_t end = std::min(begin + static_cast<std::size_t>(packet), x.size());
    const auto [low_x, high_x] = std::minmax_element(x.begin() + begin, x.begin() + end);
    const auto [low_y, high_y] = std::minmax_element(y.begin() + begin, y.begin() + end);
    rect[0].push_back(*low_x);
    rect[1].push_back(*high_x);
    rect[2].push_back(*low_y);
    rect[3].push_back(*high_y);
  }
}

}  // namespace raymeter
