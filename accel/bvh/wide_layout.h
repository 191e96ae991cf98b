#pragma once

#include <cstddef>
#include <cstdint>

#include "accel/beam_layout.h"
#include "core/geometry/primitive_run.h"
#include "core/scene/pools_view.h"

namespace raymeter {

inline constexpr int kWideChildren = 8;

/// What a child of a wide node is: a tag in the upper two bits, and an index into the nodes, blocks or runs.
struct WideRef {
  enum class Tag : std::uint32_t { inner, block, run };
  static constexpr int kIndexBits = 30;
  std::uint32_t bits = 0;

  constexpr WideRef() = default;
  constexpr WideRef(Tag tag, std::size_t index) noexcept : bits(static_cast<std::uint32_t>(tag) << kIndexBits | static_cast<std::uint32_t>(index)) {}
  [[nodiscard]] constexpr Tag tag() const noexcept { return static_cast<Tag>(bits >> kIndexBits); }
  [[nodiscard]] constexpr std::uint32_t index() const noexcept { return bits & ((1u << kIndexBits) - 1); }
};

/// Eight children side by side. 256 bytes. A place without a child has an empty box (min = inf, max = -inf), which nothing meets.
struct alignas(64) WideNode {
  float plane[6][kWideChildren];  ///< min x, y, z, max x, y, z
  WideRef child[kWideChildren];
  std::uint32_t order[8];  ///< by octant of the rays: the places front to back, four bits each, the nearest in the lowest
};
static_assert(sizeof(WideNode) == 256);

/// A leaf of triangles that share vertices: what they refer to lies together, and a vertex is tested against a frustum once. 256 bytes.
struct alignas(64) TriangleBlock {
  static constexpr int kVertices = 14;
  static constexpr int kTriangles = 12;
  float vertex[3][kVertices];          ///< [axis]
  std::uint8_t corner[3][kTriangles];  ///< vertex numbers
  std::int32_t prim[kTriangles];
  std::int32_t count;
};
static_assert(sizeof(TriangleBlock) == 256);

inline constexpr int kMaxGroupRays = 256;  ///< in beams that go down together

/// Node 0 is the root; its eight places may hold anything, also nothing.
struct WideBvhView {
  const WideNode* nodes;
  const TriangleBlock* blocks;
  const PrimitiveRun* runs;  ///< leaves of other primitives, of one kind each
  PoolsView pools;           ///< those primitives in leaf order
  float box[6];              ///< of the scene: min x y z, max x y z
  std::int32_t stack_capacity;
  std::int32_t group_rays;  ///< rays whose beams go down together, where packets hold a whole beam
};

/// An entry of a beam traversal's stack: a child, and which beams meet it.
struct BeamEntry {
  std::uint32_t box;  ///< its parent times eight + its place there
  WideRef child;
  float first;          ///< the plane on which the beams enter its box, times their sign
  std::uint32_t beams;  ///< as bits
};

[[nodiscard]] constexpr std::size_t beam_stack_bytes(std::int32_t capacity) noexcept { return static_cast<std::size_t>(capacity) * sizeof(BeamEntry); }

}  // namespace raymeter
