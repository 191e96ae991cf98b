#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace raymeter {

/// Which of `rays` rays to check, ascending: all, or so many without repetition (one at least) that rays x tests_per_ray keeps to `max_tests`. The seed alone
/// says which.
[[nodiscard]] std::vector<std::size_t> sampled(std::size_t rays, std::size_t tests_per_ray, double max_tests, std::uint64_t seed);

}  // namespace raymeter
