// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "tests/hil/inspect/not_numbers.h"
#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::inspect {
namespace {

using namespace testing;

/// A flawless run with all corners of its outline and all ends of its crease.
struct JointRun : SyntheticRun {
  JointRun() {
    for (int unit = 0; unit < evidence.print.units; ++unit) {
      for (const int in : {kBottom, kRight, kTop, kLeft}) {
        const int out = in == kLeft ? kBottom : in + 1;
        evidence.kerf.corners.push_back({.unit = unit,
                                         .entity_in = in,
                                         .entity_out = out,
                                         .p_S_mm = dieline::pointAt(curveOf(in), 1.0),
                                         .turn_rad = 1.5708,
                                         .found = true,
                                         .rounding_mm = 0.002,
                                         .overshoot_mm = 0.0,
                                         .deviation_mm = 0.003,
                                         .rounding_sigma_mm = 0.001,
                                         .overshoot_sigma_mm = 0.001,
                                         .deviation_sigma_mm = 0.001});
      }
      for (const bool at_start : {true, false})
        evidence.kerf.ends.push_back({unit, kCreaseLine, at_start, true, 0.004, 0.002});
      evidence.kerf.ends.push_back({unit, kHole, true, true, 0.0, 0.002});
    }
  }
  [[nodiscard]] const dieline::Curve& curveOf(int id) const {
    return dieline.entities[static_cast<std::size_t>(id)].curve;
  }
  [[nodiscard]] vision::CornerKerf& corner(std::size_t i) { return evidence.kerf.corners.at(i); }
  [[nodiscard]] vision::LineEnd& end(std::size_t i) { return evidence.kerf.ends.at(i); }
};

TEST(JointsCheck, PassesAFlawlessRunAndIsLeftOutWithoutJoints) {
  JointRun run;
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "joints").verdict, Verdict::kPass);
  EXPECT_EQ(checkOf(result, "joints").explanation.find("not judged"), std::string::npos);
  EXPECT_EQ(result.verdict, Verdict::kPass);
  EXPECT_FALSE(hasCheck(SyntheticRun().inspected(), "joints"));
}

TEST(JointsCheck, ProvesACornerAndTellsWhy) {
  JointRun run;
  run.corner(1).rounding_mm = 0.08;
  run.corner(1).deviation_mm = 0.075;
  const auto result = run.inspected();
  const Check& joints = checkOf(result, "joints");
  EXPECT_EQ(joints.verdict, Verdict::kFail);
  EXPECT_EQ(joints.subject, "unit 0, E1");
  EXPECT_NEAR(joints.value, 0.075, 0.003);
  EXPECT_GT(joints.chance_beyond, 0.999);
  EXPECT_NE(joints.explanation.find("corner to E2 at x 60.00, y 40.00 mm"), std::string::npos)
      << joints.explanation;
  EXPECT_NE(joints.explanation.find("rounded off by 0.0800 mm"), std::string::npos) << joints.explanation;
  EXPECT_EQ(result.verdict, Verdict::kFail);
}

TEST(JointsCheck, ACornerWithAShortLegIsNamedAndNotJudged) {
  JointRun run;
  run.corner(2).found = false;
  run.corner(2).deviation_mm = kNan;
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
  run.corner(2).short_leg = true;
  const auto result = run.inspected();
  EXPECT_EQ(result.verdict, Verdict::kPass);
  EXPECT_NE(checkOf(result, "joints").explanation.find("the first is the corner to E3 at x 0.00, y 40.00 mm"),
            std::string::npos)
      << checkOf(result, "joints").explanation;
  // A fault at another corner is still found.
  run.corner(1).deviation_mm = 0.075;
  EXPECT_EQ(checkOf(run.inspected(), "joints").verdict, Verdict::kFail);
}

TEST(JointsCheck, WithShortLegsAloneIsNotJudged) {
  JointRun run;
  for (vision::CornerKerf& corner : run.evidence.kerf.corners) corner.short_leg = true;
  run.evidence.kerf.ends.clear();
  EXPECT_TRUE(unjudgedOf(run.inspected(), "joints").applies);
}

TEST(JointsCheck, ACornerThatIsOnlyDisplacedDeviates) {
  JointRun run;
  run.corner(0).deviation_mm = 0.075;
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "joints").verdict, Verdict::kFail);
  EXPECT_EQ(checkOf(result, "joints").explanation.find("against its own legs"), std::string::npos)
      << "it is neither rounded off nor run over";
}

TEST(JointsCheck, ReachesAsFarAsTheWorstJointMayDeviateAndNoFarther) {
  JointRun run;
  run.corner(1).deviation_mm = 0.03;
  const auto result = run.inspected();
  double farthest_mm = 0.0;
  for (const JointResult& j : result.joints)
    if (j.kind == JointResult::Kind::kCorner) farthest_mm = std::max(farthest_mm, j.mm.value + j.mm.U);
  const Check& check = checkOf(result, "joints");
  EXPECT_GT(farthest_mm, 0.03);
  EXPECT_NEAR(check.value + check.u, farthest_mm, 1e-12);
}

TEST(JointsCheck, RoundingAloneIsNoDeviation) {
  // The kerf is that of a cut that is displaced outwards by about as much.
  JointRun run;
  run.corner(0).rounding_mm = 0.075;
  EXPECT_EQ(checkOf(run.inspected(), "joints").verdict, Verdict::kPass);
}

TEST(JointsCheck, AnEndNeitherShortNorLongByMoreThanThePathMayBe) {
  for (const double gap_mm : {0.06, -0.06}) {
    JointRun run;
    run.end(1).gap_mm = gap_mm;
    const auto result = run.inspected();
    const Check& joints = checkOf(result, "joints");
    EXPECT_EQ(joints.verdict, Verdict::kFail);
    EXPECT_GT(joints.chance_beyond, 0.99);
    EXPECT_NE(joints.explanation.find(gap_mm > 0.0 ? "0.0600 mm too early" : "0.0600 mm too late"),
              std::string::npos)
        << joints.explanation;
  }
}

TEST(JointsCheck, AnOpenClosureFails) {
  JointRun run;
  run.end(2).gap_mm = 0.07;
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "joints").verdict, Verdict::kFail);
  EXPECT_NE(checkOf(result, "joints").explanation.find("0.0700 mm are left uncut"), std::string::npos);
}

TEST(JointsCheck, WithinItsUncertaintyOfTheLimitNothingIsProven) {
  for (const double gap_mm : {0.049, 0.051}) {
    JointRun run;
    run.end(0).gap_mm = gap_mm;
    EXPECT_EQ(checkOf(run.inspected(), "joints").verdict, Verdict::kNotProven) << gap_mm;
  }
}

TEST(JointsCheck, NoJointWithinReachOfAFaultPasses) {
  // The check exists even where the joint is measured badly.
  JointRun run;
  run.end(0).gap_mm = 0.04;
  run.end(0).sigma_mm = 0.006;
  EXPECT_EQ(checkOf(run.inspected(), "joints").verdict, Verdict::kNotProven);
}

TEST(JointsCheck, TheLimitIsThatOfThePath) {
  JointRun run;
  run.end(0).gap_mm = 0.08;
  run.limits.path_mm = 0.1;
  EXPECT_EQ(checkOf(run.inspected(), "joints").verdict, Verdict::kPass);
  EXPECT_EQ(checkOf(run.inspected(), "joints").limit, 0.1);
}

TEST(JointsCheck, AJointThatWasNotMeasuredIsInvalidAndNumbersThatAreNoneToo) {
  JointRun unseen;
  unseen.corner(2).found = false;
  EXPECT_EQ(checkOf(unseen.inspected(), "joints").verdict, Verdict::kInvalid);
  EXPECT_NE(checkOf(unseen.inspected(), "joints").explanation.find("could not be measured"),
            std::string::npos);
  for (const auto bend :
       {+[](JointRun& r) { r.corner(0).deviation_mm = kNan; },
        +[](JointRun& r) { r.corner(0).deviation_sigma_mm = kNan; },
        +[](JointRun& r) { r.end(0).gap_mm = kNan; }, +[](JointRun& r) { r.end(0).sigma_mm = kNan; }}) {
    JointRun run;
    bend(run);
    EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
  }
}

TEST(JointsCheck, WhatIsNotCutAtAllIsLeftToCoverage) {
  JointRun run;
  for (vision::Caliper& c : run.kerf(0, kTop).calipers) {
    c.found = false;
    c.offset_mm = c.width_mm = kNan;
    c.brightness = 0.0;
  }
  for (vision::CornerKerf& c : run.evidence.kerf.corners) {
    if (c.unit == 0 && (c.entity_in == kTop || c.entity_out == kTop)) c.found = false;
  }
  EXPECT_EQ(checkOf(run.inspected(), "joints").verdict, Verdict::kPass);
  EXPECT_EQ(checkOf(run.inspected(), "coverage").verdict, Verdict::kFail);
}

TEST(JointsCheck, CornersOfTwoProcessesAreCountedAndNotJudged) {
  JointRun run;
  run.corner(0).entity_out = kCreaseLine;
  run.corner(0).deviation_mm = 0.2;
  const auto result = run.inspected();
  EXPECT_EQ(checkOf(result, "joints").verdict, Verdict::kPass);
  EXPECT_NE(checkOf(result, "joints").explanation.find("1 corners of two processes"), std::string::npos);
}

TEST(Joints, DeviationCarriesTheUncertaintyOfThePlaceAndRoundingDoesNot) {
  JointRun run;
  const auto result = run.inspected();
  const auto of = [&](JointResult::Kind kind) {
    for (const JointResult& j : result.joints) {
      if (j.kind == kind) return j.mm;
    }
    return Quantity{};
  };
  EXPECT_NEAR(of(JointResult::Kind::kRounding).U, 0.002, 1e-9);
  EXPECT_GT(of(JointResult::Kind::kCorner).U, 0.002);
}

}  // namespace
}  // namespace kerfbench::inspect
