#pragma once

#include <string>

#include "core/simd/isa.h"

namespace raymeter {

/// The instruction set of that name, or the best where it is empty; throws Error where there is none or the machine lacks it.
[[nodiscard]] Isa chosen_isa(const std::string& name);

/// A number of threads from 1, or "all" (0); throws Error.
[[nodiscard]] int chosen_threads(const std::string& text);

}  // namespace raymeter
