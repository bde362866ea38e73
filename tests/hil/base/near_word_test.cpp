// SPDX-License-Identifier: Apache-2.0
#include "hil/base/near_word.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace kerfbench::base {
namespace {

const std::vector<std::string> kWords{"run", "replay", "record-frames", "lint", "show", "speed_mm_s"};

TEST(NearWord, IsFoundByOneLetterThatIsMissingTooManyWrongOrExchanged) {
  EXPECT_EQ(nearWord("ru", kWords), "run");
  EXPECT_EQ(nearWord("runn", kWords), "run");
  EXPECT_EQ(nearWord("lind", kWords), "lint");
  EXPECT_EQ(nearWord("rnu", kWords), "run");
}

TEST(NearWord, OfALongWordMayDifferByAThird) {
  EXPECT_EQ(nearWord("speed_mms", kWords), "speed_mm_s");
  EXPECT_EQ(nearWord("recrod-frame", kWords), "record-frames");
}

TEST(NearWord, IsNoneWhereNothingIsNear) {
  EXPECT_EQ(nearWord("cut", kWords), "");
  EXPECT_EQ(nearWord("", kWords), "");
  EXPECT_EQ(nearWord("run", {}), "");
  EXPECT_EQ(nearWord(std::string(100'000, 'r'), kWords), "");
}

TEST(NearWord, CaresForNoCapitals) { EXPECT_EQ(nearWord("LINT", kWords), "lint"); }

TEST(NearWord, OfEquallyNearOnesIsTheFirst) { EXPECT_EQ(nearWord("bat", {"cat", "rat"}), "cat"); }

TEST(DidYouMean, IsTheEndOfAMessageOrNothing) {
  EXPECT_EQ(didYouMean("shwo", kWords), " Did you mean show?");
  EXPECT_EQ(didYouMean("paint", kWords), "");
}

}  // namespace
}  // namespace kerfbench::base
