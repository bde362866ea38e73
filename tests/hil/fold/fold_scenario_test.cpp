// SPDX-License-Identifier: Apache-2.0
// Scenarios of cuts over folded blanks: what is read, and what is refused.
#include "hil/fold/fold_scenario.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/input_error.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::fold {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

const std::filesystem::path kBox = base::fixture("fold/box-corner-left.yaml");

class FoldScenarios : public testing::Test {
 protected:
  FoldScenario extended(const std::string& keys) const {
    return readFoldScenario(temp_.write("s.yaml", fmt::format("extends: '{}'\n{}", kBox.string(), keys)));
  }
  std::string faultsOfKeys(const std::string& keys) const {
    try {
      (void)extended(keys);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  }
  const base::TempFolder temp_;
};

TEST_F(FoldScenarios, FoldedFacesStandWhereTheirFoldsPutThem) {
  const FoldScenario scenario = readFoldScenario(kBox);
  ASSERT_EQ(scenario.job.faces.size(), 3U);
  const Eigen::Isometry3d& side = scenario.job.faces[1].X_WF;
  EXPECT_LT((side.linear().col(2) - Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_LT((side.linear().col(1) + Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_LT((side.translation() - Vector3d(40.0, 60.0, 0.0)).norm(), 1e-12);
  EXPECT_LT((scenario.job.faces[2].X_WF.linear().col(2) - Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_EQ(scenario.job.lines.size(), 5U);
}

TEST_F(FoldScenarios, AFoldsErrorMovesTheStandingBlankAndNotTheDrawnOne) {
  const FoldScenario scenario = readFoldScenario(base::fixture("fold/faults/fold-angle.yaml"));
  const Eigen::Matrix3d& drawn = scenario.job.faces[1].X_WF.linear();
  const Eigen::Matrix3d& standing = scenario.blank.standing[1].X_WF.linear();
  EXPECT_LT((drawn.col(2) - Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_NEAR(Eigen::AngleAxisd(drawn.transpose() * standing).angle(), 0.0174533, 1e-6);
}

TEST_F(FoldScenarios, ErrorsOfTheScenarioWinOverTheMachines) {
  const FoldScenario plain = readFoldScenario(kBox);
  const FoldScenario changed = extended("errors: {pivot_mm: 0.2}\n");
  EXPECT_DOUBLE_EQ(changed.machine.head.errors.pivot_mm, 0.2);
  EXPECT_DOUBLE_EQ(changed.machine.head.errors.a_zero_rad, plain.machine.head.errors.a_zero_rad);
}

TEST_F(FoldScenarios, EveryFaultIsToldWithFileAndLine) {
  const std::string faults =
      faultsOfKeys("kerf: {radius_mm: 3, side: up}\nnonsense: 1\nlimits: {path_mm: -1}\n");
  EXPECT_THAT(faults, HasSubstr("s.yaml:2: kerf.radius_mm"));
  EXPECT_THAT(faults, HasSubstr("s.yaml:2: kerf.side"));
  EXPECT_THAT(faults, HasSubstr("s.yaml:3: nonsense"));
  EXPECT_THAT(faults, HasSubstr("s.yaml:4: limits.path_mm"));
}

TEST_F(FoldScenarios, AFaceIsFoldedOnOneBeforeIt) {
  const std::string faults = faultsOfKeys(
      "faces:\n  - {name: a, origin_mm: [0, 0, 0], x_axis: [1, 0, 0], normal: [1, 0, 1], outline_mm: [0, 0, "
      "9, 9], "
      "marks: [{at_mm: [50, 50]}]}\n  - {name: b, fold_on: c, fold_mm: [0, 0, 0, 0], fold_deg: 90, depth_mm: "
      "9, marks: []}\n");
  EXPECT_THAT(faults, HasSubstr("normal and x_axis must be directions at a right angle"));
  EXPECT_THAT(faults, HasSubstr("the mark does not lie within the face"));
  EXPECT_THAT(faults, HasSubstr("marks: must list 3 … 64 marks"));
  EXPECT_THAT(faults, HasSubstr("'c' is the name of no face before this one"));
  EXPECT_THAT(faults, HasSubstr("is shorter than 1 mm"));
}

TEST_F(FoldScenarios, WhatThePlannerAndTheContourRefuseIsBadInput) {
  (void)temp_.write("short.xyz", "0 0 0 0 0 1\n0.1 0 0 0 0 1\n");
  EXPECT_THAT(faultsOfKeys("contour: short.xyz\n"), HasSubstr("too short for its kerf"));
  (void)temp_.write("off.xyz", "0 0 5 0 0 1\n20 0 5 0 0 1\n");
  EXPECT_THAT(faultsOfKeys("contour: off.xyz\n"),
              HasSubstr("off.xyz:1: the line that begins here lies in no face"));
  EXPECT_THAT(faultsOfKeys("contour: missing.xyz\n"), HasSubstr("no such file"));
  EXPECT_THAT(faultsOfKeys("program: {gcode: p.gcode, side: left}\n"),
              HasSubstr("has no effect beside gcode"));
}

}  // namespace
}  // namespace kerfbench::fold
