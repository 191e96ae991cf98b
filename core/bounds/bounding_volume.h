#pragma once

#include <concepts>
#include <span>

#include "core/bounds/volume_layout.h"
#include "core/scene/scene.h"

namespace raymeter {

/// The host side of a kind of bounding volume, a small value that builders are templates over; a k-DOP's carries its directions. A Bound is one volume's data.
///
/// fit(scene, prim)     around a primitive, conservative: every hit that the primitive's kernel may accept is inside, but for what the volume's packet test
/// adds
///                      with the distance of the ray's origin (core/geometry/error_bounds.h).
/// fit(scene, prims)    around several, as tight as this kind of volume gets; at least one.
/// merge(a, b)          holds every point of a and b.
/// half_area(a)         half of its surface area: in proportion to the number of random lines that meet it.
/// enclosed(a)          the volume inside it.
/// kMergeIsTight        merging single fits is as tight as fitting all at once.
/// Layout, write, ...   what kernels read: write(a, data) fills floats() numbers, shared(bounds) is what all volumes of a structure have in common
///                      (volume_layout.h).
template <class V>
concept BoundingVolume = requires(const V& volume, const Scene& scene, PrimRef prim, std::span<const PrimRef> prims, const typename V::Bound& bound,
                                  std::span<const typename V::Bound> bounds, float* data) {
  { volume.fit(scene, prim) } -> std::same_as<typename V::Bound>;
  { volume.fit(scene, prims) } -> std::same_as<typename V::Bound>;
  { volume.merge(bound, bound) } -> std::same_as<typename V::Bound>;
  { volume.half_area(bound) } -> std::same_as<double>;
  { volume.enclosed(bound) } -> std::same_as<double>;
  { V::kMergeIsTight } -> std::convertible_to<bool>;
  { volume.floats() } -> std::same_as<std::int32_t>;
  { volume.shared(bounds) } -> std::same_as<typename V::Layout::Shared>;
  volume.write(bound, data);
};

}  // namespace raymeter
