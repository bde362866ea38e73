// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "hil/vision/kerf_plan.h"
#include "hil/vision/kerf_tiles.h"

namespace kerfbench::hil {

/// Brightness across a curve; sample i lies at first_mm + i * step_mm along the left normal.
struct Profile {
  std::vector<double> gray;
  double first_mm{};
  double step_mm{};
  double noise_gray{};  ///< Of one sample, on the board.
};

/// Reads the profile of a station from the raw image: the mean of a few lines beside each other that follow
/// the curve. `stations` far ends limit the lines of an open curve.
void readProfile(const TileView& view, const CameraCalibration& calibration, const PlaneMotion& X_TS,
                 const Station& station, const EntityPlan& plan, double reach_mm, Profile& profile);

/// The kerf in a profile that lies nearest to the nominal place; sets found, offset, width and brightness.
void measureKerf(const Profile& profile, double open_gray, Caliper& caliper);

}  // namespace kerfbench::hil
