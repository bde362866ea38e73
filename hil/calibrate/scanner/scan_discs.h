// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "twin/base/image_fwd.h"

namespace kerfbench::calibrate {

/// A printed disc as a scan shows it.
struct ScanDisc {
  Eigen::Vector2d pixel{Eigen::Vector2d::Zero()};
  double radius_px{};
};

/// Grey of board and ink in a scan.
struct ScanLevels {
  double board{}, ink{};
};

/// Round, dark and filled places of these radii, by row. Dark is less than half of the board, which is the
/// median of the picture's middle; a kerf is no round place, nor is what a lid leaves dark around the sheet.
std::vector<ScanDisc> findScanDiscs(const GrayImage& scan, double least_radius_px, double most_radius_px);

/// Means over the discs: of their insides, and of rings around them. At least one disc.
ScanLevels levelsAt(const GrayImage& scan, const std::vector<ScanDisc>& discs);

}  // namespace kerfbench::calibrate
