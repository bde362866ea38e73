// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/video_device.h"

#include <cerrno>
#include <system_error>
#include <utility>

namespace kerfbench::camera {

void throwVideoError(int error, const std::string& path, const char* name) {
  throw std::system_error(error, std::generic_category(), path + ": " + name);
}

VideoDevice::VideoDevice(VideoCalls& calls, std::string path)
    : calls_(&calls), path_(std::move(path)), fd_(calls.open(path_), {&calls}) {
  if (!fd_.valid()) throwVideoError(errno, path_, "open");
}

int VideoDevice::request(unsigned long code, void* argument) {
  for (;;) {
    if (calls_->ioctl(fd_.get(), code, argument) >= 0) return 0;
    if (errno != EINTR) return errno;
  }
}

void VideoDevice::require(unsigned long code, void* argument, const char* name) {
  if (const int error = request(code, argument); error != 0) throwVideoError(error, path_, name);
}

std::string controlKey(const std::string& name) {
  std::string key;
  for (const char c : name) {
    const bool is_upper = c >= 'A' && c <= 'Z';
    const bool is_word = is_upper || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (is_word) {
      key += is_upper ? static_cast<char>(c - 'A' + 'a') : c;
    } else if (!key.empty() && key.back() != '_') {
      key += '_';
    }
  }
  if (!key.empty() && key.back() == '_') key.pop_back();
  return key;
}

}  // namespace kerfbench::camera
