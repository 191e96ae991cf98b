#pragma once

#include <span>

#include "accel/bvh/quantised_layout.h"
#include "core/base/column.h"

namespace raymeter {

/// The nodes of an 8-wide hierarchy in whole steps; one of the two columns is empty.
struct QuantisedNodes {
  Column<QuantisedNode<std::uint8_t>> by_bytes;
  Column<QuantisedNode<std::uint16_t>> by_words;

  [[nodiscard]] std::size_t bytes() const noexcept { return by_bytes.bytes() + by_words.bytes(); }
};

/// Each node's boxes in 2^bits - 1 steps of the box around them, rounded outwards: what meets a box meets the quantised one. `bits`: 2 to 16, those up to 8 in
/// bytes. Throws Error where a box lies further than 2^120 from the origin.
[[nodiscard]] QuantisedNodes quantised_nodes(std::span<const WideNode> nodes, int bits);

/// Gives each plane the place that it has in quantised_nodes().
void round_outwards(std::span<WideNode> nodes, int bits);

}  // namespace raymeter
