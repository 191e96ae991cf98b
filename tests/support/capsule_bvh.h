#pragma once

#include "accel/technique.h"

namespace raymeter::test {

/// A hierarchy of capsules: what a user adds for a fifth kind of volume, outside of accel/bvh. Its parameters are those of bvh; `builder` and `traversal` vary.
[[nodiscard]] const StructureEntry& capsule_bvh_entry();

}  // namespace raymeter::test
