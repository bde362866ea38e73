// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hil/vision/kerf/kerf_caliper.h"
#include "hil/vision/kerf/kerf_plan.h"
#include "hil/vision/kerf/kerf_profile.h"
#include "hil/vision/kerf/kerf_tiles.h"
#include "hil/vision/scan/sight_depth.h"

namespace kerfbench::vision {

/// The pictures of a sheet, and how one unit lies on it.
struct OverlapScene {
  const std::vector<TileView>& tiles;
  const TileIndex& index;
  const PlaneMotion& X_TS;
  const CameraCalibration& calibration;
  const KerfScanOptions& options;
};

/// Light in one tile across a station that has no other kerf near it, and the reading of that.
Profile loneProfile(const OverlapScene& scene, const TileView& view, const CaliperWindow& window);
KerfReading loneReading(const OverlapScene& scene, const TileView& view, const CaliperWindow& window);

/// Kerfs and printed marks that two tiles see: about each millimetre of kerf in the tile that is used for it
/// and in the one whose line of sight differs most across the kerf; each mark along x and along y, which lies
/// in the plane of the marks and so tells the tiles' shift alone.
std::vector<SightPair> sightPairs(const KerfPlan& plan, const OverlapScene& scene);

}  // namespace kerfbench::vision
