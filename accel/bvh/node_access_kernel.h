#pragma once

// Nodes of an 8-wide hierarchy as their tests want them: where they lie, or unpacked from whole steps.

#include "accel/bvh/quantised_layout.h"
#include "core/ray/ray_packet.h"
#include "core/simd/select_kernel.h"

namespace raymeter {

/// Unpacks what rays of the octants `order` and `octant` need: planes, children, the order of `order`. A product with a power of two is exact: every
/// instruction set finds the planes that the builder has proven to lie outside.
template <class L, class Plane>
[[gnu::always_inline]] inline void unpack_node(const QuantisedNode<Plane>& packed, std::uint32_t order, WideNode& room) noexcept {
  using Float = typename L::Float;
  using Int = typename L::Int;
  constexpr int kPlanes = 6 * kWideChildren;
  alignas(64) std::int32_t steps[kPlanes];
  const auto* const packed_steps = reinterpret_cast<const Plane*>(&packed.plane);
  for (int i = 0; i < kPlanes; ++i) steps[i] = packed_steps[i];
  const auto second = L::mask(0xFF00);  // sixteen lanes: of two rows at once
  const auto of_rows = [&](int p, auto&& value) noexcept {
    if constexpr (L::kWidth > kWideChildren)
      return L::select(second, Float(value(p + 1)), Float(value(p)));
    else
      return Float(value(p));
  };
  const Int children(packed.children);
  for (int i = 0; i < kPlanes; i += L::kWidth) {
    const int p = i / kWideChildren;
    const Float step =
        of_rows(p, [&](int row) noexcept { return __builtin_bit_cast(float, static_cast<std::uint32_t>(packed.exponent[row % 3] + 127) << 23); });
    const Float corner = of_rows(p, [&](int row) noexcept { return packed.corner[row % 3]; });
    const Float nothing = of_rows(p, [&](int row) noexcept { return row < 3 ? kInfinity : -kInfinity; });
    Int place = L::iota() + Int(i % kWideChildren);
    if constexpr (L::kWidth > kWideChildren) place = L::select(second, place - Int(kWideChildren), place);
    L::store(room.plane[0] + i, L::select(L::less(place, children), L::mul_add(L::to_float(L::load(steps + i)), step, corner), nothing));
  }
  for (int c = 0; c < kWideChildren; ++c) room.child[c] = packed.child[c];
  room.order[order] = packed.order[order];
}

/// Node `index`, of whose orders that of octant `order` can be used; it may lie in `room`.
template <class L>
[[gnu::always_inline]] inline const WideNode& node_at(const WideBvhView& bvh, std::uint32_t index, std::uint32_t, WideNode&) noexcept {
  return bvh.nodes[index];
}
template <class L>
[[gnu::always_inline]] inline const WideNode& node_at(const QuantisedBvhView& bvh, std::uint32_t index, std::uint32_t order, WideNode& room) noexcept {
  if (bvh.plane_bytes == 1)
    unpack_node<L>(reinterpret_cast<const QuantisedNode<std::uint8_t>*>(bvh.quantised)[index], order, room);
  else
    unpack_node<L>(reinterpret_cast<const QuantisedNode<std::uint16_t>*>(bvh.quantised)[index], order, room);
  return room;
}

/// Where a child lies, inner node or block.
[[gnu::always_inline]] inline const char* address_of(const WideBvhView& bvh, WideRef child) noexcept {
  static_assert(sizeof(WideNode) == sizeof(TriangleBlock));
  const auto* const nodes = reinterpret_cast<const char*>(bvh.nodes);
  const auto* const blocks = reinterpret_cast<const char*>(bvh.blocks);
  return select_unforeseen(child.tag() == WideRef::Tag::inner, nodes, blocks) + sizeof(WideNode) * child.index();
}
[[gnu::always_inline]] inline const char* address_of(const QuantisedBvhView& bvh, WideRef child) noexcept {
  const bool is_node = child.tag() == WideRef::Tag::inner;
  const std::size_t stride = bvh.plane_bytes == 1 ? sizeof(QuantisedNode<std::uint8_t>) : sizeof(QuantisedNode<std::uint16_t>);
  const auto* const nodes = reinterpret_cast<const char*>(bvh.quantised);
  const auto* const blocks = reinterpret_cast<const char*>(bvh.blocks);
  return select_unforeseen(is_node, nodes, blocks) + select_unforeseen(is_node, stride, sizeof(TriangleBlock)) * child.index();
}

}  // namespace raymeter
