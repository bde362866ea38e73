// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include "hil/base/unique_fd.h"

namespace kerfbench::source {

/// Real pins that cannot be used, or no longer; what() says in words what to do.
class GpioError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Answer of the kernel: a value >= 0, or -1 and an errno.
struct KernelAnswer {
  int value{};
  int error{};
  [[nodiscard]] bool failed() const { return value < 0; }
};

/// The system calls of real pins, so that tests give every answer that a kernel can give.
class GpioSystem {
 public:
  virtual ~GpioSystem() = default;
  virtual KernelAnswer open(const std::string& path) = 0;
  virtual KernelAnswer control(int fd, unsigned long request, void* argument) = 0;
  virtual KernelAnswer read(int fd, std::span<std::byte> into) = 0;
  /// Waits for POLLIN, with a negative `fd` for the time alone; `revents` is what ppoll(2) says.
  virtual KernelAnswer poll(int fd, std::uint64_t timeout_ns, short& revents) = 0;
  virtual void close(int fd) = 0;
  /// CLOCK_MONOTONIC, which the kernel stamps edges with.
  virtual std::uint64_t now_ns() = 0;
  /// Processor time that the calling thread has used (CLOCK_THREAD_CPUTIME_ID).
  virtual std::uint64_t threadTime_ns() = 0;
  /// SCHED_FIFO at this priority for the calling thread.
  virtual KernelAnswer setRealTime(int priority) = 0;
  /// All pages that the process has now. Not those to come: where the limit is near, malloc() would fail.
  virtual KernelAnswer lockMemory() = 0;
  /// Back to SCHED_OTHER and unlocked pages.
  virtual void leaveRealTime() = 0;
};
/// The real ones.
std::shared_ptr<GpioSystem> linuxGpioSystem();

/// A file descriptor of such a system.
using GpioFd = base::OwnedFd<base::SystemClose<std::shared_ptr<GpioSystem>>>;

}  // namespace kerfbench::source
