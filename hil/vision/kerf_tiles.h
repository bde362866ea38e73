// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/vision/camera_calibration.h"
#include "hil/vision/constellation.h"
#include "hil/vision/kerf_scan.h"
#include "hil/vision/mark_finder.h"

namespace kerfbench::hil {

/// A tile with what is needed to measure in it.
struct TileView {
  KerfTile tile;
  Eigen::Vector2d centre_T_mm{Eigen::Vector2d::Zero()};  ///< What the middle of the image sees.
  double half_diagonal_mm{};
  double board_gray{};
  double noise_gray{};
  std::vector<FoundMark> marks;  ///< In the camera's plane V.
};

/// Looks at board and marks.
TileView viewTile(KerfTile tile, const CameraCalibration& calibration,
                  const std::vector<double>& diameters_mm);

/// How one unit lies on the table.
struct UnitPlace {
  PlaneMotion X_TS;
  double residual_mm{};  ///< RMS of the marks; NaN with fewer than two.
  int marks{};
};

/// From the marks in the tiles, wherever on the table the unit lies. Faults are added to `problems`.
/// nullopt if the marks do not tell.
std::optional<UnitPlace> placeUnit(const std::vector<TileView>& tiles, int unit, const PrintLayout& print,
                                   const CameraCalibration& calibration, std::vector<std::string>& problems);

/// The tile that sees the point at least border_px inside its edge, with its middle nearest; nullptr if there
/// is none.
const TileView* bestTile(const std::vector<TileView>& tiles, const CameraCalibration& calibration,
                         const Eigen::Vector2d& p_T_mm, double border_px);

}  // namespace kerfbench::hil
