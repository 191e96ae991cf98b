// Micro-benchmarks of the tests of primitives and bounding volumes: nanoseconds per test of a ray, for each instruction set, with coherent and with mixed rays.
//
// All targets cover about half of a square window around the origin, through which every ray passes. Coherent rays come from one eye, share their octant and
// lie in tiles of 4 x 4, so that most packets meet a target as a whole or not at all; mixed rays come from everywhere, in no order.

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/bounds/aabb_volume.h"
#include "core/bounds/kdop_volume.h"
#include "core/bounds/obb_volume.h"
#include "core/bounds/sphere_volume.h"
#include "core/ray/ray_batch.h"
#include "core/scene/scene.h"
#include "core/simd/isa.h"
#include "experiments/micro/micro_kernel.h"

namespace raymeter {

namespace {

using MicroFunction = MicroSums (*)(const MicroTargets&, const RayView&) noexcept;

struct MicroFunctions {
  MicroFunction spheres;
  MicroFunction triangles;
  MicroFunction polygons;
  MicroFunction cones;
  MicroFunction bounding_boxes;
  MicroFunction bounding_spheres;
  MicroFunction oriented_boxes;
  MicroFunction bounding_slabs;
};

template <Isa I>
constexpr MicroFunctions functions_of() {
  return {MicroKernel<I>::spheres,        MicroKernel<I>::triangles,        MicroKernel<I>::polygons,       MicroKernel<I>::cones,
          MicroKernel<I>::bounding_boxes, MicroKernel<I>::bounding_spheres, MicroKernel<I>::oriented_boxes, MicroKernel<I>::bounding_slabs};
}
constexpr std::array kFunctions{functions_of<Isa::scalar>(), functions_of<Isa::sse42>(), functions_of<Isa::avx2>(), functions_of<Isa::avx512>()};

constexpr int kTargetCount = 16;
constexpr int kWindowSamples = 32;  ///< along each side; 1024 rays stay in the first-level cache
constexpr std::uint64_t kSeed = 1;

/// An outline of half the window's area in the plane z = 0 (the window reaches from -1 to 1); every second vertex lies further in by the factor `inner`.
std::vector<glm::dvec3> outline(int corners, const glm::dvec2& center, double inner) {
  const double sector = 2 * std::numbers::pi / corners;
  const double outer = std::sqrt(4 / (corners * inner * std::sin(sector)));
  std::vector<glm::dvec3> vertices;
  for (int k = 0; k < corners; ++k) {
    const double radius = k % 2 == 0 ? outer : inner * outer;
    vertices.emplace_back(center.x + radius * std::cos(k * sector), center.y + radius * std::sin(k * sector), 0);
  }
  return vertices;
}

/// Targets of one kind, each moved a little.
struct Targets {
  Scene scene;
  std::vector<float> volumes;
  KdopLayout::Shared slabs{};

  template <class Add>
  explicit Targets(Add add) {
    std::mt19937_64 random(kSeed);
    std::uniform_real_distribution<double> shift(-0.1, 0.1);
    for (int i = 0; i < kTargetCount; ++i) {
      const double x = shift(random);
      add(*this, glm::dvec2(x, shift(random)));
    }
    scene.finish();
  }
};

void add_sphere(Targets& targets, const glm::dvec2& at) { targets.scene.add_sphere({at.x, at.y, 0}, 0.7); }

void add_triangle(Targets& targets, const glm::dvec2& at) { targets.scene.add_triangle({at.x - 1, at.y - 1, 0}, {at.x + 1, at.y - 1, 0}, {at.x, at.y + 1, 0}); }

void add_quad(Targets& targets, const glm::dvec2& at) { targets.scene.add_polygon(outline(4, at, 1)); }

void add_polygon(Targets& targets, const glm::dvec2& at) { targets.scene.add_polygon(outline(144, at, 0.75)); }

void add_cone(Targets& targets, const glm::dvec2& at) { targets.scene.add_cone({at.x, at.y - 0.6, 0}, 0.75, {at.x, at.y + 0.6, 0}, 0.4); }

/// A volume of the kind about each target, a slender cone that is tilted.
template <class V>
void add_volumes(Targets& targets, const V& volume) {
  for (std::int32_t id = 0; id < targets.scene.prim_id_count(); ++id) {
    const std::size_t first = targets.volumes.size();
    targets.volumes.resize(first + static_cast<std::size_t>(volume.floats()));
    volume.write(volume.fit(targets.scene, targets.scene.prim(id)), targets.volumes.data() + first);
  }
}

void add_tilted(Targets& targets, const glm::dvec2& at) { targets.scene.add_cone({at.x - 0.5, at.y - 0.4, -0.3}, 0.3, {at.x + 0.5, at.y + 0.4, 0.3}, 0.2); }

template <class V>
Targets bounded(const V& volume) {
  Targets targets(add_tilted);
  add_volumes(targets, volume);
  return targets;
}

/// Their directions lie about the scene's middle.
Targets bounded_by_slabs(int k) {
  Targets targets(add_tilted);
  const KdopVolume volume(targets.scene, k);
  targets.slabs = volume.shared({});
  add_volumes(targets, volume);
  return targets;
}

Ray ray_through(const glm::dvec3& org, double x, double y) {
  const auto single = [](double value) { return static_cast<float>(value); };
  return {{single(org.x), single(org.y), single(org.z)}, 0, {single(x - org.x), single(y - org.y), single(-org.z)}, 1e6f};
}

RayBatch coherent_rays() {
  constexpr int kTile = 4;
  RayBatch rays;
  for (int i = 0; i < kWindowSamples * kWindowSamples; ++i) {
    const int tile = i / (kTile * kTile), in_tile = i % (kTile * kTile);
    const int column = tile % (kWindowSamples / kTile) * kTile + in_tile % kTile;
    const int row = tile / (kWindowSamples / kTile) * kTile + in_tile / kTile;
    rays.push_back(ray_through({-3, -4, -10}, (2 * column + 1.0) / kWindowSamples - 1, (2 * row + 1.0) / kWindowSamples - 1));
  }
  return rays;
}

RayBatch mixed_rays() {
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> across(-1, 1);
  RayBatch rays;
  while (rays.size() < static_cast<std::size_t>(kWindowSamples) * kWindowSamples) {
    const double azimuth = std::numbers::pi * across(random), height = across(random), x = across(random), y = across(random);
    const double reach = std::sqrt(1 - height * height);
    rays.push_back(ray_through(10.0 * glm::dvec3(reach * std::cos(azimuth), reach * std::sin(azimuth), height), x, y));
  }
  return rays;
}

void measure(benchmark::State& state, Isa isa, MicroFunction MicroFunctions::*test, const Targets& targets, const RayBatch& rays) {
  if (!available(isa)) {
    state.SkipWithError(("this CPU has no " + std::string(name(isa))).c_str());
    return;
  }
  const MicroFunction function = kFunctions[static_cast<std::size_t>(isa)].*test;
  const MicroTargets view{targets.scene.pools().view(), targets.volumes.data(), static_cast<std::int32_t>(targets.volumes.size()) / kTargetCount, targets.slabs,
                          kTargetCount};
  const RayView ray_view = rays.view();
  MicroSums sums{};
  for (auto _ : state) {
    sums = function(view, ray_view);
    benchmark::DoNotOptimize(sums);
  }
  const double tests = static_cast<double>(rays.size()) * kTargetCount;
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(tests));
  state.counters["hit_rate"] = static_cast<double>(sums.hits) / tests;
  state.counters["per_test"] = benchmark::Counter(tests, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

}  // namespace

}  // namespace raymeter

int main(int argc, char** argv) {
  using namespace raymeter;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;

  struct Kind {
    const char* name;
    MicroFunction MicroFunctions::*test;
    Targets targets;
  };
  const std::array kinds{
      Kind{"sphere", &MicroFunctions::spheres, Targets(add_sphere)},
      Kind{"triangle", &MicroFunctions::triangles, Targets(add_triangle)},
      Kind{"quad", &MicroFunctions::polygons, Targets(add_quad)},
      Kind{"polygon144", &MicroFunctions::polygons, Targets(add_polygon)},
      Kind{"cone", &MicroFunctions::cones, Targets(add_cone)},
      Kind{"aabb", &MicroFunctions::bounding_boxes, bounded(AabbVolume())},
      Kind{"bounding_sphere", &MicroFunctions::bounding_spheres, bounded(SphereVolume())},
      Kind{"obb", &MicroFunctions::oriented_boxes, bounded(ObbVolume())},
      Kind{"kdop6", &MicroFunctions::bounding_slabs, bounded_by_slabs(6)},
      Kind{"kdop14", &MicroFunctions::bounding_slabs, bounded_by_slabs(14)},
      Kind{"kdop26", &MicroFunctions::bounding_slabs, bounded_by_slabs(26)},
  };
  const RayBatch coherent = coherent_rays(), mixed = mixed_rays();
  for (const Kind& kind : kinds) {
    for (const auto& [order, rays] : {std::pair("coherent", &coherent), std::pair("mixed", &mixed)}) {
      for (const Isa isa : kIsas) {
        const std::string title = std::string(kind.name) + "/" + order + "/" + std::string(name(isa));
        benchmark::RegisterBenchmark(title.c_str(), measure, isa, kind.test, std::cref(kind.targets), std::cref(*rays));
      }
    }
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
