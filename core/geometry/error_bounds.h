#pragma once

// What the primitive kernels promise of the point P = org + t dir of a hit that they accept (org and dir as given, t as returned, arithmetic exact).
//
// The conservative contract: on each axis, P is no further outside the primitive's exact bounding box than
//     kPrimitiveError * (|P - org| + extent)        with |P - org| along that axis and extent the largest extent of the box on any axis,
// and every volume and cell is made or tested so that it cannot cull such a hit: built boxes grow by kBoundsPadding * extent, and slab intervals by
// kSlabPadding relative to t. Then pruning never changes an answer. The kernels say why they keep the promise.
//
// Accuracy: P is within kSurfaceError * (|P - org| + size) of the surface, here as Euclidean distances, size the diameter of the primitive. A ray that meets
// the surface may be missed only where moving it by that much could take it off: at silhouettes, rims, outlines and the ends of its interval. Where triangles
// or polygons share an edge or vertex it is not missed. Of a polygon the surface is its plane within its box.

namespace raymeter {

inline constexpr float kUnitRoundoff = 0x1p-24f;
/// A hit's distance outside its primitive's box, relative.
inline constexpr float kPrimitiveError = 16 * kUnitRoundoff;
/// Growth of a built box relative to its extent.
inline constexpr float kBoundsPadding = 16 * kUnitRoundoff;
/// Growth of a slab interval [t_near, t_far] relative to its ends: the error above, and 4 roundings of the slab test's own.
inline constexpr float kSlabPadding = 20 * kUnitRoundoff;
/// Kernels that clamp t to the ray's interval in the primitive's own box grow that box by kOwnBoxPadding of its extent and the interval by kOwnSlabPadding:
/// enough for a ray that passes through the primitive as the kernel sees it, and with the slab test's own 4 roundings within kPrimitiveError.
inline constexpr float kOwnBoxPadding = 8 * kUnitRoundoff;
inline constexpr float kOwnSlabPadding = 12 * kUnitRoundoff;

/// A hit's distance from the surface, relative.
inline constexpr float kSurfaceError = 32 * kUnitRoundoff;
/// How close to a sphere's silhouette a ray must pass for the sphere test to take a hit for a miss or the reverse, relative to the origin's distance from the
/// centre and the radius; of spheres whose radius is 2^-40 or more, since of smaller ones what is left of squares is denormal.
inline constexpr float kSilhouetteError = 0x1p-43f;
/// How far off, across the ray and relative to its distance from the origin, a kernel sees a vertex; it sees it alike in all triangles and polygons.
inline constexpr float kSeenVertexError = 10 * kUnitRoundoff;

}  // namespace raymeter
