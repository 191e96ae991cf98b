#include "core/scene/light_target.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "core/base/threads.h"
#include "core/bounds/aabb.h"
#include "core/geometry/error_bounds.h"

namespace raymeter {

constexpr double kEnough = 0x1.ffp-1;  // what kLightLift has to spare
static_assert(kEnough * kLightLift >= double{kSurfaceError} + 2 * double{kUnitRoundoff});

namespace {

using glm::dvec3;

// ---- Which primitives a light lies on.

dvec3 at(const FloatColumns3& columns, std::size_t i) noexcept { return {double{columns[0][i]}, double{columns[1][i]}, double{columns[2][i]}}; }

/// The plane through `origin`, as a contact; none where it has no normal.
std::optional<LightContact> plane_contact(const dvec3& light, const dvec3& origin, const dvec3& normal) noexcept {
  const double length = glm::length(normal);
  if (!(length > 0)) return std::nullopt;
  return LightContact{normal / length, glm::dot(normal, light - origin) / length};
}

/// At a point without a tangent plane: the end of a cone, or all of a sphere without radius.
LightContact point_contact(const dvec3& axis, double along, double across, double touch) noexcept {
  LightContact contact{axis, -touch};
  contact.along = along;
  contact.across = across;
  return contact;
}

std::optional<LightContact> sphere_contact(const SpherePool& pool, std::size_t i, const dvec3& light, double touch) noexcept {
  const dvec3 f = light - at(pool.center, i);
  const double distance = glm::length(f), radius = double{pool.radius[i]};
  if (radius + distance <= touch) return point_contact(dvec3(0.0), 0, 1, touch);
  if (!(distance > 0)) return std::nullopt;
  LightContact contact{f / distance, distance - radius};
  contact.room = radius;
  return contact;
}

std::optional<LightContact> cone_contact(const ConePool& pool, std::size_t i, const dvec3& light, double touch) noexcept {
  const dvec3 axis = at(pool.axis, i), f = light - at(pool.base, i);
  const double length = glm::length(axis);
  if (!(length > 0)) return std::nullopt;
  const double taper = (double{pool.radius[1][i]} - double{pool.radius[0][i]}) / length;
  const double cosine = 1 / std::hypot(1.0, taper);
  const dvec3 along = axis / length;
  const double height = glm::dot(f, along);
  const dvec3 w = f - height * along;
  const double off_axis = glm::length(w), radius = double{pool.radius[0][i]} + taper * height;
  if (radius <= touch && off_axis <= touch) return point_contact(taper > 0 ? -along : along, std::abs(taper) * cosine, cosine, touch);
  if (!(off_axis > 0)) return std::nullopt;
  LightContact contact{cosine * (w / off_axis - taper * along), cosine * (off_axis - radius)};
  contact.room = radius;
  return contact;
}

std::optional<LightContact> contact_of(const Pools& pools, PrimRef ref, const dvec3& light, double touch) noexcept {
  const std::size_t i = ref.index;
  switch (ref.kind()) {
    case PrimKind::sphere: return sphere_contact(pools.spheres, i, light, touch);
    case PrimKind::cone: return cone_contact(pools.cones, i, light, touch);
    case PrimKind::polygon:
      return plane_contact(light, at(pools.polygons.vertex, static_cast<std::size_t>(pools.polygons.first_vertex[i])), at(pools.polygons.normal, i));
    case PrimKind::triangle: {
      const dvec3 a = at(pools.triangles.vertex[0], i);
      return plane_contact(light, a, glm::cross(at(pools.triangles.vertex[1], i) - a, at(pools.triangles.vertex[2], i) - a));
    }
  }
  return std::nullopt;
}

/// Whether the light is in the box, or as good as: a quick look, by twice what counts.
bool near_box(const Aabb& box, const glm::vec3& light) noexcept {
  const glm::vec3 extent = box.extent();
  const float around = 2 * static_cast<float>(kLightTouch) * (std::abs(light.x) + std::abs(light.y) + std::abs(light.z) + extent.x + extent.y + extent.z);
  return light.x >= box.min.x - around && light.x <= box.max.x + around && light.y >= box.min.y - around && light.y <= box.max.y + around &&
         light.z >= box.min.z - around && light.z <= box.max.z + around;
}

/// The contact of a primitive that the light is on. Of planes, all that is within the box counts: to be lifted off more than need be does little.
std::optional<LightContact> touching(const Pools& pools, PrimRef ref, const Aabb& box, const dvec3& light) noexcept {
  const dvec3 low(box.min), high(box.max);
  const double size = glm::length(high - low);
  const double touch = kLightTouch * (std::abs(light.x) + std::abs(light.y) + std::abs(light.z) + size);
  if (glm::any(glm::lessThan(light, low - touch)) || glm::any(glm::greaterThan(light, high + touch))) return std::nullopt;
  std::optional<LightContact> contact = contact_of(pools, ref, light, touch);
  if (!contact || !(std::abs(contact->height) <= touch)) return std::nullopt;
  contact->size = size;
  return contact;
}

// ---- Where rays to it end.

EndSide side_of(const LightContact& contact, const dvec3& to_org, double distance) noexcept {
  const double lift = kLightLift * (distance + contact.size);
  if (contact.across > 0) {
    const dvec3 across = to_org - glm::dot(to_org, contact.normal) * contact.normal;
    const double off_axis = glm::length(across);
    const dvec3 plane = contact.along * contact.normal + (off_axis > 0 ? contact.across / off_axis * across : dvec3(0.0));
    if (glm::dot(plane, to_org) >= 0) return {plane, contact.height, lift};
    return {-contact.normal, contact.height, lift / contact.along};  // inside: along the axis, as far from all sides
  }
  const bool outside = glm::dot(contact.normal, to_org) + contact.height >= 0;
  return outside ? EndSide{contact.normal, contact.height, lift} : EndSide{-contact.normal, -contact.height, std::min(lift, contact.room)};
}

}  // namespace

dvec3 LightTarget::seen_from(const dvec3& org, const EndSide& left) const noexcept {
  if (contacts.empty()) return light + std::max(left.wanted - left.light_height, 0.0) * left.normal;
  constexpr int kRounds = 8;
  const dvec3 to_org = org - light;
  const double distance = glm::length(to_org);
  dvec3 lift(0.0);
  const auto height = [&](const EndSide& side) { return side.light_height + glm::dot(side.normal, lift); };
  bool settled = false;
  const auto rise_above = [&](const EndSide& side) {
    if (height(side) >= kEnough * side.wanted) return;
    lift += (side.wanted - height(side)) * side.normal;
    settled = false;
  };
  for (int round = 0; round < kRounds && !settled; ++round) {
    settled = true;
    rise_above(left);
    for (const LightContact& contact : contacts) rise_above(side_of(contact, to_org, distance));
  }
  if (settled) return light + lift;
  // In a narrow wedge: towards the origin, which is above all of the planes.
  double back = 0;
  for (const LightContact& contact : contacts) {
    const EndSide side = side_of(contact, to_org, distance);
    const double here = height(side), there = side.light_height + glm::dot(side.normal, to_org);
    if (here < side.wanted) back = std::max(back, there > side.wanted ? (side.wanted - here) / (there - here) : 1.0);
  }
  return light + lift + std::min(back, 0.5) * (to_org - lift);
}

std::vector<LightTarget> light_targets(const Scene& scene, std::span<const Light> lights, int threads) {
  std::vector<LightTarget> targets;
  for (const Light& light : lights) targets.push_back({light.position, {}});
  if (targets.empty()) return targets;
  struct Found {
    std::size_t prim, light;
    LightContact contact;
  };
  std::vector<Found> found;
  std::mutex mutex;
  const auto look_at = [&](std::size_t prim) {
    const PrimRef ref = scene.prim(static_cast<std::int32_t>(prim));
    if (ref.dropped()) return;
    const Aabb box = tight_bounds(scene.pools(), ref);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      if (!near_box(box, glm::vec3(targets[i].light))) continue;
      const std::optional<LightContact> contact = touching(scene.pools(), ref, box, targets[i].light);
      if (!contact) continue;
      const std::lock_guard lock(mutex);
      found.push_back({prim, i, *contact});
    }
  };
  on_threads(threads, [&] { for_each_index(static_cast<std::size_t>(scene.prim_id_count()), look_at); });
  std::sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return a.prim < b.prim; });
  for (const Found& one : found) targets[one.light].contacts.push_back(one.contact);
  return targets;
}

}  // namespace raymeter
