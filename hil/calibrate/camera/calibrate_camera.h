// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/calibrate/camera/target_finder.h"
#include "hil/calibrate/files/target.h"
#include "hil/vision/image/camera_calibration.h"
#include "twin/base/image.h"

namespace kerfbench::calibrate {

/// Views that make no calibration; what() has one line for each thing that is wrong.
class CalibrationError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Pose of the target on the plane P in the first view, face up: B's origin in P, and B's x axis turned from
/// Px about Pz. Taken as exact: what it is wrong shifts and turns P, and is not in the covariance.
struct TargetPlace {
  Eigen::Vector2d p_PB_mm{Eigen::Vector2d::Zero()};
  double turn_rad{};
};

struct CalibrationJob {
  CalibrationTarget target;
  TargetPlace place;
  int width_px{};  ///< Width that the pictures must have.
  int height_px{};
  /// 0: an entocentric lens. Else telecentric: the length that stands for the distance in its description, as
  /// CameraCalibration::telecentric_mm; any will do that is about the picture's width or more.
  double telecentric_mm{};
  std::string camera_id;
  std::string date;         ///< Date of the views, "2026-11-21".
  double max_rms_px{0.05};  ///< Residual of the corners per axis above which the target or the lens is not as
                            ///< modelled; (0, 10].
  std::vector<std::string> views;                      ///< Names; the first is the one in the plane.
  std::function<GrayImage(std::size_t view)> picture;  ///< May be called from several threads.
  int threads{1};
  /// Callback after each view is measured; one call at a time.
  std::function<void(std::size_t view)> done{};
};

struct CalibratedView {
  std::string name;
  std::vector<TargetCorner> corners;
  std::vector<Eigen::Vector2d> residuals_px;  ///< Seen less modelled, of each corner.
  double sigma_px{};                          ///< Standard deviation of a corner, per axis.
  double blur_px{};
  double tilt_rad{};  ///< Tilt of the target against that of the first view.
};

struct CameraCalibrationResult {
  vision::CameraCalibration calibration;
  std::vector<CalibratedView> views;
  std::size_t corners{};
  std::size_t outliers{};  ///< Corners left out because they do not fit with the others.
};

inline constexpr std::size_t kLeastViews = 4;

/// Calibrates a camera from views of one target: the corners of all views give the lens and every pose by one
/// bundle adjustment, the first view's pose gives the plane.
/// @throws CalibrationError with everything that is wrong: fewer than kLeastViews views; a picture of another
/// size, empty, dark, saturated or blurred; a target that is not found; a first view that leaves a cell of
/// the picture without a corner; pictures that cannot be had; views that are all parallel or do not fix the
/// lens; residuals above the limit; values that are not finite.
CameraCalibrationResult calibrateCamera(const CalibrationJob& job);

}  // namespace kerfbench::calibrate
