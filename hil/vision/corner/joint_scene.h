// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hil/vision/kerf/flank_belief.h"
#include "hil/vision/kerf/kerf_plan.h"
#include "hil/vision/kerf/kerf_tiles.h"

namespace kerfbench::vision {

/// Scene in which corners and ends are measured.
struct JointScene {
  const TileIndex* tiles{};
  const CameraCalibration* calibration{};
  const PlaneMotion* X_TS{};
  const KerfScanOptions* options{};
  const KerfPlan* plan{};
  const std::vector<EntityKerf>* kerfs{};  ///< Kerfs of the unit, in the plan's order.
  const FlankBelief* belief{};             ///< Light, beam and blur, by the flanks of all kerfs.
  int unit{};

  /// The tile that sees all within `reach_mm` of a point; nullptr if none does.
  [[nodiscard]] const TileView* tileFor(const Eigen::Vector2d& p_S_mm, double reach_mm) const;
  /// Gray of whole board around a point, in even light.
  [[nodiscard]] double boardAt(const TileView& view, const Eigen::Vector2d& p_S_mm) const;
  [[nodiscard]] const Station& stationAt(const EntityEnd& end) const;
  /// Arc length of an end on its entity.
  [[nodiscard]] double stationOf(const EntityEnd& end) const;
};

}  // namespace kerfbench::vision
