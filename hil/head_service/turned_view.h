// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "hil/calibrate/head/reversal.h"
#include "hil/calibrate/marks/mark_job.h"
#include "hil/camera/tile_source.h"
#include "hil/head_service/head_setup.h"

namespace kerfbench::head_service {

/// A sheet as the camera sees it on its table T, laid turned about the middle of its printed marks.
struct TurnedView {
  calibrate::SheetView marks;                             ///< Marks by their places in T.
  Eigen::Isometry2d X_TS{Eigen::Isometry2d::Identity()};  ///< Pose of the sheet, by its printed marks.
  std::size_t pictures{};                                 ///< Number of tiles of the view.
  std::vector<std::string> remarks;
};

/// @throws HeadEvidenceError with every reason why the pictures must not be used.
TurnedView lookAt(camera::TileSource& tiles, std::size_t pictures, const calibrate::MarkJob& job,
                  double turn_deg, const HeadSetup& setup, int threads);

}  // namespace kerfbench::head_service
