#include "accel/list/bounded_list_kernel.h"

#include "accel/list/bounded_list_traversal_kernel.h"
#include "core/bounds/aabb_kernel.h"
#include "core/bounds/kdop_kernel.h"
#include "core/bounds/obb_kernel.h"
#include "core/bounds/sphere_volume_kernel.h"

namespace raymeter {

template struct BoundedList<AabbLayout>::Kernel<kKernelIsa, NoStats>;
template struct BoundedList<AabbLayout>::Kernel<kKernelIsa, CountStats>;
template struct BoundedList<SphereLayout>::Kernel<kKernelIsa, NoStats>;
template struct BoundedList<SphereLayout>::Kernel<kKernelIsa, CountStats>;
template struct BoundedList<ObbLayout>::Kernel<kKernelIsa, NoStats>;
template struct BoundedList<ObbLayout>::Kernel<kKernelIsa, CountStats>;
template struct BoundedList<KdopLayout>::Kernel<kKernelIsa, NoStats>;
template struct BoundedList<KdopLayout>::Kernel<kKernelIsa, CountStats>;

}  // namespace raymeter
