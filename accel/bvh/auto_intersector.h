#pragma once

#include <array>
#include <atomic>
#include <memory>

#include "accel/bvh/beam_estimate.h"
#include "core/trace/intersector.h"

namespace raymeter {

/// Gives each slice of a batch to beams, to streams or to single rays, by how many rays there are and what they have in common. A slice's choice is its own: no
/// call depends on another.
class AutoIntersector final : public Intersector {
public:
  struct Traversals {
    std::unique_ptr<Intersector> beams, streams, singles;
  };
  /// `packet`: rays per packet of beams and streams, `simd_width` those of a register, `group` those whose beams go down together. `box`: of the scene, min x y
  /// z, max x y z.
  AutoIntersector(Traversals traversals, int packet, int simd_width, int group, const LeafSizes& leaves, const float (&box)[6]);

  [[nodiscard]] std::string choice(Query query) const override;
  [[nodiscard]] const Intersector& suited(const RayView& slice, Query query) const noexcept override { return of(chosen_for(slice, query)); }
  [[nodiscard]] std::size_t scratch_bytes() const noexcept override;
  void closest_hit(const RayView& rays, const HitView& hits, Counters* counters, std::byte* scratch) const noexcept override;
  void any_hit(const RayView& rays, std::int32_t* blocker, Counters* counters, std::byte* scratch) const noexcept override;

private:
  enum Choice : unsigned { single = 1, beam = 2, stream = 4 };
  [[nodiscard]] bool suits_beams(const RayView& slice, Query query) const noexcept;
  [[nodiscard]] Choice chosen_for(const RayView& slice, Query query) const noexcept;
  [[nodiscard]] const Intersector& of(Choice choice) const noexcept;
  /// The traversal chosen, and that it was.
  [[nodiscard]] const Intersector& take(const RayView& slice, Query query) const noexcept;

  Traversals traversals_;
  int packet_;
  int least_beam_;
  bool whole_groups_;
  LeafSizes leaves_;
  std::array<float, 6> box_;
  mutable std::array<std::atomic<unsigned>, 2> chosen_{};  ///< by query: all choices so far, for records alone
};

}  // namespace raymeter
