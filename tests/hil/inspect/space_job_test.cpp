// SPDX-License-Identifier: Apache-2.0
// Contours laid into faces, against geometry by hand.
#include "hil/inspect/space/space_job.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/input_error.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::inspect {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kRadius_mm = 0.25;

/// A level face x 0 … 40, and a side that hangs down at x = 40, with x along -Wy and y down.
std::vector<SpaceFace> boxFaces() {
  std::vector<SpaceFace> faces(2);
  faces[0].name = "top";
  faces[0].outline_F_mm = Eigen::AlignedBox2d(Vector2d(0.0, 0.0), Vector2d(40.0, 60.0));
  faces[1].name = "side";
  faces[1].X_WF.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  faces[1].X_WF.translation() = Vector3d(40.0, 60.0, 0.0);
  faces[1].outline_F_mm = Eigen::AlignedBox2d(Vector2d(0.0, 0.0), Vector2d(60.0, 30.0));
  return faces;
}

std::vector<ContourPoint> overTheEdge() {
  return {{Vector3d(20.0, 10.0, 0.0), Vector3d::UnitZ(), 1},
          {Vector3d(40.0, 30.0, 0.0), Vector3d::UnitX(), 2},
          {Vector3d(40.0, 45.0, -9.0), Vector3d::UnitX(), 3}};
}

TEST(SpaceJob, LinesLieInTheFacesOfTheirAxes) {
  const SpaceJob job = layContour(overTheEdge(), boxFaces(), 1.0, kRadius_mm, "c.xyz");
  ASSERT_EQ(job.lines.size(), 2U);
  EXPECT_EQ(job.lines[0].face, 0U);
  EXPECT_EQ(job.lines[1].face, 1U);
  EXPECT_LT((job.lines[1].from_F_mm - Vector2d(30.0, 0.0)).norm(), 1e-9);
  EXPECT_LT((job.lines[1].to_F_mm - Vector2d(15.0, 9.0)).norm(), 1e-9);
  EXPECT_EQ(job.lines[0].begin, LineEndKind::kFree);
  EXPECT_EQ(job.lines[0].end, LineEndKind::kFold);
  EXPECT_EQ(job.lines[1].begin, LineEndKind::kFold);
}

TEST(SpaceJob, AtAFoldTheOffsetEndsWhereItLeavesTheFace) {
  // At 45 degrees to the fold: left of the line it leaves r behind B, right of it r before.
  const double length_mm = 20.0 * std::sqrt(2.0);
  const SpaceJob left = layContour(overTheEdge(), boxFaces(), 1.0, kRadius_mm, "c.xyz");
  EXPECT_NEAR(left.lines[0].kerf_to_mm, length_mm + kRadius_mm, 1e-9);
  const SpaceJob right = layContour(overTheEdge(), boxFaces(), -1.0, kRadius_mm, "c.xyz");
  EXPECT_NEAR(right.lines[0].kerf_to_mm, length_mm - kRadius_mm, 1e-9);
  EXPECT_TRUE(planFace(left, 0).beyond.lines.empty());
  // What has no offset in the face is looked at as well, up to B.
  const FacePlan plan = planFace(right, 0);
  ASSERT_EQ(plan.beyond.lines.size(), 1U);
  EXPECT_NEAR(plan.beyond.from_mm[0], length_mm - kRadius_mm, 1e-9);
  EXPECT_NEAR(dieline::lengthOf(plan.beyond.dieline->entities[0].curve), kRadius_mm, 1e-9);
}

TEST(SpaceJob, AtACornerTheOffsetsMeet) {
  const std::vector<ContourPoint> corner{{Vector3d(10.0, 10.0, 0.0), Vector3d::UnitZ(), 1},
                                         {Vector3d(30.0, 10.0, 0.0), Vector3d::UnitZ(), 2},
                                         {Vector3d(30.0, 40.0, 0.0), Vector3d::UnitZ(), 3}};
  for (const double side : {1.0, -1.0}) {
    const SpaceJob job = layContour(corner, boxFaces(), side, kRadius_mm, "c.xyz");
    const FacePlan plan = planFace(job, 0);
    const Vector2d end = dieline::pointAt(plan.kerfs.dieline->entities[0].curve, 1.0);
    const Vector2d begin = dieline::pointAt(plan.kerfs.dieline->entities[1].curve, 0.0);
    EXPECT_LT((end - Vector2d(30.0 - side * kRadius_mm, 10.0 + side * kRadius_mm)).norm(), 1e-9);
    EXPECT_LT((end - begin).norm(), 1e-9);
  }
}

TEST(SpaceJob, ALineInNoFaceIsRefusedByItsLine) {
  std::vector<ContourPoint> contour = overTheEdge();
  contour[1].axis_W = Vector3d::UnitY();
  try {
    (void)layContour(contour, boxFaces(), 1.0, kRadius_mm, "c.xyz");
    FAIL() << "no fault";
  } catch (const base::InputError& e) {
    EXPECT_STREQ(e.what(), "c.xyz:2: the line that begins here lies in no face of the blank");
  }
}

}  // namespace
}  // namespace kerfbench::inspect
