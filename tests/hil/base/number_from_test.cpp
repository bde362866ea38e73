// SPDX-License-Identifier: Apache-2.0
#include "hil/base/number_from.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>

namespace kerfbench::base {
namespace {

TEST(NumberFrom, TakesAWholeTextAndNothingElse) {
  EXPECT_EQ(numberFrom<int>("-17"), -17);
  EXPECT_EQ(numberFrom<double>("2.5e-3"), 2.5e-3);
  for (const char* text : {"", " ", "-", "+1", " 1", "1 ", "1x", "0x10", "1.5", "one"})
    EXPECT_EQ(numberFrom<int>(text), std::nullopt) << text;
  // The text ends in the middle of a longer one.
  EXPECT_EQ(numberFrom<int>(std::string_view("123").substr(0, 2)), 12);
}

TEST(NumberFrom, TakesWhatTheTypeHolds) {
  constexpr auto kMost = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(numberFrom<std::uint64_t>(std::to_string(kMost)), kMost);
  EXPECT_EQ(numberFrom<std::uint64_t>("18446744073709551616"), std::nullopt);
  EXPECT_EQ(numberFrom<std::uint64_t>("-1"), std::nullopt);
  EXPECT_EQ(numberFrom<std::uint8_t>("256"), std::nullopt);
  EXPECT_EQ(numberFrom<double>("1e999"), std::nullopt);
}

}  // namespace
}  // namespace kerfbench::base
