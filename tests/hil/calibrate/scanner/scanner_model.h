// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include <Eigen/Core>

#include "hil/calibrate/files/target.h"
#include "hil/calibrate/marks/mark_job.h"
#include "twin/base/image.h"

namespace kerfbench::calibrate::test {

/// A flatbed scanner, and what it sees of a sheet or a target on its glass. It shares nothing with the kerf
/// camera's model: shapes are drawn by their distance from each pixel, and its light, its bar and its
/// carriage are its own.
///
/// A pixel (u, v) sees the place x = sx u + k v + bow, y = -(sy v + wave) of the glass, with a sensor bar
/// that is bowed (a parabola along u) and a carriage that wobbles along v in both directions.
struct ScannerModel {
  int width_px{1500}, height_px{1500};
  double pitch_mm{25.4 / 600.0};
  Eigen::Vector2d scale{1.0012, 0.9979};  ///< Along the bar, along the carriage's way.
  double skew_rad{1.1e-3};
  double bow_mm{0.03};      ///< Bow of the bar, at its ends.
  double wobble_mm{0.045};  ///< Wobble of the carriage, with a wave of 23 and one of 41 mm.
  double blur_px{0.7};
  double noise_gray{1.5};
  double board_gray{190.0}, ink_gray{35.0};
  double lid_gray{25.0};  ///< Black card; a white lid has 250.
  std::uint64_t seed{1};
  /// Turn of what lies on the glass, and where its origin lies from the picture's first pixel.
  double turn_rad{0.004};
  Eigen::Vector2d p_GS_mm{31.0, -31.0};

  [[nodiscard]] Eigen::Vector2d glassAt(const Eigen::Vector2d& pixel) const;
  /// A sheet with the job's print and its marks, cut where `head` puts them, kerfs `kerf_mm` wide.
  [[nodiscard]] GrayImage sheet(
      const MarkJob& job, double kerf_mm,
      const std::function<Eigen::Vector2d(const Eigen::Vector2d& p_S_mm)>& head) const;
  /// A target that covers the glass, its rows along the bar but for the turn.
  [[nodiscard]] GrayImage target(const CalibrationTarget& target) const;

 private:
  [[nodiscard]] Eigen::Vector2d onSheet(const Eigen::Vector2d& pixel) const;
  [[nodiscard]] std::uint8_t shown(double gray, std::size_t pixel) const;
};

}  // namespace kerfbench::calibrate::test
