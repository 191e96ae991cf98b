// The ray counts of the Standard Procedural Databases. Two independent programs agree on them to 0.13 %: Haines' (Readme of SPD 3.14) and the
// double-precision tracer from which these numbers come. 0.2 % or 30 rays leaves room for rays within rounding of an outline and for nothing else.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>

#include "accel/registry.h"
#include "core/render/whitted.h"
#include "experiments/scenes/scene_source.h"

namespace raymeter {
namespace {

struct Case {
  CameraConvention convention;
  const char* scene;
  std::int64_t primary_hit, reflection, refraction, tir, shadow, shadow_blocked;
};

void expect_close(const char* what, std::int64_t count, std::int64_t expected) {
  const double tolerance = std::max(30.0, 0.002 * static_cast<double>(expected));
  EXPECT_LE(static_cast<double>(std::abs(count - expected)), tolerance) << what << ": " << count << ", expected " << expected;
}

void expect_counts(const Case& expected, const Scene& scene, const Structure& structure, const QueryOptions& options) {
  SCOPED_TRACE(name(options.isa));
  const auto intersector = structure.intersector(options);
  CastFirstHit cast(*intersector);
  const RayCounts counts = render(scene, cast, *intersector, {{scene.camera, expected.convention, 513, 513}, {}, 0, false}).rays;
  expect_close("primary", counts.primary, 263169);
  expect_close("primary_hit", counts.primary_hit, expected.primary_hit);
  if (expected.convention == CameraConvention::spd) {
    expect_close("reflection", counts.reflection, expected.reflection);
    expect_close("refraction", counts.refraction, expected.refraction);
  } else {
    expect_close("reflection and refraction", counts.reflection + counts.refraction, expected.reflection);
  }
  expect_close("tir", counts.tir, expected.tir);
  expect_close("shadow", counts.shadow, expected.shadow);
  expect_close("shadow_blocked", counts.shadow_blocked, expected.shadow_blocked);
}

std::string scene_name(const testing::TestParamInfo<Case>& info) {
  const std::string_view spec = info.param.scene;
  return std::string(spec.substr(4, spec.rfind(':') - 4));
}

class RayCountsTest : public testing::TestWithParam<Case> {
protected:
  void SetUp() override {
#ifndef __OPTIMIZE__
    GTEST_SKIP() << "millions of rays: optimised builds only";
#endif
  }
};

/// With `bvh` on all instruction sets; other structures, which equal it bit for bit on each (conformance tests), on the machine's best.
TEST_P(RayCountsTest, AreTheSameWithEveryStructureAndOnEveryInstructionSet) {
  const Scene scene = load_scene(GetParam().scene);
  for (const StructureEntry& entry : structures()) {
    if (entry.name == "list") continue;  // 10^10 tests
    SCOPED_TRACE(entry.name);
    const ParamValues params = entry.resolve({});
    const auto structure = entry.build(scene, params, 0);
    for (const Isa isa : kIsas) {
      if (!available(isa))
        std::cout << name(isa) << ": skipped, this machine lacks it\n";
      else if (entry.name == "bvh" || isa == best_isa())
        expect_counts(GetParam(), scene, *structure, {isa, 16, params});
    }
  }
}

/// A structure, built once for all that stands before it.
struct Built {
  const Scene& scene;
  const StructureEntry& entry;
  ParamValues params = entry.resolve({});
  std::unique_ptr<Structure> structure = entry.build(scene, params, 0);

  /// The counts of a frame that the structure renders with slots such as "+zbuffer:mode=list+shadow_cache".
  [[nodiscard]] RayCounts counts(const std::string& slots, int size, bool general = false) const {
    const TechniqueSpec spec = parse_technique(std::string(entry.name) + slots);
    const auto intersector = structure->intersector({best_isa(), 16, params});
    const auto first_hit = spec.first_hit.entry->make(scene, {best_isa(), 16, 0, spec.first_hit.params}, *intersector);
    const auto occlusion = spec.occlusion.entry->make(scene, {best_isa(), 16, 0, spec.occlusion.params}, *intersector);
    RenderOptions options{{scene.camera, CameraConvention::spd, size, size}, {}};
    options.occlusion = occlusion.get();
    options.general = general;
    return render(scene, *first_hit, *intersector, options).rays;
  }
};

/// Two combinations that have nothing in common; on frames of the published size they are exactly as casting, which has the published counts.
TEST_P(RayCountsTest, AreTheSameWithOtherSlots) {
  const Scene scene = load_scene(GetParam().scene);
  const Built bvh{scene, structure_entry("bvh")};
  const RayCounts expected = bvh.counts("", 513);
  EXPECT_EQ(bvh.counts("+zbuffer:mode=list+shadow_cache", 513, true), expected);
  EXPECT_EQ((Built{scene, structure_entry("kdtree")}.counts("+zbuffer:mode=seed+shadow_cache:update=serial", 513)), expected);
}

/// All of them, on small scenes and frames.
TEST(RayCountsOfSlots, AreTheSameWithEveryCombinationOfExactTechniques) {
  for (const char* spec : {"spd:balls:2", "spd:gears:1", "spd:jacks:1", "spd:lattice:2", "spd:mount:3", "spd:rings:2", "spd:shells:2", "spd:teapot:3",
                           "spd:tetra:3", "spd:tree:4"}) {
    SCOPED_TRACE(spec);
    const Scene scene = load_scene(spec);
    const RayCounts expected = Built{scene, structure_entry("list")}.counts("", 40);
    for (const StructureEntry& entry : structures()) {
      const Built built{scene, entry};
      for (const char* first_hit : {"", "+zbuffer:mode=list", "+zbuffer:mode=seed"}) {
        for (const char* occlusion : {"", "+shadow_cache", "+shadow_cache:key=light", "+shadow_cache:key=light_tree", "+shadow_cache:update=serial"}) {
          for (const bool general : {false, true}) {
            const std::string slots = std::string(first_hit) + occlusion;
            EXPECT_EQ(built.counts(slots, 40, general), expected) << entry.name << slots << (general ? ", general" : "");
          }
        }
      }
    }
  }
}

constexpr CameraConvention kSpd = CameraConvention::spd;
INSTANTIATE_TEST_SUITE_P(Spd, RayCountsTest,
                         testing::Values(Case{kSpd, "spd:balls:4", 263169, 175057, 0, 0, 954111, 285962},
                                         Case{kSpd, "spd:gears:4", 245090, 304621, 199931, 7604, 2246782, 1219952},
                                         Case{kSpd, "spd:mount:6", 173132, 354770, 354770, 0, 412836, 253263},
                                         Case{kSpd, "spd:rings:7", 263169, 314990, 0, 0, 1084444, 515261},
                                         Case{kSpd, "spd:teapot:12", 161124, 225519, 0, 0, 408001, 40426},
                                         Case{kSpd, "spd:tetra:6", 49797, 0, 0, 0, 46109, 5523}, Case{kSpd, "spd:tree:11", 169830, 0, 0, 0, 1097445, 43456}),
                         scene_name);

/// The rules of the tables of Havran and Sixta 1999; `reflection` is reflection and refraction together.
class HavranRayCountsTest : public RayCountsTest {};

TEST_P(HavranRayCountsTest, FollowTheRulesOfTheirTables) {
  const Scene scene = load_scene(GetParam().scene);
  const StructureEntry& bvh = structure_entry("bvh");
  expect_counts(GetParam(), scene, *bvh.build(scene, bvh.resolve({}), 0), {best_isa(), 16, bvh.resolve({})});
}

constexpr CameraConvention kHavran = CameraConvention::havran;
INSTANTIATE_TEST_SUITE_P(
    Havran, HavranRayCountsTest,
    testing::Values(Case{kHavran, "spd:balls:4", 263169, 179778, 0, 0, 959080, 285120}, Case{kHavran, "spd:gears:4", 245332, 488228, 0, 6100, 2087995, 818138},
                    Case{kHavran, "spd:lattice:12", 261170, 238288, 0, 0, 1174278, 937803},
                    Case{kHavran, "spd:mount:6", 173686, 707764, 0, 2672, 361049, 73764}, Case{kHavran, "spd:rings:7", 263169, 316139, 0, 0, 1083153, 514216},
                    Case{kHavran, "spd:teapot:12", 161546, 226089, 0, 0, 406274, 34744}, Case{kHavran, "spd:tetra:6", 49950, 0, 0, 0, 46261, 5551},
                    Case{kHavran, "spd:tree:11", 169909, 0, 0, 0, 1097835, 43106}),
    scene_name);

}  // namespace
}  // namespace raymeter
