#include "experiments/scenes/generators.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace raymeter {
namespace {

std::string error_of(std::string_view spec) {
  try {
    (void)generate_scene(spec);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Generators, NamesTheSceneAfterItsSpec) {
  EXPECT_EQ(generate_scene("spd:balls:1").name, "spd:balls:1");
  EXPECT_EQ(generate_scene("spd:balls").prim_count(), generate_scene("spd:balls:4").prim_count());
}

TEST(Generators, RefusesWhatItCannotMake) {
  EXPECT_EQ(error_of("spd:bals"), "spd:bals: unknown generator 'spd:bals'; did you mean spd:balls?");
  EXPECT_EQ(error_of("spd:bals:4"), "spd:bals:4: unknown generator 'spd:bals'; did you mean spd:balls?");
  const std::string range = "expected a size (recursion depth) from 0 to 8, got ";
  EXPECT_EQ(error_of("spd:balls:9"), "spd:balls:9: " + range + "'9'");
  for (const std::string text : {"", "-1", "four", "4x", "4:4", " 4", "4.0", "99999999999"})
    EXPECT_EQ(error_of("spd:balls:" + text), "spd:balls:" + text + ": " + range + "'" + text + "'");
}

}  // namespace
}  // namespace raymeter
