// SPDX-License-Identifier: Apache-2.0
#include "hil/source/vcd_digits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "hil/source/vcd_scale.h"

namespace kerfbench::source {
namespace {

TEST(VcdDigits, AreReadUpToWhatIsNone) {
  for (const char other : {'\n', '/', ':', ' ', '\0', '\x80', '\xB5', '\xFF', 'a'}) {
    for (std::size_t count = 0; count <= Digits::kMost; ++count) {
      const std::string number = std::string("9081726354908172635").substr(0, count);
      // What stands behind is another number.
      const Digits read = digitsAt((number + other + std::string(Digits::kRead, '7')).c_str());
      EXPECT_EQ(read.count, count) << number;
      EXPECT_EQ(read.value, count == 0 ? 0 : std::stoull(number)) << number;
    }
  }
  EXPECT_EQ(digitsAt(std::string(30, '1').c_str()).count, Digits::kRead);
}

// A stamp is on a tick if, and only if, the ticks before it take as long as it says.
TEST(VcdDigits, AStampOnATickIsToldFromItsNeighbours) {
  for (const TickRate rate : {TickRate{1, 16'000'000}, TickRate{1, 1'000'000}, TickRate{1, 1'000'000'000},
                              TickRate{3, 1000}, TickRate{1, 14'745'600}}) {
    const VcdScale scale = VcdScale::forRate(rate);
    for (Tick tick = 1; tick < Tick{1} << 46U; tick += tick / 3 + 1) {
      const std::uint64_t stamp = scale.stampOf(tick);
      Tick found = 0;
      EXPECT_TRUE(scale.tickOf(stamp, found));
      EXPECT_EQ(found, tick);
      const bool every_stamp = scale.stampOf(tick + 1) == stamp + 1;
      EXPECT_EQ(scale.tickOf(stamp + 1, found), every_stamp) << tick;
      EXPECT_EQ(scale.tickOf(stamp - 1, found), every_stamp) << tick;
    }
  }
}

}  // namespace
}  // namespace kerfbench::source
