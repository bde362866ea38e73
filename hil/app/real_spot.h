// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "hil/app/case.h"
#include "hil/inspect/inspect.h"
#include "hil/source/vcd.h"
#include "hil/vision/camera_calibration.h"
#include "hil/vision/spot_track.h"

namespace kerfbench::hil {

/// What the recorded frames of a real spot camera show.
struct RealSpot {
  SpotTrack track;                    ///< On the clock of the pins; empty where that is not known.
  double clock_bound_s{};             ///< See Evidence.
  std::vector<std::string> problems;  ///< Each makes the verdict INVALID.
  std::vector<std::pair<std::string, std::string>> facts;  ///< For the report.
};

/// Relates the camera's clock to the pins' by the laser's gate and PWM (fitLightClock()) and tracks spot and
/// sheet while the laser works. Frames that are not to be believed are left out; those around cuts are told.
/// The result depends on nothing but what is given. @throws ConfigError for a recording that is none, or
/// unfinished.
RealSpot lookAtRealSpot(const Case& the_case, const std::filesystem::path& folder,
                        const CameraCalibration& calibration, const PinRecording& pins,
                        const std::vector<GateInterval>& gates, int jobs);

}  // namespace kerfbench::hil
