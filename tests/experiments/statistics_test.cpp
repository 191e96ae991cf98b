#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "experiments/record/statistics.h"

namespace raymeter {
namespace {

std::vector<double> one_to(std::size_t n) {
  std::vector<double> values(n);
  std::iota(values.rbegin(), values.rend(), 1.0);
  return values;
}

TEST(Statistics, MedianIsTheMiddle) {
  EXPECT_EQ(median({3}), 3);
  EXPECT_EQ(median({5, 1, 3}), 3);
  EXPECT_EQ(median({4, 1, 3, 2}), 2.5);
}

// Ranks from the table of the sign test's confidence limits for a median (95 %): n = 6: 1 and 6; 9: 2 and 8; 15: 4 and 12; 20: 6 and 15; 50: 18 and 33.
TEST(Statistics, IntervalTakesTheRanksOfTheSignTest) {
  for (const std::size_t n : {0u, 1u, 5u}) EXPECT_FALSE(median_interval(one_to(n))) << n;
  const std::pair<std::size_t, Interval> known[]{{6, {1, 6}}, {9, {2, 8}}, {15, {4, 12}}, {20, {6, 15}}, {50, {18, 33}}};
  for (const auto& [n, expected] : known) {
    const auto interval = median_interval(one_to(n));
    ASSERT_TRUE(interval) << n;
    EXPECT_EQ(interval->lo, expected.lo) << n;
    EXPECT_EQ(interval->hi, expected.hi) << n;
  }
}

TEST(Statistics, DeviationAndGeometricMean) {
  EXPECT_EQ(median_deviation(std::vector<double>{1, 1, 2, 2, 4, 6, 9}), 1);
  EXPECT_DOUBLE_EQ(geometric_mean(std::vector<double>{1, 4, 16}), 4);
}

}  // namespace
}  // namespace raymeter
