// SPDX-License-Identifier: Apache-2.0
// Verdicts on scans that were put together by hand: what must fail, and what must pass just beside it.
#include "hil/inspect/space/space_checks.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace kerfbench::inspect {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kHalf_mm = 0.25;

/// One level face with a contour that turns left in (30, 10), kerf on the left; a scan with a kerf
/// everywhere.
class SpaceChecks : public testing::Test {
 protected:
  SpaceChecks() {
    contour_ = {{Vector3d(10.0, 10.0, 0.0), Vector3d::UnitZ(), 1},
                {Vector3d(30.0, 10.0, 0.0), Vector3d::UnitZ(), 2},
                {Vector3d(30.0, 40.0, 0.0), Vector3d::UnitZ(), 3}};
    std::vector<SpaceFace> faces(1);
    faces[0].name = "top";
    faces[0].outline_F_mm = Eigen::AlignedBox2d(Vector2d(0.0, 0.0), Vector2d(40.0, 60.0));
    job_ = layContour(contour_, faces, 1.0, kHalf_mm, "c.xyz");
    instruments_.beam_radius_mm = 1e-6;  // So that light and severed width are one.
    instruments_.board_transmission = 0.12;
    evidence_.pose.emplace();
    evidence_.scan.units.emplace_back();
    const FacePlan plan = planFace(job_, 0);
    for (std::size_t k = 0; k < plan.kerfs.lines.size(); ++k) {
      vision::EntityKerf kerf;
      kerf.entity = static_cast<int>(k);
      const SpaceLine& line = job_.lines[plan.kerfs.lines[k]];
      const Vector2d from = line.from_F_mm + kHalf_mm * line.beside_F;
      for (double s = 0.0; s < line.kerf_to_mm - line.kerf_from_mm; s += kEdgePitch_mm)
        kerf.calipers.push_back(caliperAt(s, from + (line.kerf_from_mm + s) * line.along_F));
      // As the scan says of calipers near the corner.
      for (std::size_t i = 0; i < 4; ++i)
        (k == 0 ? kerf.calipers.rbegin()[static_cast<std::ptrdiff_t>(i)] : kerf.calipers[i]).near_joint =
            true;
      evidence_.scan.entities.push_back(kerf);
    }
  }
  static vision::Caliper caliperAt(double station_mm, const Vector2d& p_mm) {
    vision::Caliper caliper;
    caliper.station_mm = station_mm;
    caliper.p_S_mm = p_mm;
    caliper.found = true;
    caliper.sigma_mm = 0.002;
    caliper.width_mm = 2.0 * kHalf_mm;
    caliper.width_sigma_mm = 0.002;
    caliper.brightness = 1.0;
    return caliper;
  }
  vision::Caliper& caliper(std::size_t entity, std::size_t i) {
    return evidence_.scan.entities[entity].calipers[i];
  }
  SpaceResult judge() const { return judgeInSpace(job_, contour_, {evidence_}, instruments_, {}, 1); }
  static Verdict verdictOf(const SpaceResult& result, const std::string& name) {
    const auto found = std::ranges::find(result.checks, name, &Check::name);
    return found == result.checks.end() ? Verdict::kInvalid : found->verdict;
  }

  std::vector<ContourPoint> contour_;
  SpaceJob job_;
  SpaceInstruments instruments_;
  FaceEvidence evidence_;
};

TEST_F(SpaceChecks, AnExactCutPasses) {
  const SpaceResult result = judge();
  for (const Check& check : result.checks) EXPECT_EQ(check.verdict, Verdict::kPass) << check.name;
  EXPECT_EQ(result.verdict, Verdict::kPass);
}

TEST_F(SpaceChecks, AFaceThatStandsAsideFailsThoughItsKerfIsRight) {
  evidence_.pose->X_WF.translation().z() = 0.03;
  EXPECT_EQ(judge().verdict, Verdict::kPass);
  evidence_.pose->X_WF.translation().z() = -0.07;
  EXPECT_EQ(verdictOf(judge(), "space_path"), Verdict::kFail);
}

TEST_F(SpaceChecks, AWiderKerfTakesFromThePiece) {
  for (vision::EntityKerf& kerf : evidence_.scan.entities) {
    for (vision::Caliper& c : kerf.calipers) c.width_mm = 2.0 * (kHalf_mm + 0.07);
  }
  const SpaceResult result = judge();
  EXPECT_EQ(verdictOf(result, "space_path"), Verdict::kFail);
  const auto along = std::ranges::find(result.readings, EdgeZone::kAlong, &EdgeReading::zone);
  ASSERT_NE(along, result.readings.end());
  EXPECT_NEAR(along->beside_mm, -0.07, 1e-6);
}

TEST_F(SpaceChecks, AtACornerBoardMayBeLeftAndNoneMayBeLost) {
  for (std::size_t i = 190; i < 196; ++i) caliper(0, i).near_joint = true;
  for (std::size_t i = 190; i < 196; ++i) caliper(0, i).offset_mm = 0.1;
  EXPECT_EQ(judge().verdict, Verdict::kPass);
  for (std::size_t i = 190; i < 196; ++i) caliper(0, i).offset_mm = -0.1;
  EXPECT_EQ(verdictOf(judge(), "space_joints"), Verdict::kFail);
}

TEST_F(SpaceChecks, AStretchThatIsNotCutThroughFailsFromItsLimitOn) {
  for (std::size_t i = 50; i < 54; ++i) caliper(1, i).brightness = 0.3;
  EXPECT_EQ(judge().verdict, Verdict::kPass);
  for (std::size_t i = 50; i < 56; ++i) caliper(1, i).brightness = 0.3;
  EXPECT_EQ(verdictOf(judge(), "space_coverage"), Verdict::kFail);
}

TEST_F(SpaceChecks, BurntPlacesWithinTheFaceFail) {
  evidence_.scan.strays.push_back({0, Vector2d(-3.0, 10.0), 2.0});
  EXPECT_EQ(judge().verdict, Verdict::kPass);
  evidence_.scan.strays.push_back({0, Vector2d(5.0, 30.0), 0.7});
  EXPECT_EQ(verdictOf(judge(), "space_stray"), Verdict::kFail);
}

TEST_F(SpaceChecks, WithoutAPoseOrAScanNothingIsProven) {
  const FaceEvidence whole = evidence_;
  evidence_.pose.reset();
  EXPECT_EQ(judge().verdict, Verdict::kInvalid);
  evidence_ = whole;
  evidence_.scan.units.clear();
  EXPECT_EQ(judge().verdict, Verdict::kInvalid);
  evidence_ = whole;
  evidence_.scan.problems.emplace_back("no tile");
  EXPECT_EQ(judge().verdict, Verdict::kInvalid);
}

TEST_F(SpaceChecks, KerfsThatCannotBeReadAreNoPass) {
  for (vision::EntityKerf& kerf : evidence_.scan.entities) {
    for (vision::Caliper& c : kerf.calipers) c.found = false;
  }
  EXPECT_EQ(judge().verdict, Verdict::kInvalid);
}

}  // namespace
}  // namespace kerfbench::inspect
