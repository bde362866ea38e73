// SPDX-License-Identifier: Apache-2.0
// Pictures of a standing blank against projections by hand.
#include "twin/five_axis/survey_picture.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "twin/base/image.h"

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A camera 200 mm above W's origin that looks down, x to the right along Wx.
CameraDescription above() {
  CameraDescription camera;
  camera.width_px = 400;
  camera.height_px = 300;
  camera.fx_px = camera.fy_px = 1000.0;
  camera.cx_px = 199.5;
  camera.cy_px = 149.5;
  camera.board_gray = 130.0;
  camera.X_CP.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  camera.X_CP.translation() = Vector3d(0.0, 0.0, 200.0);
  return camera;
}

BlankFace faceAt(double z_mm, const Vector2d& min, const Vector2d& max) {
  BlankFace face;
  face.X_WF.translation().z() = z_mm;
  face.outline_F_mm = Eigen::AlignedBox2d(min, max);
  face.print.pitch_mm = 1e5;
  return face;
}

TEST(SurveyPicture, ShowsBoardWithinTheOutlineAndDarkBesideIt) {
  const GrayImage picture =
      surveyPicture(above(), {faceAt(0.0, Vector2d(-10.0, -10.0), Vector2d(20.0, 10.0))}, 1);
  // 1000 px / 200 mm: five pixels a millimetre.
  EXPECT_NEAR(picture.at(199, 149), 130, 12);
  EXPECT_NEAR(picture.at(199 + 95, 149), 130, 12);
  EXPECT_LT(picture.at(199 + 106, 149), 30);
  EXPECT_NEAR(picture.at(199 - 45, 149), 130, 12);
  EXPECT_LT(picture.at(199 - 56, 149), 30);
}

TEST(SurveyPicture, AMarkLiesWhereItsProjectionIs) {
  BlankFace face = faceAt(50.0, Vector2d(-30.0, -30.0), Vector2d(30.0, 30.0));
  face.print.marks.push_back({Vector2d(9.0, 6.0), 3.0});
  const GrayImage picture = surveyPicture(above(), {face}, 1);
  // At a distance of 150 mm: 199.5 + 1000 / 150 * 9, and y goes down.
  double dark = 0.0;
  Vector2d sum = Vector2d::Zero();
  for (int row = 60; row < 160; ++row) {
    for (int column = 200; column < 330; ++column) {
      const double ink = std::max(0.0, 110.0 - picture.at(column, row));
      dark += ink;
      sum += ink * Vector2d(column, row);
    }
  }
  ASSERT_GT(dark, 0.0);
  EXPECT_LT((sum / dark - Vector2d(259.5, 109.5)).norm(), 0.1);
}

TEST(SurveyPicture, TheNearerFaceHidesTheOneBehindItAndItsMarks) {
  BlankFace behind = faceAt(0.0, Vector2d(-30.0, -30.0), Vector2d(30.0, 30.0));
  behind.print.marks.push_back({Vector2d(0.0, 0.0), 3.0});
  const BlankFace before = faceAt(20.0, Vector2d(-5.0, -5.0), Vector2d(5.0, 5.0));
  EXPECT_LT(surveyPicture(above(), {behind}, 1).at(199, 149), 60);
  EXPECT_NEAR(surveyPicture(above(), {behind, before}, 1).at(199, 149), 130, 12);
}

TEST(SurveyPicture, OfAFaceFromBehindNothingIsSeen) {
  BlankFace face = faceAt(0.0, Vector2d(-30.0, -30.0), Vector2d(30.0, 30.0));
  face.X_WF.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  EXPECT_LT(surveyPicture(above(), {face}, 1).at(199, 149), 30);
}

TEST(SurveyPicture, RefusesALensThatBends) {
  CameraDescription camera = above();
  camera.distortion[0] = -0.1;
  EXPECT_THROW((void)surveyPicture(camera, {}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::twin
