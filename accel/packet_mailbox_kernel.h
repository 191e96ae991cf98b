#pragma once

// Mailboxes of packets, for structures that list a primitive in several places: inverse mailboxing (Shevtsov, Soupikov, Kapustin 2007). A few primitives are
// remembered, each with the rays of the packet that have been tested against it. Memory: 12 bytes a slot, the packet's own and empty at its start, so that
// nothing depends on threads. A slot that is taken is given to the latest: a test may be repeated, which costs time but changes nothing, and none is left out.

#include <cstdint>

#include "core/geometry/selection.h"
#include "core/scene/primitive.h"

namespace raymeter {

template <std::uint32_t kCount>
class PacketMailbox {
public:
  static constexpr std::uint32_t kSlots = kCount;

  /// Forgets everything: for a new packet.
  [[gnu::always_inline]] void clear() noexcept {
    for (std::uint32_t& prim : prim_) prim = ~0u;
  }
  /// Those of `rays` (bits of the packet) that have not met primitive `index` of a kind; from now on they have.
  [[nodiscard, gnu::always_inline]] std::uint64_t unmet(std::uint32_t index, std::uint32_t kind, std::uint64_t rays) noexcept {
    const std::uint32_t slot = index % kSlots, prim = index * std::uint32_t{kPrimKindCount} + kind;
    const std::uint64_t met = prim_[slot] == prim ? met_[slot] : 0;
    prim_[slot] = prim;
    met_[slot] = met | rays;
    return rays & ~met;
  }

private:
  std::uint32_t prim_[kSlots];
  std::uint64_t met_[kSlots];
};

/// A list of indices but for what rays have met already.
template <class L, std::uint32_t kSlots>
struct UnmetRefs {
  static constexpr Selection kSelection = Selection::tested;
  const std::int32_t* list;
  std::uint32_t kind;
  PacketMailbox<kSlots>* mailbox;  ///< null: all are wanted

  [[nodiscard, gnu::always_inline]] std::int32_t index(std::int32_t k) const noexcept { return list[k]; }
  [[nodiscard, gnu::always_inline]] typename L::Mask wanted(typename L::Mask lanes, int group, std::int32_t k) const noexcept {
    if (mailbox == nullptr) return lanes;
    const int first = group * L::kWidth;
    const std::uint64_t rays = std::uint64_t{L::bits(lanes)} << first;
    return L::mask(static_cast<std::uint32_t>(mailbox->unmet(static_cast<std::uint32_t>(list[k]), kind, rays) >> first));
  }
};

}  // namespace raymeter
