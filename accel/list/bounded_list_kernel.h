#pragma once

#include "accel/volume_links_layout.h"
#include "core/ray/trace_args.h"
#include "core/simd/isa_enum.h"
#include "core/stats/counters.h"

namespace raymeter {

/// Links to the objects of a scene, in its order; the primitives stay in the scene's pools.
template <class Layout>
struct BoundedListView : VolumeLinksView<Layout> {
  std::int32_t count;
};

/// Every object behind its own volume. Defined in bounded_list_traversal_kernel.h; instantiated for each kind of volume in bounded_list_kernel.cpp.
template <class Layout>
struct BoundedList {
  template <Isa I, class Stats>
  struct Kernel {
    static void closest(const BoundedListView<Layout>& list, const TraceArgs& args, Counters* counters) noexcept;
    static void any(const BoundedListView<Layout>& list, const TraceArgs& args, Counters* counters) noexcept;
  };
};

}  // namespace raymeter
