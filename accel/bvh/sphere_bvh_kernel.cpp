#include "accel/bvh/heap_traversal_kernel.h"
#include "accel/bvh/packet_traversal_kernel.h"
#include "core/bounds/sphere_volume_kernel.h"

namespace raymeter {

template struct BvhPacket<SphereLayout>::Kernel<kKernelIsa, NoStats>;
template struct BvhPacket<SphereLayout>::Kernel<kKernelIsa, CountStats>;
template struct BvhHeap<SphereLayout>::Kernel<kKernelIsa, NoStats>;
template struct BvhHeap<SphereLayout>::Kernel<kKernelIsa, CountStats>;

}  // namespace raymeter
