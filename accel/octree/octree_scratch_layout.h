#pragma once

#include <cstddef>
#include <cstdint>

#include "accel/octree/octree_layout.h"
#include "accel/packet_mailbox_kernel.h"
#include "core/ray/views.h"

namespace raymeter {

using OctreeMailbox = PacketMailbox<64>;

/// An inner cell that a packet is in: for each lane where its ray is in the cell and when it crosses the three planes that divide it.
struct alignas(64) OctreeFrame {
  float t_near[kMaxPacket];  ///< infinite in lanes that are not in the cell
  float t_far[kMaxPacket];
  float t_split[3][kMaxPacket];
  const OctreeNode* node;
  std::uint32_t pending;  ///< children that are still to be looked at, in the order of the packet
};

/// The slice's memory: the mailbox, then one frame for every level.
struct alignas(64) OctreeScratch {
  OctreeMailbox mailbox;

  [[nodiscard]] OctreeFrame* frames() noexcept { return reinterpret_cast<OctreeFrame*>(this + 1); }
  [[nodiscard]] static constexpr std::size_t bytes(std::int32_t depth) noexcept {
    return sizeof(OctreeScratch) + static_cast<std::size_t>(depth + 1) * sizeof(OctreeFrame);
  }
};

}  // namespace raymeter
