// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/compensation/space_file.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kerfbench::planner {
namespace {

using ::testing::HasSubstr;

std::string faultsIn(const std::string& text) {
  try {
    readSpaceContour(text, "box.xyz");
  } catch (const CompensationError& error) {
    return error.what();
  }
  return {};
}

TEST(SpaceFile, PointsCommentsAndLinesAreRead) {
  const SpaceContour contour =
      readSpaceContour("# a fold\n0 0 0 0 0 1\n\n5,0,0, 1,0,0 ; edge\r\n5\t0\t-5 1 0 0\n", "box.xyz");
  ASSERT_EQ(contour.points.size(), 3U);
  EXPECT_EQ(contour.file_lines, (std::vector<int>{2, 4, 5}));
  EXPECT_EQ(contour.points[1].axis, Eigen::Vector3d::UnitX());
}

TEST(SpaceFile, FaultsAreListedWithTheirLines) {
  const std::string faults = faultsIn("0 0 0 0 0 1\n1 2 3\n1 2 x 0 0 1\nnan 0 0 0 0 1\n1e9 0 0 0 0 1\n");
  EXPECT_THAT(faults, HasSubstr("box.xyz: line 2: 3 values instead of the six"));
  EXPECT_THAT(faults, HasSubstr("line 3: 'x' is no number"));
  EXPECT_THAT(faults, HasSubstr("line 4: 'nan' is no number"));
  EXPECT_THAT(faults, HasSubstr("line 5: 1e9 is beyond"));
  EXPECT_THAT(faultsIn(""), HasSubstr("needs two points"));
}

TEST(SpaceFile, NoWordOfAForeignFileIsShown) {
  EXPECT_EQ(faultsIn("# a list\nroot:secret:19000:0\nsecret\n"),
            "box.xyz: line 2: begins with neither a number nor a word of a contour: it is no contour");
}

TEST(Poses, TurnTheHeadsAxisToTheSurfaceNormal) {
  std::vector<SpacePoint> path;
  for (int i = 0; i < 100; ++i) {
    const double t = 0.2 * i;
    path.push_back({{t, 0, 0}, Eigen::Vector3d(std::cos(t), std::sin(t), std::cos(0.7 * t)).normalized()});
  }
  const std::vector<Pose> poses = posesOf(path);
  const double deg = std::numbers::pi / 180.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double a = poses[i].a_deg * deg;
    const double c = poses[i].c_deg * deg;
    const Eigen::Vector3d axis(std::sin(c) * std::sin(a), -std::cos(c) * std::sin(a), std::cos(a));
    EXPECT_LT((axis - path[i].axis).norm(), 1e-12);
    const double before = i > 0 ? poses[i - 1].c_deg : poses[i].c_deg;
    EXPECT_LT(std::abs(poses[i].c_deg - before), 12.0);  // no jump over 360
  }
  EXPECT_GT(poses.back().c_deg, 1000.0);
}

TEST(Poses, AVerticalAxisLeavesCAlone) {
  const std::vector<Pose> poses =
      posesOf({{{0, 0, 0}, {1, 0, 0}}, {{1, 0, 0}, {0, 0, 1}}, {{2, 0, 0}, {1, 0, 0}}});
  for (const Pose& pose : poses) EXPECT_NEAR(pose.c_deg, 90.0, 1e-12);
  EXPECT_EQ(writePoses({poses[1]}), "G00 X1.0000 Y0.0000 Z0.0000 A0.0000 C90.0000\n");
}

}  // namespace
}  // namespace kerfbench::planner
