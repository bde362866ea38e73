// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Core>

namespace kerfbench::calibrate {

/// Resolutions are in dots an inch.
inline constexpr double kMmPerInch = 25.4;

/// Map of a flatbed scanner from pixels to millimetres on its glass.
///
/// The sensor bar lies along u, the carriage takes it along v. The bar is never the same as long and as
/// straight as it should be, but always the same bar; the carriage is not always at the height of its row,
/// nor straight ahead, but each time in the same way. So with u and v the pixel, from 0 at the picture's
/// first centre,
///
///     p_G = A (u, v) + bar(u) + carriage(v)
///
/// A has both scales and the skew between them; bar is a polynomial (Legendre, degree 2 … kBarDegree),
/// carriage a cubic B-spline over even knots of which A's part is taken out by its prior alone. Frame G lies
/// on the glass, x along u and y against v, so that the picture shows it as a map does; its origin is that of
/// pixel (0, 0) without bar and carriage.
struct ScannerMap {
  static constexpr int kBarDegree = 5;
  static constexpr int kBar = kBarDegree - 1;  ///< Number of its functions.

  int width_px{}, height_px{};                             ///< Size of the picture of the whole glass.
  Eigen::Matrix2d mm_per_px{Eigen::Matrix2d::Identity()};  ///< A; about diag(pitch, -pitch).
  Eigen::Matrix<double, 2, kBar> bar_mm{Eigen::Matrix<double, 2, kBar>::Zero()};
  Eigen::Matrix2Xd carriage_mm;  ///< A column for each B-spline; none: the carriage is true.

  /// A scanner of which nothing is known but its resolution.
  static ScannerMap ofResolution(int width_px, int height_px, double dpi);

  [[nodiscard]] Eigen::Vector2d glassFromPixel(const Eigen::Vector2d& pixel) const;
  /// Inverse, to 1e-6 px; the map is nearly linear.
  [[nodiscard]] Eigen::Vector2d pixelFromGlass(const Eigen::Vector2d& p_G_mm) const;
  /// Mean of both scales, mm.
  [[nodiscard]] double pitchMm() const;

  /// Values of bar's functions at u, and of the B-splines at v.
  [[nodiscard]] Eigen::Matrix<double, kBar, 1> barAt(double u_px) const;
  [[nodiscard]] Eigen::VectorXd carriageAt(double v_px) const;
};

/// A scanner's calibration as it is kept.
struct ScannerCalibration {
  std::string scanner_id;
  std::string date;  ///< ISO 8601 day of the scan of the target.
  double dpi{};      ///< Resolution that was asked of it.
  ScannerMap map;
  double rms_mm{};    ///< RMS of what the corners leave, per axis.
  double map_u_mm{};  ///< Largest standard uncertainty of a place between corners, per axis.
  std::size_t corners{};
};

}  // namespace kerfbench::calibrate
