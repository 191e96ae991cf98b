#include "accel/bvh/weak_bvh.h"

#include "accel/bvh/packet_kernel.h"
#include "accel/kernel_intersector.h"
#include "core/bounds/weak_box_layout.h"

namespace raymeter {

namespace {

TriangleTest triangle_test(const BvhParams& params) {
  if (params.triangle_test == "woop") return TriangleTest::woop;
  if (params.triangle_test == "pluecker") return TriangleTest::pluecker;
  if (params.triangle_test != "moeller_trumbore") return TriangleTest::woop_kahan;
  return params.precision == "double" ? TriangleTest::moeller_trumbore_double : TriangleTest::moeller_trumbore;
}

SphereTest sphere_test(const BvhParams& params) {
  return params.sphere_test == "naive" ? SphereTest::naive : params.sphere_test == "haines" ? SphereTest::haines : SphereTest::robust;
}

/// The boxes lie in memory as the robust test reads them.
template <BoxTest B>
std::unique_ptr<Intersector> with_box_test(const BvhView<AabbLayout>& bvh, const BvhParams& params, const QueryOptions& options, std::size_t scratch_bytes) {
  using Layout = WeakBoxLayout<B>;
  static_assert(Layout::kFloats == AabbLayout::kFloats);
  const BvhView<Layout> view{{bvh.links, bvh.runs, bvh.pools, {bvh.shared, triangle_test(params), sphere_test(params)}, bvh.runtime_link_bytes},
                             bvh.stack_capacity,
                             bvh.heap_capacity};
  const auto& kernels = kernels_for<BvhPacket<Layout>::template Kernel, BvhView<Layout>>(options.isa);
  return std::make_unique<KernelIntersector<BvhView<Layout>>>(view, kernels, options.packet, scratch_bytes);
}

}  // namespace

bool has_weak_tests(const BvhParams& params) { return static_cast<const TestParams&>(params) != TestParams{}; }

std::unique_ptr<Intersector> weak_intersector(const BvhView<AabbLayout>& bvh, const BvhParams& params, const QueryOptions& options, std::size_t scratch_bytes) {
  if (params.box_test == "unpadded") return with_box_test<BoxTest::unpadded>(bvh, params, options, scratch_bytes);
  if (params.box_test == "fma") return with_box_test<BoxTest::fma>(bvh, params, options, scratch_bytes);
  return with_box_test<BoxTest::padded>(bvh, params, options, scratch_bytes);
}

}  // namespace raymeter
