// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/scanner/scanner_map.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace kerfbench::calibrate {
ScannerMap ScannerMap::ofResolution(int width_px, int height_px, double dpi) {
  ScannerMap map;
  map.width_px = width_px;
  map.height_px = height_px;
  map.mm_per_px = (kMmPerInch / dpi) * Eigen::Vector2d(1.0, -1.0).asDiagonal().toDenseMatrix();
  return map;
}

Eigen::Matrix<double, ScannerMap::kBar, 1> ScannerMap::barAt(double u_px) const {
  const double t = 2.0 * u_px / std::max(1, width_px - 1) - 1.0;
  Eigen::Matrix<double, kBar, 1> values;
  double before = 1.0, now = t;
  for (int degree = 2; degree <= kBarDegree; ++degree) {
    const double next = ((2 * degree - 1) * t * now - (degree - 1) * before) / degree;
    before = now;
    now = next;
    values[degree - 2] = now;
  }
  return values;
}

Eigen::VectorXd ScannerMap::carriageAt(double v_px) const {
  const Eigen::Index count = carriage_mm.cols();
  Eigen::VectorXd values = Eigen::VectorXd::Zero(count);
  if (count < 4) return values;
  // Even knots: count - 3 spans over the picture.
  const auto spans = static_cast<double>(count - 3);
  const double at = std::clamp(v_px / std::max(1, height_px - 1), 0.0, 1.0) * spans;
  const auto span = std::min<Eigen::Index>(static_cast<Eigen::Index>(at), count - 4);
  const double t = at - static_cast<double>(span), s = 1.0 - t;
  values.segment<4>(span) << s * s * s / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
      (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0, t * t * t / 6.0;
  return values;
}

Eigen::Vector2d ScannerMap::glassFromPixel(const Eigen::Vector2d& pixel) const {
  Eigen::Vector2d p = mm_per_px * pixel + bar_mm * barAt(pixel.x());
  if (carriage_mm.cols() > 0) p += carriage_mm * carriageAt(pixel.y());
  return p;
}

Eigen::Vector2d ScannerMap::pixelFromGlass(const Eigen::Vector2d& p_G_mm) const {
  constexpr int kSteps = 20;
  const Eigen::Matrix2d px_per_mm = mm_per_px.inverse();
  Eigen::Vector2d pixel = px_per_mm * p_G_mm;
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::Vector2d miss = px_per_mm * (p_G_mm - glassFromPixel(pixel));
    pixel += miss;
    if (miss.norm() < 1e-7) break;
  }
  return pixel;
}

double ScannerMap::pitchMm() const { return std::sqrt(std::abs(mm_per_px.determinant())); }

}  // namespace kerfbench::calibrate
