#pragma once

#include <gtest/gtest.h>

#include <string>

#include "core/base/error.h"

namespace raymeter {

/// Expects that `action` throws an Error with exactly this message.
template <class Action>
void expect_error_message(const Action& action, const std::string& message) {
  try {
    action();
    ADD_FAILURE() << "no Error; expected: " << message;
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), message);
  }
}

}  // namespace raymeter
