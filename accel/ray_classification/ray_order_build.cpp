#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "accel/ray_classification/ray_order.h"
#include "core/base/threads.h"

namespace raymeter {

namespace {

constexpr int kDigitBits = 11;
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
/// Rays per part; parts are counted, and moved, each on its own.
constexpr std::size_t kPart = std::size_t{1} << 16;

using Histogram = std::array<std::uint32_t, kDigits>;

template <class Body>
void for_each_part(std::size_t rays, Body&& body) {
  const std::size_t parts = (rays + kPart - 1) / kPart;
  tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) { body(part, part * kPart, std::min(rays, (part + 1) * kPart)); });
}

}  // namespace

/// Radix sort, lowest digit first; digits that all keys have in common are passed over.
void RayOrder::sort(int bits, int threads) {
  const std::size_t rays = key.size();
  place.resize(rays);
  other_key_.resize(rays);
  other_place_.resize(rays);
  for (std::size_t i = 0; i < rays; ++i) place[i] = static_cast<std::int32_t>(i);
  std::uint64_t varying = 0;
  for (const std::uint64_t k : key) varying |= k ^ key[0];
  on_threads(threads, [&] {
    std::vector<Histogram> counts((rays + kPart - 1) / kPart);
    for (int shift = 0; shift < bits; shift += kDigitBits) {
      if ((varying >> shift & (kDigits - 1)) == 0) continue;
      const auto digit = [&](std::size_t i) noexcept { return static_cast<std::size_t>(key[i] >> shift) & (kDigits - 1); };
      for_each_part(rays, [&](std::size_t part, std::size_t begin, std::size_t end) {
        counts[part].fill(0);
        for (std::size_t i = begin; i < end; ++i) ++counts[part][digit(i)];
      });
      std::uint32_t sum = 0;
      for (std::size_t d = 0; d < kDigits; ++d) {
        for (Histogram& count : counts) sum += std::exchange(count[d], sum);
      }
      for_each_part(rays, [&](std::size_t part, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const std::uint32_t to = counts[part][digit(i)]++;
          other_key_[to] = key[i];
          other_place_[to] = place[i];
        }
      });
      std::swap(key, other_key_);
      std::swap(place, other_place_);
    }
  });
}

}  // namespace raymeter
