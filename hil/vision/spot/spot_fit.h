// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "hil/vision/image/brightness_scan.h"
#include "hil/vision/spot/spot_noise.h"
#include "twin/base/image_fwd.h"

namespace kerfbench::vision {

/// Printed disc as the fit of a nearby spot must know it.
struct DiscInPicture {
  Eigen::Vector2d pixel{Eigen::Vector2d::Zero()};
  Eigen::Matrix2d mm_per_pixel{Eigen::Matrix2d::Identity()};
  double radius_mm{};
  double contrast_gray{};  ///< Board minus ink, to start from.
};

/// A glowing spot in pixels: an elliptical Gaussian, or a round one that ran along a line during the
/// exposure.
struct SpotFit {
  Eigen::Vector2d pixel{Eigen::Vector2d::Zero()};           ///< Middle of the spot.
  Eigen::Matrix2d covariance_px2{Eigen::Matrix2d::Zero()};  ///< Covariance of the estimated centre.
  double long_sigma_px{};  ///< Standard deviation of the light along its longer axis.
  double short_sigma_px{};
  double
      height_gray{};  ///< Height of its brightest place above the board; more than 255 for a saturated spot.
  ShotEvidence shot;
  /// Influence of a pixel of the spot on its centre.
  struct Influence {
    int column{}, row{};
    Eigen::Vector2d by_gray{Eigen::Vector2d::Zero()};  ///< px / grey
    double brighter_gray{};                            ///< Than the board.
  };
  std::vector<Influence> influences;
};

/// Fits the spot at a peak: centre, shape, height, board, and the contrast of the discs given, by least
/// squares weighted with the noise of each pixel's own light, so that the centre is as good as the noise
/// lets any estimate be. Saturated pixels only say "at least that bright". nullopt for what is not a spot:
/// noise, a hot pixel, an edge.
std::optional<SpotFit> fitSpot(const GrayImage& image, const BrightPeak& peak, double board_gray,
                               const PixelNoise& noise, std::span<const DiscInPicture> discs = {});

/// The place on a printed disc that is brightest against what the print lets expect, if it stands out.
std::optional<BrightPeak> peakOnDisc(const GrayImage& image, const DiscInPicture& disc, double board_gray,
                                     double noise_gray);

/// Share of a pixel that the disc covers, with an edge as soft as a usual lens makes it.
double coverOf(const DiscInPicture& disc, const Eigen::Vector2d& pixel);

}  // namespace kerfbench::vision
