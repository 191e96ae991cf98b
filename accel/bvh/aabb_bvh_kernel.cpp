#include "accel/bvh/heap_traversal_kernel.h"
#include "accel/bvh/packet_traversal_kernel.h"
#include "core/bounds/aabb_kernel.h"

namespace raymeter {

template struct BvhPacket<AabbLayout>::Kernel<kKernelIsa, NoStats>;
template struct BvhPacket<AabbLayout>::Kernel<kKernelIsa, CountStats>;
template struct BvhHeap<AabbLayout>::Kernel<kKernelIsa, NoStats>;
template struct BvhHeap<AabbLayout>::Kernel<kKernelIsa, CountStats>;

}  // namespace raymeter
