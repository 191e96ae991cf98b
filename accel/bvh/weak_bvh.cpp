#include "accel/bvh/weak_bvh.h"

#include "accel/bvh/packet_kernel.h"
#include "accel/kernel_intersector.h"
#include "core/bounds/weak_box_layout.h"
#include "core/geometry/error_bounds.h"

namespace raymeter {

namespace {

TriangleTest triangle_test(const BvhParams& params) {
  if (params.triangle_test == "woop") return TriangleTest::woop;
  if (params.triangle_test == "pluecker") return params.triangle_epsilon > 0 ? TriangleTest::pluecker_epsilon : TriangleTest::pluecker;
  if (params.triangle_test == "baldwin_weber") return TriangleTest::baldwin_weber;
  if (params.triangle_test != "moeller_trumbore") return TriangleTest::woop_kahan;
  if (params.precision == "double") return TriangleTest::moeller_trumbore_double;
  return params.triangle_epsilon > 0 ? TriangleTest::moeller_trumbore_epsilon : TriangleTest::moeller_trumbore;
}

SphereTest sphere_test(const BvhParams& params) {
  return params.sphere_test == "naive" ? SphereTest::naive : params.sphere_test == "haines" ? SphereTest::haines : SphereTest::robust;
}

Reciprocal reciprocal(const BvhParams& params) {
  return params.reciprocal == "newton" ? Reciprocal::newton : params.reciprocal == "estimate" ? Reciprocal::estimate : Reciprocal::divide;
}

/// Relative to an interval's ends; an ulp is two roundings.
float padding(const BvhParams& params) { return params.box_test == "unpadded" ? static_cast<float>(2 * params.box_padding) * kUnitRoundoff : kSlabPadding; }

/// The boxes lie in memory as the robust test reads them.
template <BoxTest B>
std::unique_ptr<Intersector> with_box_test(const BvhView<AabbLayout>& bvh, const UnitTriangleView& unit_triangles, const BvhParams& params,
                                           const QueryOptions& options, std::size_t scratch_bytes) {
  using Layout = WeakBoxLayout<B>;
  static_assert(Layout::kFloats == AabbLayout::kFloats);
  const BvhView<Layout> view{{bvh.links,
                              bvh.runs,
                              bvh.pools,
                              {bvh.shared, triangle_test(params), 0x1p-23f * static_cast<float>(params.triangle_epsilon), sphere_test(params),
                               reciprocal(params), 1 - padding(params), 1 + padding(params), unit_triangles},
                              bvh.runtime_link_bytes},
                             bvh.stack_capacity,
                             bvh.heap_capacity};
  const auto& kernels = kernels_for<BvhPacket<Layout>::template Kernel, BvhView<Layout>>(options.isa);
  return std::make_unique<KernelIntersector<BvhView<Layout>>>(view, kernels, options.packet, scratch_bytes);
}

}  // namespace

bool has_weak_tests(const BvhParams& params) { return static_cast<const TestParams&>(params) != TestParams{}; }

std::unique_ptr<Intersector> weak_intersector(const BvhView<AabbLayout>& bvh, const UnitTriangleView& unit_triangles, const BvhParams& params,
                                              const QueryOptions& options, std::size_t scratch_bytes) {
  if (params.reciprocal == "none") return with_box_test<BoxTest::quotient>(bvh, unit_triangles, params, options, scratch_bytes);
  if (params.box_test == "unpadded" && params.box_padding == 0) return with_box_test<BoxTest::unpadded>(bvh, unit_triangles, params, options, scratch_bytes);
  if (params.box_test == "fma") return with_box_test<BoxTest::fma>(bvh, unit_triangles, params, options, scratch_bytes);
  if (params.box_test == "unpadded" || params.reciprocal != "divide") return with_box_test<BoxTest::grown>(bvh, unit_triangles, params, options, scratch_bytes);
  return with_box_test<BoxTest::padded>(bvh, unit_triangles, params, options, scratch_bytes);
}

}  // namespace raymeter
