#include "tests/support/capsule_bvh.h"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "accel/bvh/bvh_structure.h"
#include "core/bounds/outward_rounding.h"
#include "core/bounds/prim_hull.h"
#include "tests/support/capsule_layout.h"

namespace raymeter::test {

namespace {

struct Capsule {
  glm::vec3 center{0.0f};
  float half = 0;
  float radius = 0;
  glm::length_t axis = 0;
};

/// Along the longest side of the box.
struct CapsuleVolume {
  using Bound = Capsule;
  using Layout = CapsuleLayout;
  static constexpr bool kMergeIsTight = false;

  [[nodiscard]] Capsule fit(const Scene& scene, PrimRef prim) const { return fit(scene, {&prim, 1}); }
  [[nodiscard]] Capsule fit(const Scene& scene, std::span<const PrimRef> prims) const {
    std::vector<PrimHull> hulls;
    Aabb box;
    for (const PrimRef prim : prims) {
      hulls.push_back(prim_hull(scene.pools(), prim));
      box.grow(tight_bounds(scene.pools(), prim));
    }
    return around(box, [&](const glm::dvec3& direction, const glm::dvec3& from) {
      double most = 0;
      for (const PrimHull& hull : hulls) most = std::max(most, hull.reach(direction, from));
      return most;
    });
  }
  [[nodiscard]] Capsule merge(const Capsule& a, const Capsule& b) const noexcept {
    Aabb box;
    for (const Capsule* capsule : {&a, &b}) {
      glm::vec3 reach(capsule->radius);
      reach[capsule->axis] += capsule->half;
      box.grow(capsule->center - reach);
      box.grow(capsule->center + reach);
    }
    return around(box, [&](const glm::dvec3& direction, const glm::dvec3& from) {
      double most = 0;
      for (const Capsule* capsule : {&a, &b}) {
        const double along = double{capsule->half} * std::abs(direction[capsule->axis]) + double{capsule->radius};
        most = std::max(most, glm::dot(direction, glm::dvec3(capsule->center) - from) + along);
      }
      return most;
    });
  }
  [[nodiscard]] double half_area(const Capsule& c) const noexcept { return 2 * std::numbers::pi * double{c.radius} * (double{c.radius} + double{c.half}); }
  [[nodiscard]] double enclosed(const Capsule& c) const noexcept {
    const double r = double{c.radius};
    return std::numbers::pi * r * r * (2 * double{c.half} + 4 * r / 3);
  }
  [[nodiscard]] std::int32_t floats() const noexcept { return Layout::kFloats; }
  [[nodiscard]] Layout::Shared shared(std::span<const Bound>) const noexcept { return {}; }
  void write(const Capsule& capsule, float* data) const noexcept {
    for (glm::length_t a = 0; a < 3; ++a) data[a] = capsule.center[a];
    data[3] = capsule.half;
    data[4] = capsule.radius;
    data[5] = static_cast<float>(capsule.axis);
  }

private:
  /// reach(direction, from): how far everything lies from a point in a unit direction, at most.
  template <class Reach>
  static Capsule around(const Aabb& box, Reach&& reach) {
    Capsule capsule;
    capsule.center = glm::vec3((glm::dvec3(box.min) + glm::dvec3(box.max)) / 2.0);
    for (glm::length_t a = 1; a < 3; ++a) {
      if (box.extent()[a] > box.extent()[capsule.axis]) capsule.axis = a;
    }
    glm::dvec3 most;
    for (glm::length_t a = 0; a < 3; ++a) {
      glm::dvec3 direction(0.0);
      direction[a] = 1;
      most[a] = std::max(reach(direction, glm::dvec3(capsule.center)), reach(-direction, glm::dvec3(capsule.center)));
    }
    capsule.half = round_up(most[capsule.axis]);
    most[capsule.axis] = 0;
    capsule.radius = round_up(glm::length(most) * (1 + 0x1p-48));
    return capsule;
  }
};
static_assert(BoundingVolume<CapsuleVolume>);

std::vector<ParamInfo> capsule_params() {
  std::vector<ParamInfo> infos;
  for (ParamInfo& info : param_infos<BvhParams>()) {
    if (info.key == "builder" || info.key == "traversal") infos.push_back(std::move(info));
  }
  return infos;
}

std::unique_ptr<Structure> build_capsules(const Scene& scene, const ParamValues& values, int threads) {
  return std::make_unique<BvhStructure<CapsuleVolume>>(scene, build_bvh_tree(scene, bind<BvhParams>(values), threads), CapsuleVolume(), threads);
}

}  // namespace

const StructureEntry& capsule_bvh_entry() {
  static constexpr StructureEntry kEntry{"capsule_bvh", "a hierarchy of capsules", "this test", capsule_params, resolve_bvh, build_capsules};
  return kEntry;
}

}  // namespace raymeter::test
