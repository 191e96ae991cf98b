#pragma once

// How far a primitive reaches from the eye, and where the edges and bounds of its footprint have to be moved to. The proof is in footprints.cpp.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "accel/zbuffer/footprints.h"
#include "core/bounds/aabb.h"
#include "core/geometry/error_bounds.h"

namespace raymeter {

inline constexpr double kRoundoff = kUnitRoundoff;

/// A float below x, and one above: not the nearest, but found without looking at what rounding did.
[[nodiscard]] inline float below(double x) noexcept { return static_cast<float>(x - std::abs(x) * 2 * kRoundoff - 0x1p-149); }
[[nodiscard]] inline float above(double x) noexcept { return static_cast<float>(x + std::abs(x) * 2 * kRoundoff + 0x1p-149); }

/// Depths of a primitive, and the distance of its farthest corner.
struct Reach {
  double near = std::numeric_limits<double>::infinity();
  double far = -std::numeric_limits<double>::infinity();
  double distance = 0;

  /// The least depth that a kernel may report.
  [[nodiscard]] double least() const noexcept { return near - 96 * kRoundoff * distance; }
  [[nodiscard]] bool behind() const noexcept { return far + 96 * kRoundoff * distance < 0; }
};

[[nodiscard]] inline Reach reach_of(const ImagePlane& plane, const Aabb& box) noexcept {
  const glm::dvec3 low = glm::dvec3(box.min) - plane.eye, high = glm::dvec3(box.max) - plane.eye;
  Reach reach{0, 0, 0};
  glm::dvec3 corner;
  for (glm::length_t a = 0; a < 3; ++a) {
    reach.near += std::min(plane.center[a] * low[a], plane.center[a] * high[a]);
    reach.far += std::max(plane.center[a] * low[a], plane.center[a] * high[a]);
    corner[a] = std::max(std::abs(low[a]), std::abs(high[a]));
  }
  reach.distance = glm::length(corner);
  return reach;
}

/// Bounds on the image that grow, in half samples.
struct ImageBounds {
  glm::dvec2 min{std::numeric_limits<double>::infinity()};
  glm::dvec2 max{-std::numeric_limits<double>::infinity()};

  void grow(const glm::dvec2& point) noexcept {
    min = glm::min(min, point);
    max = glm::max(max, point);
  }
  [[nodiscard]] double largest() const noexcept { return std::max({-min.x, max.x, -min.y, max.y}); }
};

/// A footprint being made: where its edges and bounds have to be moved to.
class Outline {
public:
  Outline(const ImagePlane& plane, PrimRef prim) noexcept : plane_(plane) {
    constexpr float kEverywhere = std::numeric_limits<float>::infinity();
    out_.print = {-kEverywhere, kEverywhere, -kEverywhere, kEverywhere, {}, kEverywhere, prim, false};
    out_.plane = {0, 0, kEverywhere};
  }

  /// The bounds, and how far they and all edges to come are moved outwards.
  void set_bounds(const ImageBounds& bounds, double epsilon) noexcept {
    epsilon_ = epsilon;
    largest_ = std::max(bounds.largest(), static_cast<double>(std::max(plane_.width, plane_.height)));
    out_.print.min_x = below(bounds.min.x - epsilon);
    out_.print.max_x = above(bounds.max.x + epsilon);
    out_.print.min_y = below(bounds.min.y - epsilon);
    out_.print.max_y = above(bounds.max.y + epsilon);
  }
  /// What lies on the inner side of the line normal . point = offset.
  void add_edge(const glm::dvec2& normal, double offset) noexcept {
    const double slack = (std::abs(normal.x) + std::abs(normal.y)) * (epsilon_ + 8 * kRoundoff * largest_);
    float* const edge = out_.print.edge[edges_++];
    edge[0] = static_cast<float>(normal.x);
    edge[1] = static_cast<float>(normal.y);
    edge[2] = above(slack - offset);
  }
  /// 1 / depth is normal . point + at_center, but for an error of `relative` of it and of `absolute`.
  void set_plane(const glm::dvec2& normal, double at_center, double relative, double absolute) noexcept {
    if (!(relative < 0.25)) return;
    const double slack = (std::abs(normal.x) + std::abs(normal.y)) * (epsilon_ + 8 * kRoundoff * largest_) + 8 * kRoundoff * std::abs(at_center) + absolute;
    const double grown = 1 / (1 - relative);
    out_.print.flat = true;
    out_.plane = {static_cast<float>(grown * normal.x), static_cast<float>(grown * normal.y), above(grown * (at_center + slack))};
  }
  /// Nothing where all of it is beside the image.
  [[nodiscard]] std::optional<Projected> finished(const Reach& reach) noexcept {
    const auto x = static_cast<float>(plane_.width - 1), y = static_cast<float>(plane_.height - 1);
    if (out_.print.min_x > x || out_.print.max_x < -x || out_.print.min_y > y || out_.print.max_y < -y) return std::nullopt;
    if (reach.least() > 0) out_.print.nearest = above(1 / reach.least());
    if (!out_.print.flat) out_.plane.at_center = out_.print.nearest;
    return out_;
  }
  [[nodiscard]] std::optional<Projected> everywhere() const noexcept { return out_; }

private:
  const ImagePlane& plane_;
  Projected out_;
  int edges_ = 0;
  double epsilon_ = 0;
  double largest_ = 0;
};

}  // namespace raymeter
