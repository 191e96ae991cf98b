#pragma once

// When a ray crosses the next plane of an axis: the forms that a 3D-DDA has for it. u is the unit roundoff, org the origin's distance from the plane.
//
//   recompute    (plane - org) * inv_dir from the plane's index: 3u relative, on which the walk's proof rests. The default.
//   divide       (plane - org) / dir: 2u relative, a division a step.
//   fma          index * (cell_size * inv_dir) + (origin - org) * inv_dir in one operation: 4u of the larger of the terms,
//                which is more than the crossing where they cancel, that is where the ray starts inside the grid or far
//                from its low side.
//   accumulate   t += cell_size * |inv_dir| (Amanatides, Woo 1987): a rounding a step, of the same sign as long as the exponent stays, so that the error grows
//                with the number of steps.
//   compensated  the same, what a sum has lost being added to the next step (Kahan 1965): 2u relative for the step beside 3u for the first crossing.
//
// Only the first two are proven to lose no hit. What cells answer by any form but the default is listed, not held to ours (accel/weak_settings.h).

#include "accel/grid/grid_layout.h"
#include "core/ray/ray_packet.h"

namespace raymeter {

/// What a form keeps of an axis.
template <class L, DdaForm F>
struct DdaAxis {};
template <class L>
struct DdaAxis<L, DdaForm::fma> {
  typename L::Float per_plane;  ///< from one plane to the next; negative where the ray goes down
  typename L::Float first;      ///< crossing of plane 0
};
template <class L>
struct DdaAxis<L, DdaForm::accumulate> {
  typename L::Float per_step;
};
template <class L>
struct DdaAxis<L, DdaForm::compensated> {
  typename L::Float per_step;
  typename L::Float excess;  ///< of the last crossing over the sum of all steps
};

/// The constants of axis `a`.
template <class L, DdaForm F>
[[gnu::always_inline]] inline DdaAxis<L, F> dda_axis(const GridCells& cells, const RayPacket<L>& ray, int a) noexcept {
  using Float = typename L::Float;
  if constexpr (F == DdaForm::fma) return {Float(cells.cell_size[a]) * ray.inv_dir[a], (Float(cells.origin[a]) - ray.org[a]) * ray.inv_dir[a]};
  if constexpr (F == DdaForm::accumulate) return {Float(cells.cell_size[a]) * L::abs(ray.inv_dir[a])};
  if constexpr (F == DdaForm::compensated) return {Float(cells.cell_size[a]) * L::abs(ray.inv_dir[a]), Float(0.0f)};
  return {};
}

/// When the rays cross plane `index`, without looking back.
template <class L, DdaForm F>
[[gnu::always_inline]] inline typename L::Float crossing(const GridCells& cells, const RayPacket<L>& ray, const DdaAxis<L, F>& axis, int a,
                                                         typename L::Float index) noexcept {
  using Float = typename L::Float;
  if constexpr (F == DdaForm::fma) return L::mul_add(index, axis.per_plane, axis.first);
  const Float way = grid_plane(index, Float(cells.cell_size[a]), Float(cells.origin[a])) - ray.org[a];
  if constexpr (F == DdaForm::divide) return way / ray.dir[a];
  return way * ray.inv_dir[a];
}

/// The crossing of plane `index`, which lanes in `here` have come to from the one before, crossed at t; the other lanes stay at t.
template <class L, DdaForm F>
[[gnu::always_inline]] inline typename L::Float crossing_after_step(const GridCells& cells, const RayPacket<L>& ray, DdaAxis<L, F>& axis, int a,
                                                                    typename L::Float index, typename L::Float t, typename L::Mask here) noexcept {
  using Float = typename L::Float;
  const Float zero(0.0f);
  if constexpr (F == DdaForm::accumulate) {
    return t + L::select(here, axis.per_step, zero);
  } else if constexpr (F == DdaForm::compensated) {
    const Float step = axis.per_step - axis.excess;
    const Float sum = t + step;
    axis.excess = L::select(here, (sum - t) - step, axis.excess);
    return L::select(here, sum, t);
  } else {
    return crossing<L, F>(cells, ray, axis, a, index);
  }
}

}  // namespace raymeter
