// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/base/unique_fd.h"
#include "hil/camera/v4l2/video_calls.h"

namespace kerfbench::camera {

/// An open video device. Not movable: mappings and requests keep its address.
class VideoDevice {
 public:
  /// `calls` must outlive this. @throws std::system_error with the path.
  VideoDevice(VideoCalls& calls, std::string path);
  VideoDevice(const VideoDevice&) = delete;
  VideoDevice& operator=(const VideoDevice&) = delete;

  /// 0, or the errno of the refusal; an interrupted call is made again.
  int request(unsigned long code, void* argument);
  /// @throws std::system_error "PATH: NAME" unless it succeeds.
  void require(unsigned long code, void* argument, const char* name);

  [[nodiscard]] VideoCalls& calls() const { return *calls_; }
  [[nodiscard]] int fd() const { return fd_.get(); }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  VideoCalls* calls_;
  std::string path_;
  base::OwnedFd<base::SystemClose<VideoCalls*>> fd_;
};

/// @throws std::system_error "PATH: NAME".
[[noreturn]] void throwVideoError(int error, const std::string& path, const char* name);

/// Key of a control as v4l2-ctl spells it: "Exposure Time, Absolute" is exposure_time_absolute.
std::string controlKey(const std::string& name);

}  // namespace kerfbench::camera
