#include "core/scene/origin_offset.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace raymeter {

namespace {

constexpr std::string_view kBound = "bound", kUlp = "ulp";

}  // namespace

Surface OriginOffset::lift(Surface surface) const noexcept {
  const glm::dvec3 size = glm::abs(surface.point);
  if (rule == Rule::fixed) surface.clearance = amount;
  if (rule == Rule::relative) surface.clearance = amount * 2 * double{kUnitRoundoff} * std::max({size.x, size.y, size.z});
  return surface;
}

std::optional<OriginOffset> origin_offset_from_text(std::string_view text) noexcept {
  if (text == kBound) return OriginOffset{};
  const bool relative = text.ends_with(kUlp);
  if (relative) text.remove_suffix(kUlp.size());
  double amount = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), amount);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(amount) || amount < 0) return std::nullopt;
  return OriginOffset{relative ? OriginOffset::Rule::relative : OriginOffset::Rule::fixed, amount};
}

std::string to_string(const OriginOffset& offset) {
  if (offset.rule == OriginOffset::Rule::bound) return std::string(kBound);
  std::array<char, 32> digits{};
  const auto written = std::to_chars(digits.data(), digits.data() + digits.size(), offset.amount);
  return std::string(digits.data(), written.ptr) + (offset.rule == OriginOffset::Rule::relative ? std::string(kUlp) : "");
}

}  // namespace raymeter
