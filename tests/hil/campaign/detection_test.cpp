// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/detection.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kerfbench::campaign {
namespace {

using testing::HasSubstr;

struct Group {
  double size{};
  int trials{}, found{};
};

std::vector<Trial> trialsOf(const std::vector<Group>& groups) {
  std::vector<Trial> trials;
  for (const Group& g : groups)
    for (int i = 0; i < g.trials; ++i) trials.push_back({g.size, i < g.found});
  return trials;
}

/// Beetles killed by carbon disulphide over the logarithm of the dose (Bliss, Annals of Applied Biology 22
/// (1935) 134). Published logistic fit: slope 34.270, deviance 11.23 (Dobson, An Introduction to Generalized
/// Linear Models, table 7.4).
const std::vector<Group> kBeetles{{1.6907, 59, 6},  {1.7242, 60, 13}, {1.7552, 62, 18}, {1.7842, 56, 28},
                                  {1.8113, 63, 52}, {1.8369, 59, 53}, {1.8610, 62, 61}, {1.8839, 60, 60}};

/// O-rings of the space shuttle, as 100 F less the temperature (Dalal, Fowlkes, Hoadley, Journal of the
/// American Statistical Association 84 (1989) 945). Published logistic fit: slope 0.2322, half of them
/// at 64.79 F.
const std::vector<double> kFailed{53, 57, 58, 63, 70, 70, 75};
const std::vector<double> kHeld{66, 67, 67, 67, 68, 69, 70, 70, 72, 73, 75, 76, 76, 78, 79, 81};

TEST(Detection, FitsBeetlesAsPublished) {
  const Detection d = detectionOf(trialsOf(kBeetles));
  ASSERT_TRUE(d.fit);
  EXPECT_FALSE(d.logarithmic);
  EXPECT_EQ(d.trials, 481U);
  EXPECT_EQ(d.found, 291U);
  EXPECT_NEAR(d.fit->slope, 34.270, 5e-4);
  EXPECT_NEAR(d.fit->deviance, 11.2322, 5e-4);
  EXPECT_NEAR(d.fit->half.size, 1.7717, 5e-5);
  // The profile likelihood by a search of its own, golden sections over slope and place.
  EXPECT_NEAR(*d.fit->half.low, 1.7639821, 1e-6);
  EXPECT_NEAR(*d.fit->half.high, 1.7791872, 1e-6);
  EXPECT_NEAR(d.fit->most.size, 1.8358355, 1e-6);
  EXPECT_NEAR(*d.fit->most.low, 1.8245618, 1e-6);
  EXPECT_NEAR(*d.fit->most.high, 1.8490600, 1e-6);
  EXPECT_NEAR(d.chanceAt(d.fit->half.size), 0.5, 1e-9);
  EXPECT_NEAR(d.chanceAt(d.fit->most.size), 0.9, 1e-9);
}

TEST(Detection, FitsFewTrialsAsPublished) {
  std::vector<Trial> trials;
  for (const double t : kFailed) trials.push_back({100.0 - t, true});
  for (const double t : kHeld) trials.push_back({100.0 - t, false});
  const Detection d = detectionOf(trials);
  ASSERT_TRUE(d.fit);
  EXPECT_NEAR(d.fit->slope, 0.2322, 5e-5);
  EXPECT_NEAR(100.0 - d.fit->half.size, 64.79, 5e-3);
  EXPECT_NEAR(*d.fit->half.low, 30.730078, 1e-5);
  EXPECT_NEAR(*d.fit->half.high, 47.512747, 1e-5);
  EXPECT_NEAR(d.fit->most.size, 44.669515, 1e-5);
  EXPECT_NEAR(*d.fit->most.low, 36.912093, 1e-5);
  EXPECT_NEAR(*d.fit->most.high, 81.640461, 1e-4);
}

TEST(Detection, SizesOverSeveralOctavesAreFittedOverTheirLogarithm) {
  std::vector<Group> doses;
  for (const Group& g : kBeetles) doses.push_back({std::exp(10.0 * g.size), g.trials, g.found});
  const Detection d = detectionOf(trialsOf(doses));
  ASSERT_TRUE(d.fit);
  EXPECT_TRUE(d.logarithmic);
  EXPECT_NEAR(d.fit->slope, 3.4270, 5e-5);
  EXPECT_NEAR(std::log(d.fit->half.size), 17.71721, 1e-4);
  EXPECT_NEAR(std::log(*d.fit->half.low), 17.639821, 1e-5);
  EXPECT_NEAR(std::log(*d.fit->most.high), 18.490600, 1e-5);
  // Another unit moves the sizes with it and changes nothing else.
  for (Group& g : doses) g.size *= 1e-9;
  const Detection other = detectionOf(trialsOf(doses));
  EXPECT_NEAR(other.fit->half.size / d.fit->half.size, 1e-9, 1e-15);
  EXPECT_NEAR(other.fit->slope, d.fit->slope, 1e-9);
}

TEST(Detection, ASizeThatWasNotTriedIsMarked) {
  std::vector<Trial> trials;
  for (int i = 1; i <= 40; ++i) trials.push_back({static_cast<double>(i), i == 12 || i == 30 || i == 38});
  const Detection d = detectionOf(trials);
  ASSERT_TRUE(d.fit);
  EXPECT_EQ(d.smallest, 1.0);
  EXPECT_EQ(d.largest, 40.0);
  EXPECT_GT(d.fit->most.size, 40.0);
  EXPECT_TRUE(d.fit->most.is_extrapolated);
  EXPECT_FALSE(detectionOf(trialsOf(kBeetles)).fit->half.is_extrapolated);
}

TEST(Detection, TheOrderOfTheTrialsIsNothing) {
  std::vector<Trial> trials = trialsOf(kBeetles);
  const Detection d = detectionOf(trials);
  std::reverse(trials.begin(), trials.end());
  EXPECT_EQ(detectionOf(trials).fit->half.size, d.fit->half.size);
}

TEST(Detection, APerfectPartingIsNotFittedButBracketed) {
  const Detection d = detectionOf({{1.0, false}, {2.0, false}, {3.0, true}, {9.0, true}});
  EXPECT_FALSE(d.fit);
  EXPECT_THAT(d.not_fitted, HasSubstr("parts"));
  EXPECT_EQ(d.largest_missed, 2.0);
  EXPECT_EQ(d.smallest_found, 3.0);
  // Found and missed at one and the same size: the likelihood still has no maximum.
  const Detection touching = detectionOf({{1.0, false}, {2.0, false}, {2.0, true}, {9.0, true}});
  EXPECT_FALSE(touching.fit);
  EXPECT_EQ(touching.largest_missed, touching.smallest_found);
}

TEST(Detection, WhatDoesNotVaryIsNotFitted) {
  EXPECT_THAT(detectionOf({}).not_fitted, HasSubstr("no run"));
  EXPECT_THAT(detectionOf({{1.0, true}, {2.0, true}}).not_fitted, HasSubstr("all were found"));
  EXPECT_THAT(detectionOf({{1.0, false}, {2.0, false}}).not_fitted, HasSubstr("none was found"));
  EXPECT_THAT(detectionOf({{1.0, false}, {1.0, true}}).not_fitted, HasSubstr("one size"));
  EXPECT_FALSE(detectionOf({{1.0, false}, {2.0, false}}).smallest_found);
  EXPECT_FALSE(detectionOf({{1.0, true}, {2.0, true}}).largest_missed);
}

TEST(Detection, LargerFaultsThatAreFoundLessOftenHaveNoCurve) {
  EXPECT_THAT(detectionOf({{1.0, true}, {2.0, true}, {3.0, false}}).not_fitted,
              HasSubstr("smaller were found"));
  const Detection falling =
      detectionOf({{1, true}, {2, true}, {3, false}, {4, true}, {5, false}, {6, false}});
  EXPECT_FALSE(falling.fit);
  EXPECT_THAT(falling.not_fitted, HasSubstr("not found more often"));
}

TEST(Detection, ABoundThatTheDataDoNotGiveIsAbsent) {
  // Hardly any trend: the size that nine of ten are found from may be as large as one likes.
  const Detection d = detectionOf({{1, false}, {2, true}, {3, false}, {4, true}, {5, false}, {6, true}});
  ASSERT_TRUE(d.fit);
  EXPECT_FALSE(d.fit->most.high);
  EXPECT_FALSE(d.fit->half.low);
}

}  // namespace
}  // namespace kerfbench::campaign
