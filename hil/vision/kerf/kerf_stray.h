// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hil/vision/kerf/kerf_plan.h"
#include "hil/vision/kerf/kerf_tiles.h"

namespace kerfbench::vision {

/// A bright blob off the dieline, as a box in S.
struct StrayBox {
  Eigen::AlignedBox2d box_S_mm;
  std::size_t tile{};
};

/// Bright blobs of one tile that are farther from the dieline than half a usual kerf and its error.
std::vector<StrayBox> findStrays(const TileView& view, std::size_t tile, const CameraCalibration& calibration,
                                 const PlaneMotion& X_TS, const std::vector<EntityPlan>& plans,
                                 double open_gray);

/// Stray cuts in order of place. A blob seen in tiles that overlap counts once; blobs shorter than least_mm
/// are left out.
std::vector<StrayCut> mergeStrays(std::vector<StrayBox> boxes, int unit, double least_mm);

}  // namespace kerfbench::vision
