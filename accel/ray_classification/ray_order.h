#pragma once

#include <cstdint>

#include "core/base/column.h"

namespace raymeter {

/// The rays of a batch in ascending order of their keys, equal ones as they come. Keys have `bits` bits. Uses at most `threads` threads (0: all).
struct RayOrder {
  Column<std::uint64_t> key;   ///< sorted
  Column<std::int32_t> place;  ///< in the batch, of each

  /// Makes `key` as long as the batch; the caller then fills it in the order of the batch and calls sort().
  void reset(std::size_t rays) { key.resize(rays); }
  void sort(int bits, int threads);

private:
  Column<std::uint64_t> other_key_;
  Column<std::int32_t> other_place_;
};

}  // namespace raymeter
