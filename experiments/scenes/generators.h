#pragma once

#include <span>
#include <string_view>

#include "core/scene/scene.h"

namespace raymeter {

/// A row of the table of scene generators: all that `list scenes`, the parser and the tests know of one.
struct SceneGenerator {
  std::string_view spec_prefix;  ///< what comes before the size: "spd:balls"
  std::string_view summary;      ///< what the scene is and what it stresses
  std::string_view size_means;   ///< after "the size is the": "recursion depth"
  int default_size;
  int min_size;
  int max_size;             ///< up to 50 million primitives
  Scene (*make)(int size);  ///< sets everything but Scene::name; the same bits for the same size
};

/// All generators, in the order of listings.
[[nodiscard]] std::span<const SceneGenerator> scene_generators() noexcept;

/// Makes the scene of `spec`, which is a generator's prefix and perhaps ":SIZE", as in "spd:balls" or "gen:terrain:1000000", and names it so.
/// Throws Error for an unknown generator or a size that is no whole number in its range.
[[nodiscard]] Scene generate_scene(std::string_view spec);

/// Throws the same errors without making the scene.
void check_generator_spec(std::string_view spec);

}  // namespace raymeter
