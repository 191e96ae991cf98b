// The z-buffer as the last word: how wrong it is.

#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "experiments/scenes/scene_source.h"
#include "tests/support/first_hits.h"

namespace raymeter {
namespace {

using test::pixels_of;
using test::Slots;

/// Shares of the image's rays.
struct Errors {
  double wrong = 0;  ///< another primitive than casting finds
  double holes = 0;  ///< none where casting finds one
  double extra = 0;  ///< one where casting finds none
};

Errors errors_of(const Scene& scene, const CameraModel& model, double resolution) {
  const Column<std::int32_t> pixels = pixels_of(model);
  const HitBatch cast = Slots(scene, "bvh", best_isa(), 16).find(model, pixels);
  const HitBatch drawn = Slots(scene, "bvh+zbuffer:mode=final,resolution=" + std::to_string(resolution), best_isa(), 16).find(model, pixels);
  Errors errors;
  const double share = 1.0 / static_cast<double>(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (drawn.prim[i] == cast.prim[i]) continue;
    (drawn.prim[i] < 0 ? errors.holes : cast.prim[i] < 0 ? errors.extra : errors.wrong) += share;
  }
  return errors;
}

std::ostream& operator<<(std::ostream& out, const Errors& e) { return out << "wrong " << e.wrong << ", holes " << e.holes << ", extra " << e.extra; }

TEST(ZbufferFinal, AtTheImagesOwnSamplesThereAreNoHolesAndAlmostNoOtherErrors) {
  for (const char* text : {"spd:tetra:3", "spd:gears:1", "spd:mount:3", "spd:balls:2", "spd:teapot:4", "gen:hairball:20"}) {
    const Scene scene = load_scene(text);
    const Errors errors = errors_of(scene, {scene.camera, CameraConvention::pixel, 200, 200}, 1);
    EXPECT_EQ(errors.holes, 0) << text << ": " << errors;
    EXPECT_LT(errors.wrong + errors.extra, 0.003) << text << ": " << errors;
  }
}

TEST(ZbufferFinal, ErrorsGrowWithTheDistanceOfItsSamplesFromTheImages) {
  const Scene scene = load_scene("spd:gears:1");
  const auto sum = [&](double resolution) {
    const Errors errors = errors_of(scene, {scene.camera, CameraConvention::pixel, 200, 200}, resolution);
    return errors.wrong + errors.holes + errors.extra;
  };
  const double same = sum(1), half = sum(0.5), twice = sum(2), four = sum(4);
  EXPECT_LT(same, four);
  EXPECT_LT(four, twice);
  EXPECT_LT(twice, half);
  EXPECT_LT(half, 0.2);
}

TEST(ZbufferFinal, HidesWhatLiesAMillionthBehindNowAndThen) {
  const CameraModel model = test::slanted_model(CameraConvention::pixel);
  const Errors errors = errors_of(test::subsample_scene(model), model, 1);
  EXPECT_EQ(errors.holes, 0) << errors;
  EXPECT_GT(errors.wrong + errors.extra, 0) << "nothing is hard here any more";
}

}  // namespace
}  // namespace raymeter
