#pragma once

#include <cstddef>
#include <cstdint>

namespace raymeter {

/// What has been made for the batch that was prepared last, and altogether.
struct DemandStats {
  std::int64_t cells = 0;       ///< that the batch uses
  std::int64_t candidates = 0;  ///< in all of their lists
  std::size_t bytes = 0;        ///< of all that is kept, the batch's cells and others
  double full_bytes = 0;        ///< extrapolated: of the cells, if all rays that there are had some like the batch's
};

/// Intersectors that make parts of their structure in prepare() are this too: their first pass is another than the steady ones.
class OnDemand {
public:
  virtual ~OnDemand() = default;
  [[nodiscard]] virtual DemandStats demand() const noexcept = 0;
};

}  // namespace raymeter
