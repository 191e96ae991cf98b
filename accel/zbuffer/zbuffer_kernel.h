#pragma once

#include <cstdint>

#include "accel/zbuffer/footprint_layout.h"
#include "core/ray/trace_args.h"
#include "core/scene/pools_view.h"
#include "core/simd/isa_enum.h"
#include "core/stats/counters.h"

namespace raymeter {

/// A frame as the kernels see it.
struct ZbufferView {
  PoolsView pools;
  const Footprint* footprints;  ///< by primitive id
  const DepthPlane* planes;     ///< likewise
  float view_dir[3];            ///< along which depth is measured
};

/// Eye rays of one cell of the image, and the primitives that may cover it: two lists, each nearest first.
struct CellArgs {
  RayView rays;
  HitView hits;
  std::int32_t packet;
  const float* rect[4];    ///< of the packets: least and greatest x, least and greatest y
  const float* sample[2];  ///< of the rays: x, y; for drawing only
  const std::int32_t* near_list[2];
  std::int32_t list_size[2];
};

template <Isa I, class Stats>
struct ZbufferKernel {
  /// The nearest hits.
  static void list(const ZbufferView& frame, const CellArgs& cell, Counters* counters) noexcept;
  /// The primitives that a z-buffer shows at the samples, and about where they are met.
  static void draw(const ZbufferView& frame, const CellArgs& cell, Counters* counters) noexcept;
  /// The hit of each ray on the primitive that `prim` names, of those that the frame sees; a miss where it is -1.
  static void meet(const ZbufferView& frame, const TraceArgs& args, const std::int32_t* prim, Counters* counters) noexcept;
};

}  // namespace raymeter
