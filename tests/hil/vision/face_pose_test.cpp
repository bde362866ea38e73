// SPDX-License-Identifier: Apache-2.0
// Poses of a face against the model's, which is the truth: from pictures, through calibrations that are wrong
// as their certificates say.
#include "hil/vision/survey/face_pose.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hil/vision/survey/pose_solver.h"
#include "twin/base/image.h"
#include "twin/base/random.h"
#include "twin/five_axis/survey_picture.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Mode = Eigen::Matrix<double, CameraCalibration::kParameters, 1>;

/// Camera at a place that looks at W's origin.
twin::CameraDescription cameraAt(const Vector3d& place_mm) {
  twin::CameraDescription camera;
  camera.width_px = 700;
  camera.height_px = 600;
  camera.fx_px = camera.fy_px = 3000.0;
  camera.cx_px = 349.5;
  camera.cy_px = 299.5;
  camera.board_gray = 130.0;
  const Vector3d forward = -place_mm.normalized();
  const Vector3d right = forward.cross(Vector3d::UnitZ()).normalized();
  Eigen::Isometry3d X_WC = Eigen::Isometry3d::Identity();
  X_WC.linear() << right, forward.cross(right), forward;
  X_WC.translation() = place_mm;
  camera.X_CP = X_WC.inverse();
  return camera;
}

CameraCalibration certified(const twin::CameraDescription& camera, std::uint64_t seed) {
  CameraCalibration calibration;
  calibration.width_px = camera.width_px;
  calibration.height_px = camera.height_px;
  calibration.fx_px = camera.fx_px;
  calibration.fy_px = camera.fy_px;
  calibration.cx_px = camera.cx_px;
  calibration.cy_px = camera.cy_px;
  calibration.X_CP = camera.X_CP;
  const auto add = [&](Eigen::Index parameter, double sigma) {
    Mode mode = Mode::Zero();
    mode[parameter] = sigma;
    calibration.error_modes.push_back(mode);
  };
  for (const Eigen::Index k : {9, 10, 11}) add(k, 2e-5);
  for (const Eigen::Index k : {12, 13, 14}) add(k, 0.004);
  add(2, 0.05);
  const CounterRandom random(seed, 77);
  Mode error = Mode::Zero();
  for (std::size_t k = 0; k < calibration.error_modes.size(); ++k)
    error += random.normal(k) * calibration.error_modes[k];
  CameraCalibration wrong = calibration;
  wrong.error_modes.push_back(error);
  wrong = withMode(wrong, wrong.error_modes.size() - 1);
  wrong.error_modes.pop_back();
  return wrong;
}

class FacePoses : public testing::Test {
 protected:
  FacePoses() {
    print_.pitch_mm = 1e5;
    for (const Vector2d& p : {Vector2d(-25, -12), Vector2d(26, -14), Vector2d(-20, 15), Vector2d(24, 13)})
      print_.marks.push_back({p, 3.0});
    standing_.outline_F_mm = Eigen::AlignedBox2d(Vector2d(-33.0, -21.0), Vector2d(33.0, 21.0));
    standing_.print = print_;
    for (const Vector3d& place_mm : {Vector3d(180, 60, 220), Vector3d(-90, 170, 220)})
      cameras_.push_back(cameraAt(place_mm));
  }
  void stand(const Eigen::Isometry3d& X_WF) { standing_.X_WF = X_WF; }
  std::optional<FacePose> locate(std::uint64_t seed, std::size_t views = 2) {
    pictures_.clear();
    calibrations_.clear();
    for (std::size_t i = 0; i < views; ++i) {
      pictures_.push_back(twin::surveyPicture(cameras_[i], {standing_}, 100 * seed + 10 * i));
      calibrations_.push_back(certified(cameras_[i], 100 * seed + i));
    }
    std::vector<SurveyView> all;
    for (std::size_t i = 0; i < views; ++i) all.push_back({&calibrations_[i], &pictures_[i]});
    problems_.clear();
    ExpectedFace expected;
    expected.name = "lid";
    expected.print = &print_;
    expected.print_sigma_mm = 0.001;
    return locateFace(expected, all, problems_);
  }

  PrintLayout print_;
  twin::BlankFace standing_;
  std::vector<twin::CameraDescription> cameras_;
  std::vector<CameraCalibration> calibrations_;
  std::vector<GrayImage> pictures_;
  std::vector<std::string> problems_;
};

/// A small motion: some tenths of a millimetre, a third of a degree.
Eigen::Isometry3d stood(std::uint64_t seed) {
  const CounterRandom random(seed, 5);
  SmallMotion motion;
  for (Eigen::Index k = 0; k < 6; ++k)
    motion[k] = (k < 3 ? 0.005 : 0.3) * (2.0 * random.uniform(static_cast<std::uint64_t>(k)) - 1.0);
  return moved(motion, Vector3d::Zero(), Eigen::Isometry3d::Identity());
}

TEST_F(FacePoses, AreAsGoodAsTheyState) {
  int beyond = 0;
  int all = 0;
  double square = 0.0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    stand(stood(seed));
    const auto pose = locate(seed);
    ASSERT_TRUE(pose) << (problems_.empty() ? "" : problems_.front());
    for (const Vector3d& p_F : {Vector3d(-30, -18, 0), Vector3d(0, 0, 0), Vector3d(30, 18, 0)}) {
      const Vector3d p_W = pose->X_WF * p_F;
      const Vector3d error = p_W - standing_.X_WF * p_F;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        double variance = 0.0;
        for (const SmallMotion& mode : pose->modes) variance += std::pow(pose->shift(mode, p_W)[axis], 2);
        ++all;
        if (std::abs(error[axis]) > 2.0 * std::sqrt(variance)) ++beyond;
        square += error[axis] * error[axis] / variance / (12.0 * 9.0);
        EXPECT_LT(std::sqrt(variance), 0.02);
        EXPECT_LT(std::abs(error[axis]), 0.05);
      }
    }
  }
  // 108 errors, of which some dozen are independent: 4.6 % beyond, and a mean square of one.
  EXPECT_LE(beyond, all / 8);
  EXPECT_GT(square, 0.3);
  EXPECT_LT(square, 2.0);
}

TEST_F(FacePoses, AFaceThatIsTurnedByADegreeIsMeasuredSo) {
  Eigen::Isometry3d turned = Eigen::Isometry3d::Identity();
  turned.linear() = Eigen::AngleAxisd(0.0174533, Vector3d::UnitX()).toRotationMatrix();
  stand(turned);
  const auto pose = locate(3);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(Eigen::AngleAxisd(pose->X_WF.linear()).angle(), 0.0174533, 3e-4);
}

TEST_F(FacePoses, OneCameraIsNotEnough) {
  EXPECT_FALSE(locate(1, 1));
  ASSERT_EQ(problems_.size(), 4U);
  EXPECT_NE(problems_[0].find("face lid: mark 1 is found in 1 of 1"), std::string::npos);
}

TEST_F(FacePoses, AMarkThatIsNotThereIsMissed) {
  standing_.print.marks.pop_back();
  EXPECT_FALSE(locate(1));
  ASSERT_EQ(problems_.size(), 1U);
  EXPECT_NE(problems_[0].find("mark 4 is found in 0 of 2"), std::string::npos);
}

TEST_F(FacePoses, AMarkThatLiesElsewhereContradictsTheOthers) {
  standing_.print.marks[1].p_SM_mm += Vector2d(0.5, 0.3);
  EXPECT_FALSE(locate(1));
  ASSERT_EQ(problems_.size(), 1U);
  EXPECT_NE(problems_[0].find("px (RMS) off the best pose"), std::string::npos);
}

}  // namespace
}  // namespace kerfbench::vision
