#pragma once

#include <string_view>

#include "core/scene/scene.h"

namespace raymeter {

/// The scene that `spec` names: a generator ("spd:balls", "spd:balls:4", "gen:terrain:100000"), a hard case ("hard:lattice") or a file ("hall.obj",
/// "tree.nff.xz"). Its name is `spec`, its memory is trimmed. Throws Error for what does not exist or is damaged.
[[nodiscard]] Scene load_scene(std::string_view spec);

/// Whether `spec` names a generator, not a file.
[[nodiscard]] bool is_generated_scene(std::string_view spec) noexcept;

/// Throws Error for what load_scene cannot begin with: an unknown generator, a size out of range, an unknown kind of file or one that cannot be opened.
void check_scene(std::string_view spec);

}  // namespace raymeter
