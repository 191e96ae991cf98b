#pragma once

#include <cstddef>
#include <cstdint>

namespace raymeter {

/// Remembers which rays of a packet have been tested against which primitives: the last primitive for each of its entries. One that was driven out may be
/// tested again, which costs time but changes nothing.
class PacketMailbox {
public:
  static constexpr std::size_t kBytes = 256 * 16;

  /// `scratch` has kBytes.
  explicit PacketMailbox(std::byte* scratch) noexcept : entry_(reinterpret_cast<Entry*>(scratch)) {
    for (std::uint32_t e = 0; e < kEntries; ++e) entry_[e] = {0, 0, 0};
  }
  /// Forgets what the last packet did.
  void begin_packet() noexcept { ++packet_; }
  /// Those of `rays` that have not been tested against the primitive; from now on they have.
  [[nodiscard]] std::uint64_t unseen(std::uint32_t prim, std::uint64_t rays) noexcept {
    Entry& entry = entry_[(prim ^ prim >> 8) % kEntries];
    if (entry.prim != prim || entry.packet != packet_) entry = {prim, packet_, 0};
    const std::uint64_t first_time = rays & ~entry.seen;
    entry.seen |= rays;
    return first_time;
  }

private:
  struct Entry {
    std::uint32_t prim;
    std::uint32_t packet;  ///< packets count from 1
    std::uint64_t seen;
  };
  static constexpr std::uint32_t kEntries = kBytes / sizeof(Entry);
  Entry* entry_;
  std::uint32_t packet_ = 0;
};

}  // namespace raymeter
