// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "hil/base/exit_codes.h"

namespace kerfbench::instrument {

/// See calibrateCameraCommand() and calibrateTargetCommand().
struct CalibrateOptions {
  std::filesystem::path machine;
  std::string camera;                        ///< spot, kerf.
  std::vector<std::filesystem::path> views;  ///< Pictures, or folders of them; none: drawn by the twin.
  std::filesystem::path target;  ///< Description of the target; empty: the one that fits the camera.
  std::vector<double> origin_mm{0.0, 0.0};  ///< Origin of the target in the first view.
  double turn_deg{};
  std::string date;
  std::uint64_t seed{1};
  int tilted{9};  ///< Views of the twin besides the first.
  double max_rms_px{0.05};
  std::filesystem::path out;  ///< Empty: where the machine file looks for it.
  std::filesystem::path
      picture;  ///< Residual map; empty: named after machine and camera, in the current folder.
  std::filesystem::path save_views;  ///< Folder for the twin's pictures; empty: they are not kept.
  int columns{}, rows{};             ///< Columns and rows of a target to print; 0: as fits the camera.
  double square_mm{};
  int jobs{1};
  bool quiet{};
};

/// Calibrates a camera from views of a target; writes the calibration and a residual map. Returns 0, or
/// base::kExitInput with everything that is wrong with the files or views on standard error, and nothing
/// written.
int calibrateCameraCommand(const CalibrateOptions& options);

/// Writes a target to print (SVG) and its description beside it (YAML). Returns 0 or base::kExitInput.
int calibrateTargetCommand(const CalibrateOptions& options);

}  // namespace kerfbench::instrument
