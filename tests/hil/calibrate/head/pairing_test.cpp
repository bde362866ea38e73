// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "hil/calibrate/head/axis_check.h"
#include "hil/calibrate/head/observation.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const Matrix2d kFine = Matrix2d::Identity() * 1e-6;

std::vector<AimedMark> job(int n) {
  std::vector<AimedMark> marks;
  for (int i = 0; i < n * n; ++i) marks.push_back({i, 10.0 * Vector2d(i % n, i / n)});
  return marks;
}

std::vector<SeenMark> seenOf(const std::vector<AimedMark>& job) {
  std::vector<SeenMark> seen;
  for (const AimedMark& mark : job) seen.push_back({mark.id, mark.aim_W_mm, kFine});
  return seen;
}

std::string refusalOf(const auto& work) {
  try {
    work();
  } catch (const HeadCalibrationError& e) {
    return e.what();
  }
  return "";
}

TEST(Pairing, TellsMissingDoubledMergedAndUnknownMarks) {
  const auto aimed = job(5);
  auto seen = seenOf(aimed);
  seen.erase(seen.begin() + 3);
  seen.push_back({7, aimed[7].aim_W_mm + Vector2d(0.002, 0.0), kFine});
  seen.push_back({9, aimed[9].aim_W_mm + Vector2d(5.0, 0.0), kFine});
  seen.push_back({99, Vector2d::Zero(), kFine});
  const Pairing pairing = pairMarks(aimed, seen);
  EXPECT_THAT(pairing.missing, ElementsAre(3));
  EXPECT_THAT(pairing.merged, ElementsAre(7));
  EXPECT_THAT(pairing.doubled, ElementsAre(9));
  EXPECT_THAT(pairing.unknown, ElementsAre(99));
  ASSERT_EQ(pairing.observations.size(), 23U);
  const HeadObservation& merged = pairing.observations[6];
  EXPECT_EQ(merged.mark, 7);
  EXPECT_NEAR(merged.measured_W_mm.x(), 20.001, 1e-12);
  EXPECT_NEAR(merged.covariance_mm2(0, 0), 0.5e-6, 1e-15);
}

TEST(Pairing, RefusesWhatIsTooBadAndSaysAllOfIt) {
  const auto aimed = job(3);
  auto seen = seenOf(aimed);
  seen.erase(seen.begin(), seen.begin() + 3);
  seen[0].p_mm.x() = NAN;
  seen.push_back({77, Vector2d::Zero(), kFine});
  const std::string why = refusalOf([&] { pairMarks(aimed, seen); });
  EXPECT_THAT(why, HasSubstr("mark 3 as found is not finite"));
  EXPECT_THAT(why, HasSubstr("4 of 9 marks are missing, more than 25 %: 0, 1, 2, 3"));
  EXPECT_THAT(why, HasSubstr("1 are not of the job (77)"));
}

std::vector<HeadObservation> madeBy(const AxisMap& map) {
  std::vector<HeadObservation> made;
  for (const AimedMark& mark : job(5)) {
    const Vector2d p = mark.aim_W_mm;
    const Vector2d bow = 1e-4 * p.squaredNorm() * Vector2d(1.0, -0.5);
    made.push_back({mark.id, p, map.matrix() * (p + bow) + Vector2d(3.0, -8.0), kFine, {}});
  }
  return made;
}

TEST(Axes, AllEightWaysOfWiringAreRecognised) {
  for (int way = 0; way < 8; ++way) {
    const AxisMap map{(way & 4) != 0, (way & 2) != 0, (way & 1) != 0};
    auto marks = madeBy(map);
    marks[4].measured_W_mm = {500.0, 500.0};
    std::swap(marks[7].measured_W_mm, marks[19].measured_W_mm);
    EXPECT_EQ(identifyAxes(marks).map, map) << way;
  }
}

TEST(Axes, AreToldInWords) {
  EXPECT_EQ((AxisMap{}).words(), "x and y are as told");
  EXPECT_EQ((AxisMap{false, true, false}).words(), "x runs backwards: the picture is mirrored");
  EXPECT_EQ((AxisMap{true, false, false}).words(), "x and y are exchanged: the picture is mirrored");
  EXPECT_EQ((AxisMap{true, false, true}).words(),
            "x and y are exchanged; y runs backwards: the picture is turned by 90 degrees clockwise");
  EXPECT_EQ((AxisMap{false, true, true}).words(),
            "x and y run backwards: the picture is turned by 180 degrees");
}

TEST(Axes, MarksThatFitNothingAreRefused) {
  auto marks = madeBy({});
  EXPECT_THAT(refusalOf([&] { identifyAxes(std::span(marks).first(4)); }), HasSubstr("4 marks do not tell"));
  EXPECT_THAT(refusalOf([&] { identifyAxes(std::span(marks).first(5)); }), HasSubstr("along one line"));
  for (std::size_t i = 0; i < marks.size(); ++i)
    marks[i].measured_W_mm = 10.0 * Vector2d((7 * i) % 25 % 5, (7 * i) % 25 / 5);
  EXPECT_THAT(refusalOf([&] { identifyAxes(marks); }),
              HasSubstr("fit neither as told nor turned or mirrored"));
}

}  // namespace
}  // namespace kerfbench::calibrate
