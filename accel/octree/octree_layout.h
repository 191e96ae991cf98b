#pragma once

#include <cstdint>

#include "core/scene/pools_view.h"
#include "core/scene/primitive.h"

namespace raymeter {

/// An inner cell: one cache line. Child c lies above the plane of axis a where bit a of c is set. An axis that is not divided has its plane at +infinity, so
/// that no ray gets above it.
struct alignas(64) OctreeNode {
  float split[3];
  std::uint32_t empty;    ///< bit c: child c is an empty leaf
  std::int32_t child[8];  ///< a node, or ~leaf; leaf 0 is the empty one
  std::int32_t parent;    ///< the root's is itself
};

/// Words from a node to the next, and to its parts: for gathers.
struct OctreeWords {
  static constexpr std::int32_t kNode = sizeof(OctreeNode) / 4;
  static constexpr std::int32_t kChild = 4;
  static constexpr std::int32_t kParent = 12;
  static constexpr std::int32_t kOutline = 6;
};

/// An octree. Leaf i lists, for each kind that the scene has, refs [first[i * kind_count + j], first[i * kind_count + j + 1]).
struct OctreeView {
  PoolsView pools;
  float box[6];        ///< around all that can be hit: min x y z, max x y z
  std::int32_t root;   ///< 0, or ~leaf
  std::int32_t depth;  ///< of the deepest leaf
  const OctreeNode* nodes;
  const float* outline;  ///< six planes per node, min x y z, max x y z; infinite at the root's border
  const std::int32_t* first;
  const std::int32_t* refs;
  std::int32_t kind_count;
  PrimKind kind[kPrimKindCount];
  std::int32_t prim_count[kPrimKindCount];  ///< in the whole scene, in the order of `kind`
  float center[3];
  float reach;           ///< rays whose origins lie this far from `center` on any axis are not served by lists that reach beyond their cells by a margin
  bool exact;            ///< the lists hold what touches a cell, not only what has a box that does
  bool neighbour;        ///< the next cell is looked for from the old one, not from the root
  bool from_origin;      ///< rays walk from their origin on, even where their interval begins later
  bool nearest_blocker;  ///< any hit is found as the nearest is
  bool mailbox;
};

}  // namespace raymeter
