// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/video_calls.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "hil/base/number_from.h"

namespace kerfbench::camera {
namespace {

class KernelVideoCalls final : public VideoCalls {
 public:
  std::vector<std::string> nodes() override {
    constexpr std::string_view kPrefix = "video";
    std::vector<std::pair<int, std::string>> found;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator("/dev", none)) {
      const std::string name = entry.path().filename().string();
      if (!name.starts_with(kPrefix)) continue;
      if (const auto number = base::numberFrom<int>(std::string_view(name).substr(kPrefix.size())))
        found.emplace_back(*number, entry.path().string());
    }
    std::ranges::sort(found);
    std::vector<std::string> paths;
    for (auto& [number, path] : found) paths.push_back(std::move(path));
    return paths;
  }
  int open(const std::string& path) override { return ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC); }
  int close(int fd) override { return ::close(fd); }
  int ioctl(int fd, unsigned long request, void* argument) override { return ::ioctl(fd, request, argument); }
  void* mmap(std::size_t length, int fd, std::int64_t offset) override {
    void* const address = ::mmap(nullptr, length, PROT_READ, MAP_SHARED, fd, offset);
    return address == MAP_FAILED ? nullptr : address;
  }
  int munmap(void* address, std::size_t length) override { return ::munmap(address, length); }
  int poll(int fd, short events, short* revents, int timeout_ms) override {
    pollfd one{fd, events, 0};
    const int count = ::poll(&one, 1, timeout_ms);
    *revents = one.revents;
    return count;
  }
  std::int64_t monotonicNs() override {
    timespec now{};
    (void)::clock_gettime(CLOCK_MONOTONIC, &now);
    return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
  }
};

}  // namespace

VideoCalls& kernelVideoCalls() {
  static KernelVideoCalls calls;
  return calls;
}

}  // namespace kerfbench::camera
