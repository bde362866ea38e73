// SPDX-License-Identifier: Apache-2.0
#include "hil/base/time_left.h"

#include <chrono>
#include <optional>

#include <gtest/gtest.h>

namespace kerfbench::base {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr TimeLeft::Time kBegin{};

TEST(TimeLeft, GoesByTheTimeThatTheWorkTookSoFar) {
  TimeLeft left;
  EXPECT_EQ(left.after("reading", 0.0, kBegin), std::nullopt);
  EXPECT_EQ(left.after("reading", 0.25, kBegin + seconds(10)), 30);
  EXPECT_EQ(left.after("reading", 0.5, kBegin + seconds(12)), 12);
}

TEST(TimeLeft, IsNotToldBeforeThereIsSomethingToGoByNorAtTheEnd) {
  TimeLeft left;
  EXPECT_EQ(left.after("reading", 0.0, kBegin), std::nullopt);
  EXPECT_EQ(left.after("reading", 0.5, kBegin + milliseconds(900)), std::nullopt);
  EXPECT_EQ(left.after("reading", 0.005, kBegin + seconds(5)), std::nullopt);
  EXPECT_EQ(left.after("reading", 1.0, kBegin + seconds(9)), std::nullopt);
}

TEST(TimeLeft, OfAnotherWorkBeginsAnew) {
  TimeLeft left;
  left.after("reading", 0.0, kBegin);
  left.after("writing", 0.1, kBegin + seconds(100));
  EXPECT_EQ(left.after("writing", 0.55, kBegin + seconds(101)), 1);
  // The same work a second time.
  EXPECT_EQ(left.after("writing", 0.0, kBegin + seconds(200)), std::nullopt);
  EXPECT_EQ(left.after("writing", 0.5, kBegin + seconds(204)), 4);
}

TEST(ShareIn, IsThePerCentThatTheWordsTell) {
  EXPECT_EQ(shareIn("reading pins.vcd, 42 %"), 0.42);
  EXPECT_EQ(shareIn("running, 7 % of the program sent"), 0.07);
  EXPECT_EQ(shareIn("done, 100 %"), 1.0);
  EXPECT_EQ(shareIn("looking at the spot"), std::nullopt);
  EXPECT_EQ(shareIn(" %"), std::nullopt);
  EXPECT_EQ(shareIn("99999999999999999999 %"), std::nullopt);
  EXPECT_EQ(shareIn(""), std::nullopt);
}

}  // namespace
}  // namespace kerfbench::base
