// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace kerfbench::camera {

/// The system calls that a video device needs, one to one, so that a test can put a device of its own behind
/// them and reach every error. Failures are reported as by the calls: -1 (a null pointer for mmap) and errno.
class VideoCalls {
 public:
  virtual ~VideoCalls() = default;
  /// /dev/video* in order of their numbers; empty where there are none.
  virtual std::vector<std::string> nodes() = 0;
  /// Opens for reading and writing, not blocking.
  virtual int open(const std::string& path) = 0;
  virtual int close(int fd) = 0;
  virtual int ioctl(int fd, unsigned long request, void* argument) = 0;
  /// Shared, for reading.
  virtual void* mmap(std::size_t length, int fd, std::int64_t offset) = 0;
  virtual int munmap(void* address, std::size_t length) = 0;
  /// Polls one descriptor; what happened goes to *revents.
  virtual int poll(int fd, short events, short* revents, int timeout_ms) = 0;
  /// CLOCK_MONOTONIC, which most drivers stamp by.
  virtual std::int64_t monotonicNs() = 0;
};

/// The kernel's.
VideoCalls& kernelVideoCalls();

}  // namespace kerfbench::camera
