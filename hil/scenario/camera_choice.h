// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hil/base/yaml_reader.h"
#include "hil/camera/v4l2/camera_settings.h"
#include "hil/camera/v4l2/device_list.h"

namespace kerfbench::scenario {

/// A real camera as a scenario names it (`cameras: {spot: {source: v4l2, …}}`). Size and calibration are the
/// machine file's.
struct SpotCameraChoice {
  bool is_real{};      ///< False: the twin's camera, and the other fields mean nothing.
  std::string device;  ///< Path of the device, its name by the driver, or its bus.
  camera::CameraSettings settings;
  double lit_s{};  ///< Time for which light falls on a frame: the exposure, or a strobe that is shorter.
  bool is_triggered{};
  bool sensor_has_noise{true};
  double stamp_jitter_s{};  ///< A stamp is off by at most this.
  double light_error_s{};   ///< The laser's light begins and ends at most so long after its gate.
  double max_clock_s{};     ///< The camera's clock must be known at least as well.
  std::map<std::string, std::string> places;  ///< Setting to "file:line: cameras.spot.key".
  std::string place;                          ///< Place of the device.
};

/// Source of the kerf's pictures.
struct KerfCameraChoice {
  std::filesystem::path tiles;  ///< A folder with tiles.yaml; empty: the twin takes them.
  std::string place;            ///< "file:line: cameras.kerf.folder", where there is one.
};

struct CameraChoice {
  SpotCameraChoice spot;
  KerfCameraChoice kerf;
};

/// Reads the choice; faults go to the reader.
CameraChoice readCameraChoice(base::YamlReader cameras);

/// Path of the device that a scenario names. @throws ConfigError with file and line: no such camera, or
/// several.
std::string findCamera(const SpotCameraChoice& choice, std::span<const camera::CameraListing> cameras);

/// Settings that the device refused or changed, one fault a line with file and line; empty: nothing.
std::string faultsOf(const SpotCameraChoice& choice, std::span<const camera::SettingFault> faults);
std::string faultsOf(const SpotCameraChoice& choice, const camera::CameraSetup& setup);

}  // namespace kerfbench::scenario
