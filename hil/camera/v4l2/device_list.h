// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <system_error>
#include <vector>

#include "hil/camera/v4l2/video_calls.h"

namespace kerfbench::camera {

/// Frame intervals at one size: one (shortest = longest), or a range.
struct IntervalListing {
  double shortest_s{};
  double longest_s{};
};

/// A size that a driver offers in a format: one, or a range in steps.
struct SizeListing {
  int width_px{}, height_px{};          ///< The only one, or the smallest.
  int max_width_px{}, max_height_px{};  ///< Equal to the above for the only one.
  int step_width_px{}, step_height_px{};
  std::vector<IntervalListing> intervals;  ///< Rates at the largest size; empty where the driver lists none.
};

struct FormatListing {
  std::string fourcc;
  std::string description;  ///< Description by the driver.
  bool is_readable{};       ///< True where decodeFrame() reads the format.
  std::string cost;         ///< PixelFormat::cost; empty where the format cannot be read.
  std::vector<SizeListing> sizes;
};

struct ControlListing {
  std::uint32_t id{};
  std::string name;  ///< The driver's.
  std::string key;   ///< Name of the control in a setting; see controlKey().
  std::int64_t min{}, max{}, step{}, fallback{};
  std::int64_t value{};
  bool has_value{};               ///< False where it cannot be read (a button, say).
  bool is_locked{};               ///< Read-only, disabled, or inactive for another control's sake.
  std::vector<std::string> menu;  ///< "0: Auto Mode" …
};

/// One /dev/video*.
struct CameraListing {
  std::string path;
  /// Reason why nothing more is known (no permission, say, and what to do), or empty.
  std::string problem;
  std::string card, driver, bus;
  bool captures{};  ///< Gives pictures, by the means that the bench uses (streaming).
  std::vector<FormatListing> formats;
  std::vector<ControlListing> controls;
};

/// All video devices of this machine, those that cannot be opened included. Changes no setting. Never throws
/// for a device's sake: what it refuses is missing or named in `problem`.
std::vector<CameraListing> listCameras(VideoCalls& calls);

/// Reason why a device cannot be used, and what to do, in words.
std::string problemOf(const std::system_error& error);

/// A listing in lines for people.
std::string describe(const CameraListing& camera);

}  // namespace kerfbench::camera
