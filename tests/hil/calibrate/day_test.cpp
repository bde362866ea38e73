// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/files/day.h"

#include <gtest/gtest.h>

namespace kerfbench::calibrate {
namespace {

TEST(DayNumber, CountsDaysOverLeapYears) {
  EXPECT_EQ(dayNumber("1970-01-01"), 0);
  EXPECT_EQ(*dayNumber("2028-03-01") - *dayNumber("2028-02-28"), 2);
  EXPECT_EQ(*dayNumber("2027-03-01") - *dayNumber("2027-02-28"), 1);
  EXPECT_EQ(*dayNumber("2101-01-01") - *dayNumber("2100-01-01"), 365);
}

TEST(DayNumber, TakesNothingButADay) {
  for (const char* text : {"", "2026-11", "2026-11-31", "2026-13-01", "2026/11/20", "20261120",
                           "2026-11-20T10:00", "today", "-026-11-20", "2026-1-020"})
    EXPECT_FALSE(dayNumber(text)) << text;
}

}  // namespace
}  // namespace kerfbench::calibrate
