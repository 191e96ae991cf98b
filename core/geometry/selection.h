#pragma once

#include <cstdint>

namespace raymeter {

/// Which lanes are tested against one primitive of a run: those that the run is for, or of them the wanted ones alone; or the former still, where asking would
/// cost a timed kernel more than it saves: only counting asks then, since a ray needs no more tests for being tested along with others.
enum class Selection : std::uint8_t { none, counted, tested };

}  // namespace raymeter
