#pragma once

#include <cstddef>
#include <memory>

#include "accel/bvh/bvh.h"
#include "accel/bvh/bvh_layout.h"
#include "core/geometry/unit_triangle_layout.h"

namespace raymeter {

/// Whether one of a setting's tests of boxes or primitives is not the robust one.
[[nodiscard]] bool has_weak_tests(const BvhParams& params);

/// Packet traversal of the same tree with the tests that `params` name.
[[nodiscard]] std::unique_ptr<Intersector> weak_intersector(const BvhView<AabbLayout>& bvh, const UnitTriangleView& unit_triangles, const BvhParams& params,
                                                            const QueryOptions& options, std::size_t scratch_bytes);

}  // namespace raymeter
