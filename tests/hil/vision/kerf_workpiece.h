// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "hil/dieline/geometry.h"
#include "hil/vision/kerf/kerf_measurement.h"
#include "tests/hil/vision/synthetic.h"

namespace kerfbench::vision::test {

inline constexpr double kPitchMm = 0.03;
inline constexpr double kBoard = 28.0;
inline constexpr double kOpen = 235.0;
inline constexpr double kCrease = 81.0;
inline constexpr double kInk = 5.0;
inline constexpr double kLensPx = 0.7;
inline constexpr double kWidthMm = 0.21;

dieline::Curve line(const Eigen::Vector2d& a, const Eigen::Vector2d& b);

/// A unit with lines in many directions, arcs, a circle and a crease; 40 x 26 mm.
dieline::Dieline manyDirections();

PrintLayout marksAtCorners(int units = 1);

/// True cut of an entity: its kerf's shift along the left normal, and so on.
struct Truth {
  double offset_mm{};
  double width_mm{kWidthMm};
  double gray{kOpen};
  bool cut{true};
  double gap_begin_mm{1e9};  ///< Arc length where the cut is missing.
  double gap_end_mm{-1e9};
};

struct Workpiece {
  CameraCalibration camera = tiltedCamera(900, 700, kPitchMm);
  PrintLayout print = marksAtCorners();
  dieline::Dieline dieline = manyDirections();
  std::map<int, Truth> truth;
  std::vector<dieline::Curve> extra;  ///< Cuts that are not in the dieline.
  Eigen::Vector2d shift_mm{0.83, -0.61};
  double angle_rad{0.5 * 3.14159265358979 / 180.0};
  KerfScanOptions options;

  [[nodiscard]] Eigen::Vector2d tableFromSheet(const Eigen::Vector2d& p) const {
    return shift_mm + Eigen::Vector2d(std::cos(angle_rad) * p.x() - std::sin(angle_rad) * p.y(),
                                      std::sin(angle_rad) * p.x() + std::cos(angle_rad) * p.y());
  }
  [[nodiscard]] Eigen::Vector2d sheetFromTable(const Eigen::Vector2d& q) const {
    const Eigen::Vector2d d = q - shift_mm;
    return {std::cos(angle_rad) * d.x() + std::sin(angle_rad) * d.y(),
            -std::sin(angle_rad) * d.x() + std::cos(angle_rad) * d.y()};
  }

  void drawKerf(Canvas& canvas, const Eigen::Vector2d& p_TV, const dieline::Curve& curve,
                const Truth& t) const;
  [[nodiscard]] std::vector<camera::KerfTile> tiles(int unit = 0) const;
  [[nodiscard]] KerfScan scan(std::vector<camera::KerfTile> some) const;
};

}  // namespace kerfbench::vision::test
