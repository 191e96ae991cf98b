#include "accel/bvh/heap_traversal_kernel.h"
#include "accel/bvh/packet_traversal_kernel.h"
#include "core/bounds/kdop_kernel.h"

namespace raymeter {

template struct BvhPacket<KdopLayout>::Kernel<kKernelIsa, NoStats>;
template struct BvhPacket<KdopLayout>::Kernel<kKernelIsa, CountStats>;
template struct BvhHeap<KdopLayout>::Kernel<kKernelIsa, NoStats>;
template struct BvhHeap<KdopLayout>::Kernel<kKernelIsa, CountStats>;

}  // namespace raymeter
