#include "accel/zbuffer/cell_runs.h"

#include <algorithm>

#include "core/ray/pixel_order.h"

namespace raymeter {

static_assert(kCellSamples == PixelOrder::kBlock);

namespace {

/// Sets the rectangles of a run's packets from its samples.
void set_rects(CellRun& run, int packet) noexcept {
  PacketRects& rects = run.rects;
  for (int p = 0; p * packet < run.count; ++p) {
    const int begin = p * packet, end = std::min(begin + packet, run.count);
    const auto [min_x, max_x] = std::minmax_element(run.x + begin, run.x + end);
    const auto [min_y, max_y] = std::minmax_element(run.y + begin, run.y + end);
    rects.min_x[p] = *min_x;
    rects.max_x[p] = *max_x;
    rects.min_y[p] = *min_y;
    rects.max_y[p] = *max_y;
  }
}

void shift(const float* from, int count, float by, float* to) noexcept {
  for (int k = 0; k < count; ++k) to[k] = from[k] + by;
}

}  // namespace

CellRuns::CellRuns(const ImagePlane& plane, const Column<std::int32_t>& pixels, int packet)
    : pixels_(pixels.data()), width_(plane.width), height_(plane.height), packet_(packet) {
  Column<std::int32_t> cell;
  PixelOrder(kCellSamples, kCellSamples).append_block(0, cell);
  for (std::size_t k = 0; k < order_.size(); ++k) {
    order_[k] = cell[k] / kCellSamples * width_ + cell[k] % kCellSamples;
    cell_.x[k] = static_cast<float>(2 * (cell[k] % kCellSamples));
    cell_.y[k] = static_cast<float>(2 * (cell[k] / kCellSamples));
  }
  cell_.count = PacketRects::kMost;
  set_rects(cell_, packet_);
}

bool CellRuns::whole_cell(std::size_t first) const noexcept {
  const std::int32_t* const pixel = pixels_ + first;
  std::int32_t differ = 0;
  for (std::size_t k = 0; k < order_.size(); ++k) differ |= pixel[k] - pixel[0] - order_[k];
  return differ == 0;
}

void CellRuns::next(std::size_t first, std::size_t end, CellRun& run) const noexcept {
  const std::int32_t* const pixel = pixels_ + first;
  const int x = pixel[0] % width_, y = pixel[0] / width_;
  run.first = first;
  run.cell_x = x / kCellSamples;
  run.cell_y = y / kCellSamples;
  const auto left = static_cast<float>(2 * x - (width_ - 1)), top = static_cast<float>(2 * y - (height_ - 1));
  if (end - first >= order_.size() && x % kCellSamples == 0 && y % kCellSamples == 0 && x + kCellSamples <= width_ && whole_cell(first)) {
    run.count = cell_.count;
    shift(cell_.x, run.count, left, run.x);
    shift(cell_.y, run.count, top, run.y);
    const int packets = (run.count + packet_ - 1) / packet_;
    shift(cell_.rects.min_x, packets, left, run.rects.min_x);
    shift(cell_.rects.max_x, packets, left, run.rects.max_x);
    shift(cell_.rects.min_y, packets, top, run.rects.min_y);
    shift(cell_.rects.max_y, packets, top, run.rects.max_y);
    return;
  }
  const auto in_cell = [&](std::int32_t other) noexcept { return other % width_ / kCellSamples == run.cell_x && other / width_ / kCellSamples == run.cell_y; };
  const auto most = static_cast<std::int32_t>(std::min(order_.size(), end - first));
  for (run.count = 1; run.count < most && in_cell(pixel[run.count]);) ++run.count;
  for (std::int32_t k = 0; k < run.count; ++k) {
    run.x[k] = static_cast<float>(2 * (pixel[k] % width_) - (width_ - 1));
    run.y[k] = static_cast<float>(2 * (pixel[k] / width_) - (height_ - 1));
  }
  set_rects(run, packet_);
}

}  // namespace raymeter
