#pragma once

#include "accel/kernel_set.h"
#include "core/trace/intersector.h"

namespace raymeter {

/// Runs a kernel set over a structure's view. The structure must outlive it.
template <class View>
class KernelIntersector : public Intersector {
public:
  KernelIntersector(const View& view, const KernelSet<View>& kernels, int packet, std::size_t scratch_bytes = 0)
      : view_(view), kernels_(kernels), packet_(packet), scratch_bytes_(scratch_bytes) {}

  [[nodiscard]] std::size_t scratch_bytes() const noexcept override { return scratch_bytes_; }
  void closest_hit(const RayView& rays, const HitView& hits, Counters* counters, std::byte* scratch) const noexcept override {
    const auto kernel = counters != nullptr ? kernels_.counted_closest : kernels_.timed_closest;
    kernel(view_, {rays, hits, nullptr, packet_, scratch}, counters);
  }
  void any_hit(const RayView& rays, std::int32_t* blocker, Counters* counters, std::byte* scratch) const noexcept override {
    const auto kernel = counters != nullptr ? kernels_.counted_any : kernels_.timed_any;
    kernel(view_, {rays, {}, blocker, packet_, scratch}, counters);
  }

protected:
  View view_;

private:
  KernelSet<View> kernels_;
  int packet_;
  std::size_t scratch_bytes_;
};

}  // namespace raymeter
