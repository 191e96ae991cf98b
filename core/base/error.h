#pragma once

#include <stdexcept>
#include <string>

namespace raymeter {

/// A user's mistake (config, scene file, parameter): says where, what, and what was expected. Exit code 2.
struct Error : std::runtime_error {
  explicit Error(const std::string& message) : std::runtime_error(message) {}
};

}  // namespace raymeter
