// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "hil/vision/corner/corner_model.h"
#include "hil/vision/corner/corner_shape.h"

namespace kerfbench::vision {

/// The picture of a corner.
struct CornerPicture {
  PixelGrid grid;
  std::vector<float> gray;   ///< Grey in even light, row by row.
  std::vector<bool> counts;  ///< Pixels that the corner's own kerf alone makes.
  double noise_gray{};       ///< Standard deviation of a pixel of plain board.
};

/// Knowledge of a leg by other means than the picture.
struct KnownLeg {
  struct Point {
    double along_mm{}, offset_mm{};  ///< Place as in CornerLeg.
    double sigma_mm{};
  };
  std::vector<Point> points;
  double curvature_sigma_per_mm{0.5};  ///< Standard deviation of its curvature about zero.
  double twist_sigma_per_mm2{1.0};     ///< Standard deviation of its twist about zero.
};

/// Knowledge of a corner before its pixels are looked at.
struct CornerKnown {
  /// First guesses, at least one; all have the same nominal curves.
  std::vector<CornerShape> legs;
  CornerLight light;
  double blur_sigma_px{};                   ///< Standard uncertainty of light.blur_px.
  double radius_share_sigma{};              ///< Relative, of light.beam_radius_mm.
  double law_sigma{1.0}, begin_sigma{0.2};  ///< Standard uncertainty of light.growth.
  KnownLeg in, out;
};

/// A corner's parameters as fitted.
struct CornerFit {
  CornerShape shape;
  CornerLight light;
  /// Covariance of offset, slope, curvature and twist of the leg in, of the same of the leg out, and of the
  /// rounding, or of the overrun of both legs together and the excess of that of the leg in: mm, 1, 1/mm,
  /// 1/mm².
  Eigen::MatrixXd covariance;
  double scatter{};  ///< RMS of the residuals over the noise of the pixels.
  /// Legs that stop short of each other look much like an arc: the arc, where it cannot be ruled out.
  std::optional<CornerShape> other;

  /// Shape for a deviation of the parameters, in the covariance's order.
  [[nodiscard]] CornerShape shapeAt(const Eigen::VectorXd& change) const;
};

/// Least squares over all pixels that count, from a first guess of legs and light: once with an arc and once
/// with legs that end where they will; the better of the two. nullopt if neither comes to rest, or if there
/// are too few pixels.
std::optional<CornerFit> fitCorner(const CornerPicture& picture, const CornerKnown& known);

}  // namespace kerfbench::vision
