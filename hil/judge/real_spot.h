// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "hil/inspect/inspect.h"
#include "hil/scenario/case.h"
#include "hil/source/vcd.h"
#include "hil/vision/image/camera_calibration.h"
#include "hil/vision/spot/spot_track.h"

namespace kerfbench::judge {

/// Below a results folder: the recording of the spot camera's frames.
inline constexpr const char* kSpotFrames = "spot";

/// What the recorded frames of a real spot camera show.
struct RealSpot {
  vision::SpotTrack track;            ///< On the clock of the pins; empty where that is not known.
  double clock_bound_s{};             ///< See Evidence.
  std::vector<std::string> problems;  ///< Each makes the verdict INVALID.
  std::string sha256;                 ///< Digest of the recording.
  std::vector<std::pair<std::string, std::string>> facts;  ///< For the report.
};

/// Relates the camera's clock to the pins' by the laser's gate and PWM (fitLightClock()) and tracks spot and
/// sheet while the laser works. Frames that are not to be believed are left out; those around cuts are told.
/// The result depends on nothing but what is given. `laser`: its gates and light alone. @throws ConfigError
/// for a recording that is none, or unfinished.
RealSpot lookAtRealSpot(const scenario::Case& test_case, const std::filesystem::path& folder,
                        const vision::CameraCalibration& calibration, const source::PinRecording& pins,
                        const inspect::Evidence& laser, int jobs);

}  // namespace kerfbench::judge
