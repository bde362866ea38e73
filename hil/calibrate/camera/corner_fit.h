// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "twin/base/image_fwd.h"

namespace kerfbench::calibrate {

/// Knowledge of a chessboard corner before it is fitted.
struct CornerGuess {
  Eigen::Vector2d pixel;    ///< Place of the corner, within about a pixel.
  Eigen::Vector2d along_x;  ///< Picture of the target's x axis there; any length.
  Eigen::Vector2d along_y;  ///< Direction of its y axis.
  int radius_px{};          ///< The window's half side; nothing but the four squares may lie in it.
};

/// Two straight edges that cross, blurred.
struct TargetCornerFit {
  Eigen::Vector2d pixel;
  double blur_px{};   ///< Standard deviation of the Gaussian blur, the pixel's own area included.
  double contrast{};  ///< White less black, grey levels.
  double noise{};     ///< RMS of what the fit leaves, grey levels.
  Eigen::Matrix2d covariance_px2{Eigen::Matrix2d::Zero()};  ///< Covariance of the place, by that noise.
};

/// Fits the corner by least squares: place, the two directions, blur, grey of both colours, and a light that
/// changes evenly over the window. The model is exact for straight edges at any angle under a Gaussian blur
/// (quadrant probability of a bivariate normal distribution; Drezner and Wesolowsky 1990), so that place has
/// no bias from where in its pixel the corner lies. Bright pixels that stand out are left out.
/// nullopt where the window leaves the picture, nothing like a corner is there or the fit does not settle.
std::optional<TargetCornerFit> fitCorner(const GrayImage& image, const CornerGuess& guess);

}  // namespace kerfbench::calibrate
