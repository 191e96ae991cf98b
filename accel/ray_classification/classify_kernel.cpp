// Rays to points of five dimensions (Arvo, Kirk 1987): the origin, moved along the ray to where its interval and the scene's box begin; the dominant axis
// and its sign; the two slopes. Each coordinate becomes the number of its cell, and the bits of these numbers, in the order of the class' splits, the key.
//
// What is lost. The start is on the ray but for rounding, for the padding of the slab test (three times kSlabPadding at most, where the ray begins behind its
// origin) and for being clamped into the box: off by less than 72 unit roundoffs of the ray's way and of the coordinates; slopes are off by one. Beams are
// padded by more (beam.h). A ray that is level with the box's face is in a border cell. Where two components of the direction are equally large either axis
// would do, with a slope of 1 in the last cell.

#include "accel/ray_classification/classify_kernel.h"

#include "core/bounds/slab_kernel.h"
#include "core/ray/packet_loop.h"

namespace raymeter {

namespace {

template <class L>
typename L::Int cell_number(typename L::Float offset, typename L::Float cells_per_unit, typename L::Float last) noexcept {
  using Float = typename L::Float;
  return L::truncate(L::min(L::max(offset * cells_per_unit, Float(0.0f)), last));
}

/// The numbers of one register of rays on all axes, and their classes.
template <class L>
struct Coordinates {
  alignas(64) std::int32_t number[kRayAxes][L::kWidth];
  alignas(64) std::int32_t ray_class[L::kWidth];

  /// `more_slack`: what rays from beyond the frame's reach need besides.
  Coordinates(const RayClassFrame& frame, const RayPacket<L>& ray, const HitPacket<L>& hit, typename L::Float more_slack) noexcept {
    using Float = typename L::Float;
    using Int = typename L::Int;
    const Float zero(0.0f);
    const SlabInterval<L> inside = intersect_box(ray, hit.t, BoxPlanes<L, false>(frame.box, 0));
    typename L::Mask serves = inside.t_near <= inside.t_far;
    const typename L::Mask meets = inside.t_near - more_slack <= inside.t_far + more_slack;
    Int on_axis[3];
    for (int a = 0; a < 3; ++a) {
      serves = serves & (L::abs(ray.org[a] - Float(frame.center[a])) <= Float(frame.reach[a]));
      const Float low(frame.box[a]);
      const Float start = L::select(ray.dir[a] == zero, ray.org[a], L::mul_add(inside.t_near, ray.dir[a], ray.org[a]));
      on_axis[a] = cell_number<L>(start - low, Float(frame.cells_per_unit[a]), Float(frame.last_cell[a]));
    }
    const auto pick = [&](const auto& x_major, const auto& y_major, const auto& z_major) noexcept {
      return L::select(ray.axis_is_z, z_major, L::select(ray.axis_is_y, y_major, x_major));
    };
    for (int c = 0; c < 3; ++c) L::store(number[c], pick(on_axis[(c + 1) % 3], on_axis[(c + 2) % 3], on_axis[c]));
    const typename L::Mask negative = ray.shear[2] < zero;
    for (int c = 0; c < 2; ++c) {
      const Float slope = L::select(negative, -ray.shear[c], ray.shear[c]);
      L::store(number[3 + c], cell_number<L>(slope + Float(1.0f), Float(frame.slope_cells), Float(frame.last_slope)));
    }
    const Int positive_class = L::select(ray.axis_is_z, Int(4), L::select(ray.axis_is_y, Int(2), Int(0)));
    const Int own_class = positive_class + L::select(negative, Int(1), Int(0));
    L::store(ray_class, L::select(serves, own_class, L::select(meets, Int(kUnclassified), Int(kNowhere))));
  }
};

std::uint64_t key_of(const RayClassFrame& frame, std::int32_t ray_class, const std::int32_t (&number)[kRayAxes]) noexcept {
  std::uint64_t key = static_cast<std::uint64_t>(ray_class) << frame.key_bits;
  if (ray_class >= kRayClasses) return key;
  const std::uint64_t* spread = frame.spread + (static_cast<std::int64_t>(ray_class) * kRayAxes * 2 << kHalfBits);
  constexpr std::int32_t kMask = (1 << kHalfBits) - 1;
  for (const std::int32_t n : number) {
    key |= spread[n & kMask] | spread[(1 << kHalfBits) + (n >> kHalfBits)];
    spread += 2 << kHalfBits;
  }
  return key;
}

}  // namespace

template <Isa I>
void ClassifyKernel<I>::keys(const RayClassFrame& frame, const RayView& rays, std::int32_t first, std::int32_t count, std::uint64_t* keys) noexcept {
  using L = Lanes<I>;
  for (std::int32_t done = 0; done < count; done += L::kWidth) {
    const std::int32_t group = count - done < L::kWidth ? count - done : L::kWidth;
    RayPacket<L> ray;
    HitPacket<L> hit;
    load_group<L>(rays, first + done, group, ray, hit);
    const typename L::Float slack = ray.slab_slack;
    ray.slab_slack = L::min(slack, typename L::Float(frame.most_slack));
    const Coordinates<L> at(frame, ray, hit, slack - ray.slab_slack);
    for (std::int32_t lane = 0; lane < group; ++lane) {
      const std::int32_t number[kRayAxes] = {at.number[0][lane], at.number[1][lane], at.number[2][lane], at.number[3][lane], at.number[4][lane]};
      keys[first + done + lane] = key_of(frame, at.ray_class[lane], number);
    }
  }
}

template struct ClassifyKernel<kKernelIsa>;

}  // namespace raymeter
