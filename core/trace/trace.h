#pragma once

#include <cstdint>
#include <string>

#include "core/base/column.h"
#include "core/ray/ray_batch.h"
#include "core/trace/intersector.h"
#include "core/trace/slices.h"

namespace raymeter {

/// Traces a batch on at most `threads` threads (0: all). `hits` is resized. Counts, where asked for, are added; they do not depend on `threads`.
void trace_closest(const Intersector& intersector, const RayBatch& rays, HitBatch& hits, int threads, Counters* counters = nullptr);
void trace_any(const Intersector& intersector, const RayBatch& rays, Column<std::int32_t>& blocker, int threads, Counters* counters = nullptr);

/// What the intersector settled on for both kinds of queries, see Intersector::choice: "key=value,...; any: key=value,...", without what is empty.
[[nodiscard]] std::string choices(const Intersector& intersector);

}  // namespace raymeter
