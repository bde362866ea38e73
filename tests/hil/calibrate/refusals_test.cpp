// SPDX-License-Identifier: Apache-2.0
// Views that make no calibration.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <memory>

#include <opencv2/imgproc.hpp>

#include "hil/calibrate/camera/calibrate_camera.h"
#include "tests/hil/calibrate/small_camera.h"
#include "twin/base/image.h"
#include "twin/camera/target_camera.h"

namespace kerfbench::calibrate {
namespace {

using testing::HasSubstr;

std::string faultsOf(const CalibrationJob& job) {
  try {
    (void)calibrateCamera(job);
  } catch (const CalibrationError& e) {
    return e.what();
  }
  return {};
}

class Refusals : public testing::Test {
 protected:
  /// Job of the small camera with one view changed.
  static CalibrationJob with(std::size_t view, const std::function<GrayImage(GrayImage)>& change) {
    CalibrationJob job = test::smallJob(1, 3);
    job.picture = [good = job.picture, view, change](std::size_t v) {
      return v == view ? change(good(v)) : good(v);
    };
    return job;
  }
  /// Change of every pixel by a function of its grey.
  static std::function<GrayImage(GrayImage)> byGray(const std::function<double(double)>& change) {
    return [change](GrayImage image) {
      for (std::uint8_t& pixel : image.pixels)
        pixel = static_cast<std::uint8_t>(std::clamp(change(pixel), 0.0, 255.0));
      return image;
    };
  }
};

TEST_F(Refusals, TheJobItselfIsGood) { EXPECT_EQ(faultsOf(test::smallJob(1, 3)), ""); }

TEST_F(Refusals, TooFewViews) {
  EXPECT_THAT(faultsOf(test::smallJob(1, 2)), HasSubstr("3 views are too few"));
}

TEST_F(Refusals, NoViews) {
  CalibrationJob job = test::smallJob(1, 3);
  job.views.clear();
  EXPECT_THAT(faultsOf(job), HasSubstr("0 views are too few"));
}

TEST_F(Refusals, AFirstViewThatDoesNotCoverThePictureAndWhere) {
  const twin::CameraDescription camera = test::smallCamera();
  camera::TwinViews views = camera::twinViews(camera, camera::targetOf(camera), 3);
  // The target moves to the picture's right: the left stays bare.
  views.X_CB[0].translation().x() += 22.0;
  CalibrationJob job = test::smallJob(1, 3);
  camera::setTwinViews(camera, views, 1, job);
  const std::string faults = faultsOf(job);
  EXPECT_THAT(faults, HasSubstr("view 0: the target does not cover the picture"));
  EXPECT_THAT(faults, HasSubstr("left"));
  EXPECT_EQ(faults.find("right"), std::string::npos) << faults;
}

TEST_F(Refusals, ViewsThatAreAllParallel) {
  const twin::CameraDescription camera = test::smallCamera();
  camera::TwinViews views = camera::twinViews(camera, camera::targetOf(camera), 4);
  for (std::size_t v = 1; v < views.X_CB.size(); ++v) {
    views.X_CB[v] = views.X_CB[0];
    views.X_CB[v].translation() += Eigen::Vector3d(1.0, 2.0, 10.0) * static_cast<double>(v);
  }
  CalibrationJob job = test::smallJob(1, 3);
  camera::setTwinViews(camera, views, 1, job);
  EXPECT_THAT(faultsOf(job), HasSubstr("tilt"));
}

TEST_F(Refusals, APictureThatIsDarkSaturatedOrEmpty) {
  EXPECT_THAT(faultsOf(with(1, byGray([](double g) { return 0.2 * g; }))), HasSubstr("view 1: too dark"));
  EXPECT_THAT(faultsOf(with(2, byGray([](double g) { return 1.5 * g; }))), HasSubstr("view 2: saturated"));
  EXPECT_THAT(faultsOf(with(0, byGray([](double g) { return 110.0 + 0.05 * g; }))),
              HasSubstr("view 0: empty"));
  EXPECT_THAT(faultsOf(with(3, byGray([](double) { return 0.0; }))), HasSubstr("view 3: too dark"));
}

TEST_F(Refusals, ABlurredPicture) {
  const CalibrationJob job = with(2, [](GrayImage image) {
    cv::Mat picture(image.height, image.width, CV_8UC1, image.pixels.data());
    cv::GaussianBlur(picture, picture, {}, 4.0);
    return image;
  });
  EXPECT_THAT(faultsOf(job), HasSubstr("view 2: blurred"));
}

TEST_F(Refusals, APictureWithoutTheTarget) {
  // The bars are as bright and as sharp as a target.
  const CalibrationJob job = with(1, [](GrayImage image) {
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) image.at(x, y) = (x / 20) % 2 == 0 ? 30 : 200;
    }
    return image;
  });
  EXPECT_THAT(faultsOf(job), HasSubstr("view 1: the target is not found"));
}

TEST_F(Refusals, AMirroredPicture) {
  const CalibrationJob job = with(1, [](GrayImage image) {
    for (int y = 0; y < image.height; ++y) std::ranges::reverse(image.row(y));
    return image;
  });
  EXPECT_THAT(faultsOf(job), HasSubstr("view 1: the target is not found"));
}

TEST_F(Refusals, APictureOfAnotherSizeOrThatCannotBeRead) {
  EXPECT_THAT(faultsOf(with(1, [](const GrayImage&) { return GrayImage(640, 480, 100); })),
              HasSubstr("view 1: is 640 x 480 pixels, the camera's pictures have 560 x 440"));
  EXPECT_THAT(
      faultsOf(with(2, [](const GrayImage&) -> GrayImage { throw std::invalid_argument("is torn"); })),
      HasSubstr("view 2: is torn"));
}

TEST_F(Refusals, ATargetThatIsNotAsDescribed) {
  // The target is wound about a tube of 2.5 m: its middle stands off by 0.2 mm.
  const CalibrationJob job = with(1, [](GrayImage image) {
    const GrayImage flat = image;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const double shifted = x + 1.5 * std::pow((y - 220.0) / 220.0, 2);
        const int left = std::clamp(static_cast<int>(std::floor(shifted)), 0, image.width - 2);
        const double share = std::clamp(shifted - left, 0.0, 1.0);
        image.at(x, y) = static_cast<std::uint8_t>(
            std::lround((1.0 - share) * flat.at(left, y) + share * flat.at(left + 1, y)));
      }
    }
    return image;
  });
  EXPECT_THAT(faultsOf(job), HasSubstr("the target is not flat, not as described, or moved"));
}

TEST_F(Refusals, ResidualsAboveTheLimit) {
  CalibrationJob job = test::smallJob(1, 3);
  job.max_rms_px = 0.001;
  EXPECT_THAT(faultsOf(job), HasSubstr("at most 0.001"));
}

TEST_F(Refusals, EverythingWrongIsListedAtOnce) {
  CalibrationJob job = with(1, byGray([](double) { return 0.0; }));
  job.picture = [dark = job.picture](std::size_t v) {
    return v == 2 ? GrayImage(16, 16, 9) : v == 3 ? GrayImage(560, 440, 255) : dark(v);
  };
  job.camera_id.clear();
  job.date = "yesterday";
  job.place.p_PB_mm.x() = std::numeric_limits<double>::quiet_NaN();
  const std::string faults = faultsOf(job);
  for (const char* part : {"camera has no id", "'yesterday' is no day", "not finite", "view 1: too dark",
                           "view 2: is 16 x 16", "view 3: saturated"})
    EXPECT_THAT(faults, HasSubstr(part));
  job.target.square_mm = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(faultsOf(job), HasSubstr("square_mm"));
}

}  // namespace
}  // namespace kerfbench::calibrate
