#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/scene/surface.h"

namespace raymeter {

/// By which rule the origin of a secondary ray is lifted off the surface that it leaves. Only the bound promises anything.
struct OriginOffset {
  enum class Rule : std::uint8_t {
    bound,     ///< by Surface::clearance, what the kernels may err
    fixed,     ///< by `amount`, in the scene's units
    relative,  ///< by `amount` ulp of the point's largest coordinate; 256 are about what Waechter, Binder 2019 (Ray Tracing Gems, ch. 6) lift by
  };
  Rule rule = Rule::bound;
  double amount = 0;

  [[nodiscard]] Surface lift(Surface surface) const noexcept;
};

/// "bound", "1e-4", "16ulp"; amounts are finite and not negative.
[[nodiscard]] std::optional<OriginOffset> origin_offset_from_text(std::string_view text) noexcept;
[[nodiscard]] std::string to_string(const OriginOffset& offset);

}  // namespace raymeter
