#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/column.h"
#include "core/ray/ray_batch.h"
#include "experiments/atomic_file.h"

namespace raymeter {

/// Reads NumPy's .npy format, versions 1 to 3: rays as float32, shape (N, 8), C order: ox oy oz tmin dx dy dz tmax.
/// Throws Error, "<name>: what, what was expected".
[[nodiscard]] RayBatch parse_rays_npy(std::string_view bytes, std::string_view name);
[[nodiscard]] RayBatch read_rays_npy(const std::string& path);

/// Structured array [('t','<f4'),('prim','<i4'),('u','<f4'),('v','<f4')], one element a ray.
void write_hits_npy(AtomicFile& file, const HitBatch& hits);
/// uint8, one element a ray: 1 where something blocks it.
void write_blocked_npy(AtomicFile& file, const Column<std::int32_t>& blocker);

}  // namespace raymeter
