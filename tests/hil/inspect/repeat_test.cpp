// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/spot_checks.h"

namespace kerfbench::inspect {
namespace {

using ::testing::HasSubstr;

constexpr double kStep_mm = 0.3;  // 300 mm/s, 1000 frames a second.

/// A disc of 40 mm as a polygon of pieces of this length, and frames of a spot along it.
struct Polygon {
  explicit Polygon(double piece_mm)
      : count(static_cast<int>(std::lround(40.0 * std::numbers::pi / piece_mm))) {
    for (int i = 0; i < count; ++i)
      dieline.entities.push_back({i, dieline::LineCurve{corner(i), corner(i + 1)}, {}, "CUT", "line 1", {}});
    evidence.dieline = &dieline;
    for (int i = 0; i < count; ++i) entities.push_back({.unit = 0, .entity = i, .coverage = 1.0});
  }
  [[nodiscard]] Eigen::Vector2d corner(double at) const {
    const double angle_rad = 2.0 * std::numbers::pi * at / count;
    return 20.0 * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
  }
  /// A run of the spot from one corner to another.
  void follow(int from, int to) {
    const std::size_t begin = lit.frames.size();
    const double piece_mm = (corner(1) - corner(0)).norm();
    for (double at = from; at < to; at += kStep_mm / piece_mm) {
      const int entity = static_cast<int>(at) % count;
      const double share = at - std::floor(at);
      lit.frames.push_back({.time_s = 0.001 * static_cast<double>(lit.frames.size()),
                            .sigma_mm = 0.002,
                            .p_S_mm = (1.0 - share) * corner(entity) + share * corner(entity + 1),
                            .entity = entity});
    }
    lit.runs.push_back({begin, lit.frames.size()});
  }
  Check check() {
    checks::countPasses(evidence, lit, entities);
    return checks::repeatCheck(evidence, Tolerances{}, lit, entities);
  }

  int count;
  dieline::Dieline dieline;
  Evidence evidence;
  LitFrames lit;
  std::vector<EntityResult> entities;
};

TEST(RepeatCheck, AnOutlineOfShortPiecesIsCountedInStretches) {
  for (const double piece_mm : {0.05, 0.15, 0.3, 0.5, 0.8, 1.1}) {
    Polygon polygon(piece_mm);
    polygon.follow(0, polygon.count);
    const Check check = polygon.check();
    EXPECT_EQ(check.verdict, Verdict::kPass) << piece_mm << ": " << check.value << " " << check.explanation;
    EXPECT_NEAR(check.value, 1.0, 0.2) << piece_mm;
    EXPECT_THAT(check.explanation, ::testing::Not(HasSubstr("too short"))) << piece_mm;
  }
}

TEST(RepeatCheck, FindsAFewMillimetresOfShortPiecesThatAreCutTwice) {
  for (const double piece_mm : {0.05, 0.15, 0.3, 0.5, 0.8}) {
    Polygon polygon(piece_mm);
    polygon.follow(0, polygon.count);
    const int from = polygon.count / 3;
    polygon.follow(from, from + static_cast<int>(8.0 / piece_mm));
    const Check check = polygon.check();
    EXPECT_EQ(check.verdict, Verdict::kFail) << piece_mm << ": " << check.value;
    EXPECT_THAT(check.subject, HasSubstr(" to E")) << piece_mm;
  }
}

TEST(RepeatCheck, ALoneShortLineIsLeftToItsKerf) {
  Polygon polygon(0.5);
  polygon.dieline.entities.resize(1);
  polygon.entities.resize(1);
  polygon.follow(0, 1);
  EXPECT_EQ(polygon.check().verdict, Verdict::kInvalid);
}

}  // namespace
}  // namespace kerfbench::inspect
