// SPDX-License-Identifier: Apache-2.0
#pragma once

// All pictures of one unit as one, for people. Private to hil/vision/scan.

#include "hil/vision/image/camera_calibration.h"
#include "hil/vision/kerf/kerf_measurement.h"
#include "hil/vision/kerf/kerf_tiles.h"
#include "hil/vision/marks/constellation.h"

namespace kerfbench::vision {

/// Which unit is shown, and how.
struct MosaicView {
  int unit{};
  PlaneMotion X_TS{};            ///< Sheet to table.
  Eigen::AlignedBox2d box_S_mm;  ///< What is shown; not empty.
  int longest_px{};              ///< Longest side of the picture; > 0.
};

/// Each of its pixels is the brightest of those of the tiles that it stands for, so that a kerf narrower than
/// a pixel stays visible; black where no tile sees the sheet. 32 levels of gray.
KerfMosaic mosaicOf(const TileIndex& tiles, const CameraCalibration& calibration, const MosaicView& view,
                    int threads);

/// How much of a unit is off: stations without a kerf, and the largest offset, in mm. For the choice of the
/// unit that is shown.
double badnessOf(const KerfScan& scan, int unit);

}  // namespace kerfbench::vision
