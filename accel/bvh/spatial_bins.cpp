#include "accel/bvh/spatial_bins.h"

#include <array>

namespace raymeter {

namespace {

using Corners = std::array<Row4, 3>;

Corners corners_of(const TrianglePool& pool, std::uint32_t triangle) noexcept {
  Corners corners;
  for (std::size_t v = 0; v < 3; ++v) corners[v] = Row4{pool.vertex[v][0][triangle], pool.vertex[v][1][triangle], pool.vertex[v][2][triangle], 0.0f};
  return corners;
}

void grow(Box4& box, const Row4& point) noexcept { grow(box, {point, point}); }

/// Boxes of the parts of a triangle between the borders of bins `first` to `last`.
void cut_triangle(const Corners& corners, const SpatialMapping& mapping, int axis, int first, int last, Box4* part) noexcept {
  for (std::size_t v = 0; v < 3; ++v) {
    Row4 from = corners[v], to = corners[(v + 1) % 3];
    grow(part[std::clamp(mapping.bin(from[axis], axis), first, last)], from);
    if (from[axis] > to[axis]) std::swap(from, to);
    const int begin = std::max(mapping.bin(from[axis], axis), first), end = std::min(mapping.bin(to[axis], axis), last);
    if (begin >= end) continue;
    const Row4 slope = (to - from) / (to[axis] - from[axis]);
    for (int b = begin; b < end; ++b) {
      const Row4 point = from + slope * (mapping.border(b + 1, axis) - from[axis]);
      grow(part[b], point);
      grow(part[b + 1], point);
    }
  }
}

/// The parts of a box there.
void cut_box(const Box4& box, const SpatialMapping& mapping, int axis, int first, int last, Box4* part) noexcept {
  for (int b = first; b <= last; ++b) {
    part[b] = box;
    if (b > first) part[b].min[axis] = mapping.border(b, axis);
    if (b < last) part[b].max[axis] = mapping.border(b + 1, axis);
  }
}

void bin_part(const Scene& scene, const BinnedBox& reference, const SpatialMapping& mapping, Bins& bins) noexcept {
  const PrimRef prim = reference.prim();
  const bool is_triangle = prim.kind() == PrimKind::triangle;
  const Corners corners = is_triangle ? corners_of(scene.pools().triangles, prim.index) : Corners{};
  for (int a = 0; a < 3; ++a) {
    if (!mapping.usable(a)) continue;
    const int first = mapping.bin(reference.box.min[a], a), last = mapping.bin(reference.box.max[a], a);
    ++bins.entering[a][first];
    ++bins.leaving[a][last];
    if (first == last) {
      grow(bins.box[a][first], reference.box);
      continue;
    }
    std::array<Box4, kMaxBins> part;
    if (is_triangle) {
      std::fill(part.begin() + first, part.begin() + last + 1, kEmptyBox4);
      cut_triangle(corners, mapping, a, first, last, part.data());
    } else {
      cut_box(reference.box, mapping, a, first, last, part.data());
    }
    for (int b = first; b <= last; ++b) {
      Box4& box = part[static_cast<std::size_t>(b)];
      box.min = box.min > reference.box.min ? box.min : reference.box.min;  // what earlier splits have left of it
      box.max = box.max < reference.box.max ? box.max : reference.box.max;
      if (box.min[0] <= box.max[0] && box.min[1] <= box.max[1] && box.min[2] <= box.max[2]) grow(bins.box[a][b], box);
    }
  }
}

}  // namespace

SpatialMapping::SpatialMapping(const Box4& node, int bin_count) noexcept
    : bins(bin_count), box(node), width((node.max - node.min) / static_cast<float>(bin_count)), scale(1.0f / width) {
  for (int a = 0; a < 4; ++a) {
    const bool usable = a < 3 && width[a] > 0 && scale[a] < kInfinite && box.min[a] + width[a] > box.min[a];
    if (!usable) scale[a] = 0;
  }
}

void bin_parts(const Scene& scene, std::span<const BinnedBox> references, const SpatialMapping& mapping, Bins& bins) {
  over_parts(
      references, bins,
      [&](Bins& sum, std::span<const BinnedBox> part) {
        for (const BinnedBox& reference : part) bin_part(scene, reference, mapping, sum);
      },
      [&](Bins& sum, const Bins& part) { sum.add(part, mapping.bins); });
}

}  // namespace raymeter
