#include "accel/bvh/heap_traversal_kernel.h"
#include "accel/bvh/packet_traversal_kernel.h"
#include "core/bounds/obb_kernel.h"

namespace raymeter {

template struct BvhPacket<ObbLayout>::Kernel<kKernelIsa, NoStats>;
template struct BvhPacket<ObbLayout>::Kernel<kKernelIsa, CountStats>;
template struct BvhHeap<ObbLayout>::Kernel<kKernelIsa, NoStats>;
template struct BvhHeap<ObbLayout>::Kernel<kKernelIsa, CountStats>;

}  // namespace raymeter
