#pragma once

#include <string_view>

#include <gtest/gtest.h>

#include "accel/registry.h"
#include "core/trace/trace.h"

namespace raymeter::test {

/// One test an instruction set; skipped where the machine lacks it.
class KernelTest : public testing::TestWithParam<Isa> {
protected:
  void SetUp() override {
    if (!available(GetParam())) GTEST_SKIP() << name(GetParam()) << " is not available on this machine";
  }
  /// By the list, or by a structure where the list would take too long; the conformance tests hold the two to be the same.
  [[nodiscard]] static HitBatch trace(const Scene& scene, const RayBatch& rays, std::string_view technique = "list") {
    const TechniqueSpec spec = parse_technique(technique);
    HitBatch hits;
    trace_closest(*spec.structure->build(scene, spec.params, 1)->intersector({GetParam(), simd_width(GetParam()), spec.params}), rays, hits, 1);
    return hits;
  }
  struct Hit {
    float t;
    std::int32_t prim;
    float u, v;
  };
  [[nodiscard]] static Hit trace(const Scene& scene, const Ray& ray) {
    RayBatch rays;
    rays.push_back(ray);
    const HitBatch hits = trace(scene, rays);
    return {hits.t[0], hits.prim[0], hits.u[0], hits.v[0]};
  }
};

}  // namespace raymeter::test
