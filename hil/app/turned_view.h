// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "hil/app/head_setup.h"
#include "hil/calibrate/head/reversal.h"
#include "hil/calibrate/marks/mark_job.h"
#include "hil/vision/kerf_scan.h"

namespace kerfbench::hil {

/// A sheet as the camera sees it on its table T, laid turned about the middle of its printed marks.
struct TurnedView {
  SheetView marks;                                        ///< Places in T.
  Eigen::Isometry2d X_TS{Eigen::Isometry2d::Identity()};  ///< By its printed marks.
  std::size_t pictures{};                                 ///< Tiles that the view is made of.
  std::vector<std::string> remarks;
};

/// @throws HeadEvidenceError with every reason why the pictures must not be used.
TurnedView lookAt(TileSource& tiles, std::size_t pictures, const MarkJob& job, double turn_deg,
                  const HeadSetup& setup, int threads);

}  // namespace kerfbench::hil
