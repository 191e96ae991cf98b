#include "accel/bvh/heap_traversal_kernel.h"
#include "accel/bvh/packet_traversal_kernel.h"
#include "tests/support/capsule_volume_kernel.h"

namespace raymeter {

template struct BvhPacket<test::CapsuleLayout>::Kernel<kKernelIsa, NoStats>;
template struct BvhPacket<test::CapsuleLayout>::Kernel<kKernelIsa, CountStats>;
template struct BvhHeap<test::CapsuleLayout>::Kernel<kKernelIsa, NoStats>;
template struct BvhHeap<test::CapsuleLayout>::Kernel<kKernelIsa, CountStats>;

}  // namespace raymeter
