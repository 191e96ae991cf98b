#include "accel/bvh/weak_leaf_kernel.h"

#include "accel/bvh/packet_traversal_kernel.h"

namespace raymeter {

template struct BvhPacket<WeakBoxLayout<BoxTest::padded>>::Kernel<kKernelIsa, NoStats>;
template struct BvhPacket<WeakBoxLayout<BoxTest::padded>>::Kernel<kKernelIsa, CountStats>;
template struct BvhPacket<WeakBoxLayout<BoxTest::grown>>::Kernel<kKernelIsa, NoStats>;
template struct BvhPacket<WeakBoxLayout<BoxTest::grown>>::Kernel<kKernelIsa, CountStats>;
template struct BvhPacket<WeakBoxLayout<BoxTest::unpadded>>::Kernel<kKernelIsa, NoStats>;
template struct BvhPacket<WeakBoxLayout<BoxTest::unpadded>>::Kernel<kKernelIsa, CountStats>;
template struct BvhPacket<WeakBoxLayout<BoxTest::fma>>::Kernel<kKernelIsa, NoStats>;
template struct BvhPacket<WeakBoxLayout<BoxTest::fma>>::Kernel<kKernelIsa, CountStats>;
template struct BvhPacket<WeakBoxLayout<BoxTest::quotient>>::Kernel<kKernelIsa, NoStats>;
template struct BvhPacket<WeakBoxLayout<BoxTest::quotient>>::Kernel<kKernelIsa, CountStats>;

}  // namespace raymeter
