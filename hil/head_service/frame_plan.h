// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/calibrate/marks/mark_job.h"
#include "hil/vision/image/camera_calibration.h"

namespace kerfbench::head_service {

/// A picture that is expected of a sheet.
struct ExpectedFrame {
  std::string file;
  Eigen::Vector2d p_TV_mm{Eigen::Vector2d::Zero()};  ///< Place of the camera on its table.
  Eigen::AlignedBox2d shows_mm;  ///< Part of the sheet that it shows, in S, if the sheet lies as supposed.
};

/// Pictures that show a sheet as a whole, printed marks included, row by row to and fro. It is supposed that
/// the sheet lies with its origin where the table reads (0, 0), axes parallel, within 2 mm. Neighbours
/// overlap, so that one of them shows each mark's arms whole.
std::vector<ExpectedFrame> expectedFrames(const calibrate::MarkJob& job,
                                          const vision::CameraCalibration& camera);

/// `tiles.yaml` of these pictures with what has to be known of each, as comments: to be kept as it is if the
/// camera stood there, else to be corrected.
std::string tilesTemplate(const calibrate::MarkJob& job, const vision::CameraCalibration& camera,
                          const std::vector<ExpectedFrame>& frames);

/// Pictures that a folder's tiles.yaml names, and what is there of them. @throws ConfigError for a list that
/// cannot be read.
struct FolderOfFrames {
  std::vector<std::string> missing;  ///< Named, not there.
  std::vector<std::string> unnamed;  ///< Pictures that the list does not name.
  std::size_t named{};
  [[nodiscard]] bool none() const { return missing.size() == named; }
  [[nodiscard]] bool whole() const { return missing.empty(); }
};
FolderOfFrames framesIn(const std::filesystem::path& folder);
/// Pictures (PNG, JPEG) of a folder, by name.
std::vector<std::string> picturesIn(const std::filesystem::path& folder);

}  // namespace kerfbench::head_service
