#include "experiments/record/break_even.h"

#include <gtest/gtest.h>

namespace raymeter {
namespace {

TEST(BreakEven, IsWhereBothHaveCostAsMuch) {
  EXPECT_EQ(break_even({3, 10}, {1, 30}), "100000");   // 2 ms dearer, 20 ns a ray saved
  EXPECT_EQ(break_even({1.00001, 10}, {1, 13}), "4");  // 10 ns dearer, 3 ns saved: a whole number of rays
}

TEST(BreakEven, IsAlwaysWhereNothingIsToBeMadeGood) {
  EXPECT_EQ(break_even({1, 10}, {1, 30}), "always");
  EXPECT_EQ(break_even({0.5, 10}, {1, 30}), "always");
  EXPECT_EQ(break_even({0.5, 30}, {1, 30}), "always");
}

TEST(BreakEven, IsNeverWhereItIsNotMadeGood) {
  EXPECT_EQ(break_even({2, 30}, {1, 30}), "never");
  EXPECT_EQ(break_even({2, 31}, {1, 30}), "never");
  EXPECT_EQ(break_even({0.5, 31}, {1, 30}), "never");  // cheaper at first only
  EXPECT_EQ(break_even({1, 30}, {1, 30}), "never");
}

}  // namespace
}  // namespace raymeter
