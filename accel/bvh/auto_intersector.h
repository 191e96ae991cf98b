#pragma once

#include <array>
#include <atomic>
#include <memory>

#include "core/trace/intersector.h"

namespace raymeter {

/// Gives each slice of a batch to beams or to streams, by what its rays have in common. A slice's choice is its own: no call depends on another.
class AutoIntersector final : public Intersector {
public:
  /// `packet`: rays per packet of both.
  AutoIntersector(std::unique_ptr<Intersector> beams, std::unique_ptr<Intersector> streams, int packet)
      : beams_(std::move(beams)), streams_(std::move(streams)), packet_(packet) {}

  void prepare(const RayView& rays, Query query, int threads) override;
  [[nodiscard]] std::string choice(Query query) const override;
  [[nodiscard]] std::size_t scratch_bytes() const noexcept override;
  void closest_hit(const RayView& rays, const HitView& hits, Counters* counters, std::byte* scratch) const noexcept override;
  void any_hit(const RayView& rays, std::int32_t* blocker, Counters* counters, std::byte* scratch) const noexcept override;

private:
  enum Choice : int { none, beam, stream, both };
  [[nodiscard]] bool suits_beams(const RayView& slice) const noexcept;
  [[nodiscard]] const Intersector& suited(const RayView& slice) const noexcept { return suits_beams(slice) ? *beams_ : *streams_; }

  std::unique_ptr<Intersector> beams_, streams_;
  int packet_;
  std::array<std::atomic<int>, 2> choice_{};  ///< by query: of the batch that was prepared last, for records alone
};

}  // namespace raymeter
