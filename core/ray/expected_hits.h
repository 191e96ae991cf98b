#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/column.h"

namespace raymeter {

/// What rays meet by the construction of their scene, where that is known without tracing. Columns are as long as the batch, or empty where nothing is known.
struct ExpectedHits {
  static constexpr std::int32_t kNothing = -1;
  static constexpr std::int32_t kSomething = -2;  ///< a hit, of whatever primitive
  static constexpr std::int32_t kUnknown = -3;

  Column<std::int32_t> prim;    ///< the nearest primitive, of equally near ones that of the smallest id; or one of the above
  Column<double> t;             ///< exact; NaN where it is not known
  Column<std::int32_t> source;  ///< flat primitive that the ray leaves, which it cannot meet again; -1: none
  Column<bool> excused;         ///< rays that may be answered otherwise: they pass so near to a silhouette that the declared errors decide

  void push_back(std::int32_t expected_prim, double exact_t) {
    prim.push_back(expected_prim);
    t.push_back(exact_t);
  }
};

}  // namespace raymeter
