// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "hil/camera/v4l2/gray_decode.h"
#include "hil/camera/v4l2/video_device.h"
#include "twin/base/image.h"

namespace kerfbench::camera {

/// Settings that a camera is asked for. What is not set stays as the driver has it.
struct CameraSettings {
  const PixelFormat* format{};  ///< One of pixelFormats(); required.
  int width_px{};               ///< The whole picture's.
  int height_px{};
  /// Part of the picture that is read out (selection API: V4L2_SEL_TGT_CROP), so that a sensor can be faster
  /// than with all of its rows. Without it, a window that another program has left is taken away.
  std::optional<PixelWindow> window{};
  int bits{0};  ///< Significant bits of Y16 and SxxxX16, 8 … 16; 0: all of the format's.
  /// Exposure of the shutter; the driver's own automatic is switched off. V4L2 counts it in 100 µs; what came
  /// of it is in the outcomes.
  std::optional<double> exposure_s{};
  std::optional<double> frame_rate_hz{};
  std::optional<std::int32_t> gain{};  ///< Gain in the driver's units; the automatic is switched off.
  /// Further controls by their keys (see controlKey()), set in this order after those above: V4L2 has no
  /// control of its own for an external trigger, so its driver's name for it stands here.
  struct Control {
    std::string key;
    std::int32_t value{};
  };
  std::vector<Control> controls{};
};

/// Outcome of one setting.
struct SettingOutcome {
  std::string setting;  ///< "exposure_s", "frame_rate_hz", "gain" or a control's key.
  double wanted{};
  double got{};  ///< Read back.
};

struct CameraSetup {
  FrameLayout layout;
  std::vector<SettingOutcome> outcomes;  ///< Outcomes in the order of CameraSettings.
  std::optional<double> frame_period_s;  ///< Period by the driver.
  std::optional<double> exposure_s;      ///< Exposure as read back, where it was asked for.
};

/// Settings that a device has not or refuses.
struct SettingFault {
  std::string setting;  ///< "format", "size", "bits", "window", or as in SettingOutcome.
  std::string words;
};

/// All of them; what() is "PATH: setting: fault; setting: fault; …".
class CameraSettingsError : public std::invalid_argument {
 public:
  CameraSettingsError(const std::string& path, std::vector<SettingFault> faults);
  [[nodiscard]] const std::vector<SettingFault>& faults() const { return faults_; }

 private:
  std::vector<SettingFault> faults_;
};

/// Sets format, size, frame rate and controls, and reads back what came of them.
/// @throws CameraSettingsError; std::system_error for a device that is none or has gone.
CameraSetup setUpCamera(VideoDevice& device, const CameraSettings& settings);

/// The size and layout that the device has now. @throws std::system_error.
FrameLayout currentLayout(VideoDevice& device, const CameraSettings& settings);

}  // namespace kerfbench::camera
