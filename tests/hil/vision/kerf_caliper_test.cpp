// SPDX-License-Identifier: Apache-2.0
// The kerf in a profile, on profiles made by hand.
#include "hil/vision/kerf/kerf_caliper.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace kerfbench::vision {
namespace {

constexpr double kStep_mm = 0.01;
constexpr double kPixel_mm = 0.03;
constexpr int kHalfSamples = 60;
constexpr double kBoard = 40.0;
constexpr double kOpen = 200.0;
constexpr double kHalf_mm = 0.1;  ///< Half the width of the kerf.

/// A kerf of which `middle_mm` is the middle, blurred by a lens, on even board.
Profile kerfAt(double middle_mm) {
  Profile profile;
  profile.first_mm = -kHalfSamples * kStep_mm;
  profile.step_mm = kStep_mm;
  profile.pixel_mm = kPixel_mm;
  profile.noise_gray = 0.5;
  const auto share = [&](double at_mm) {
    const double blur_mm = 0.02 * std::numbers::sqrt2;
    return 0.5 * (std::erf((at_mm + kHalf_mm) / blur_mm) - std::erf((at_mm - kHalf_mm) / blur_mm));
  };
  for (int i = -kHalfSamples; i <= kHalfSamples; ++i) {
    profile.gray.push_back(static_cast<float>(kBoard + (kOpen - kBoard) * share(i * kStep_mm - middle_mm)));
    profile.weight.push_back(2.0F);
  }
  return profile;
}

TEST(KerfCaliper, ReadsAKerfAlikeOnEitherSideOfItsLine) {
  // Up to where a flank lies beyond the caliper's end.
  int found = 0;
  for (double middle_mm = 0.0; middle_mm < 0.55; middle_mm += 0.001) {
    const KerfReading left = measureKerf(kerfAt(middle_mm), kOpen);
    const KerfReading right = measureKerf(kerfAt(-middle_mm), kOpen);
    ASSERT_EQ(left.found, right.found) << middle_mm;
    if (!left.found) continue;
    ++found;
    EXPECT_NEAR(left.offset_mm, middle_mm, 0.001);
    EXPECT_NEAR(right.offset_mm, -left.offset_mm, 1e-5);
    EXPECT_NEAR(right.width_mm, left.width_mm, 1e-5);
  }
  EXPECT_GT(found, 400);
}

TEST(KerfCaliper, OddGrayIsTheLeftBoardLessTheRightOne) {
  Profile profile = kerfAt(0.0);
  for (int i = -kHalfSamples; i <= kHalfSamples; ++i) {
    if (std::abs(i) * kStep_mm > kHalf_mm + 0.05)
      profile.gray[static_cast<std::size_t>(i + kHalfSamples)] += i > 0 ? 3.0F : -3.0F;
  }
  EXPECT_NEAR(measureKerf(profile, kOpen).odd_gray, 6.0, 0.1);
}

TEST(KerfCaliper, WhatTheBoardDiffersByMovesAKerfAsItWouldOnTheFlanks) {
  Profile profile = kerfAt(0.0);
  for (int i = -kHalfSamples; i <= kHalfSamples; ++i) {
    if (std::abs(i) * kStep_mm > kBoardMm - 0.05)
      profile.gray[static_cast<std::size_t>(i + kHalfSamples)] += i > 0 ? 3.0F : -3.0F;
  }
  // A flank of that blur rises by 0.547 of its height over three samples about its middle.
  const double slope_per_mm = 0.547 * (kOpen - kBoard) / (3.0 * kStep_mm);
  EXPECT_NEAR(measureKerf(profile, kOpen).board_mm, 3.0 / slope_per_mm, 0.05 * 3.0 / slope_per_mm);
}

TEST(KerfCaliper, ANarrowKerfIsAsBrightAsThePixelsInItsMiddle) {
  // The spline has dimmed it to half of its light.
  Profile profile = kerfAt(0.0);
  for (float& gray : profile.gray) gray = static_cast<float>(0.5 * (gray + kBoard));
  for (const double across_mm : {-0.3, -0.2, -0.01, 0.0, 0.01, 0.2, 0.3}) {
    const double gray = std::abs(across_mm) < kHalf_mm ? kOpen : kBoard;
    profile.pixels.push_back({static_cast<float>(across_mm), 0.0F, static_cast<float>(gray), 1.0F});
  }
  EXPECT_NEAR(measureKerf(profile, kOpen).brightness, 1.0, 1e-6);
}

TEST(KerfCaliper, InGlareAKerfIsAsBrightAsAPictureWithoutAnyFlank) {
  // Light far beyond that of an open kerf, which counts up to a bound: the same whether the kerf's flanks are
  // seen or not.
  constexpr double kDim = 60.0;  // What the set-up takes for an open kerf.
  const KerfReading kerf = measureKerf(kerfAt(0.0), kDim);
  ASSERT_TRUE(kerf.found);
  Profile wide = kerfAt(0.0);
  for (std::size_t i = wide.size() / 3; i < wide.size(); ++i) wide.gray[i] = static_cast<float>(kOpen);
  for (const double across_mm : {-0.01, 0.0, 0.01})
    wide.pixels.push_back({static_cast<float>(across_mm), 0.0F, static_cast<float>(kOpen), 1.0F});
  const KerfReading flankless = measureKerf(wide, kDim);
  ASSERT_FALSE(flankless.found);
  EXPECT_GT(kerf.brightness, 1.0);
  EXPECT_EQ(kerf.brightness, flankless.brightness);
}

}  // namespace
}  // namespace kerfbench::vision
