#pragma once

#include <cstring>
#include <span>
#include <vector>

#include "accel/volume_links_layout.h"
#include "core/base/column.h"
#include "core/bounds/bounding_volume.h"

namespace raymeter {

/// Owns links with their volumes, as kernels read them.
template <BoundingVolume V>
class VolumeLinks {
public:
  using Layout = typename V::Layout;

  /// bounds[i] belongs to links[i].
  VolumeLinks(const V& volume, std::span<const VolumeLink> links, std::span<const typename V::Bound> bounds, std::vector<PrimitiveRun> runs)
      : runs_(std::move(runs)), shared_(volume.shared(bounds)), link_bytes_(volume_link_bytes(volume.floats())) {
    const auto stride = static_cast<std::size_t>(link_bytes_);
    links_.resize(links.size() * stride);
    std::vector<float> data(static_cast<std::size_t>(volume.floats()));
    for (std::size_t i = 0; i < links.size(); ++i) {
      volume.write(bounds[i], data.data());
      std::memcpy(links_.data() + i * stride, &links[i], sizeof(VolumeLink));
      std::memcpy(links_.data() + i * stride + sizeof(VolumeLink), data.data(), data.size() * sizeof(float));
    }
  }
  [[nodiscard]] VolumeLinksView<Layout> view(const Pools& pools) const noexcept { return {links_.data(), runs_.data(), pools.view(), shared_, link_bytes_}; }
  [[nodiscard]] std::size_t mem_bytes() const noexcept { return links_.bytes() + runs_.capacity() * sizeof(PrimitiveRun); }

private:
  Column<std::byte> links_;
  std::vector<PrimitiveRun> runs_;
  typename Layout::Shared shared_;
  std::int32_t link_bytes_;
};

/// The link to primitives that are given as runs; several go to the end of `runs`.
[[nodiscard]] inline VolumeLink link_to(std::span<const PrimitiveRun> primitives, std::vector<PrimitiveRun>& runs) {
  if (primitives.size() == 1) return {primitives[0].kind_and_count, primitives[0].first};
  const VolumeLink link = volume_link(VolumeLink::kRuns, runs.size(), primitives.size());
  runs.insert(runs.end(), primitives.begin(), primitives.end());
  return link;
}

}  // namespace raymeter
