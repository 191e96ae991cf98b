#include <algorithm>

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include "accel/bvh/morton_order.h"

namespace raymeter {

namespace {

constexpr int kBits = 21;

/// The lowest 21 bits of x, two zeros between each.
std::uint64_t spread(std::uint64_t x) noexcept {
  x = (x | x << 32) & 0x001F00000000FFFFu;
  x = (x | x << 16) & 0x001F0000FF0000FFu;
  x = (x | x << 8) & 0x100F00F00F00F00Fu;
  x = (x | x << 4) & 0x10C30C30C30C30C3u;
  x = (x | x << 2) & 0x1249249249249249u;
  return x;
}

/// Twice the centre; in double, where no sum of floats overflows.
glm::dvec3 center2(const Aabb& box) noexcept { return glm::dvec3(box.min) + glm::dvec3(box.max); }

}  // namespace

std::vector<MortonPrim> build_morton_order(const std::vector<BuildPrim>& prims) {
  if (prims.empty()) return {};
  glm::dvec3 low = center2(prims[0].box), high = low;
  for (const BuildPrim& prim : prims) {
    low = glm::min(low, center2(prim.box));
    high = glm::max(high, center2(prim.box));
  }
  std::vector<MortonPrim> order(prims.size());
  tbb::parallel_for(std::size_t{0}, prims.size(), [&](std::size_t i) {
    const glm::dvec3 center = center2(prims[i].box);
    std::uint64_t code = 0;
    for (glm::length_t a = 0; a < 3; ++a) {
      if (!(high[a] > low[a])) continue;
      const double cell = (center[a] - low[a]) / (high[a] - low[a]) * (1 << kBits);
      code |= spread(std::min(static_cast<std::uint64_t>(cell), (std::uint64_t{1} << kBits) - 1)) << a;
    }
    order[i] = {code, static_cast<std::int32_t>(i)};
  });
  tbb::parallel_sort(order.begin(), order.end());
  return order;
}

}  // namespace raymeter
