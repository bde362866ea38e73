// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hil/source/gpio/system.h"

namespace kerfbench::guest {

/// The real system with a record of all edges, and a first wait for edges that lasts as long as the test
/// wants: a reader that something else keeps from running.
class WatchedSystem final : public source::GpioSystem {
 public:
  explicit WatchedSystem(std::function<void()> before_first_wait = {})
      : before_first_wait_(std::move(before_first_wait)) {}

  source::KernelAnswer open(const std::string& path) override { return real_->open(path); }
  source::KernelAnswer control(int fd, unsigned long request, void* argument) override {
    return real_->control(fd, request, argument);
  }
  source::KernelAnswer read(int fd, std::span<std::byte> into) override;
  source::KernelAnswer poll(int fd, std::uint64_t timeout_ns, short& revents) override;
  void close(int fd) override { real_->close(fd); }
  std::uint64_t now_ns() override { return real_->now_ns(); }
  std::uint64_t threadTime_ns() override { return real_->threadTime_ns(); }
  source::KernelAnswer setRealTime(int priority) override { return real_->setRealTime(priority); }
  source::KernelAnswer lockMemory() override { return real_->lockMemory(); }
  void leaveRealTime() override { real_->leaveRealTime(); }

  /// Numbers of the edges as they came from the kernel.
  [[nodiscard]] const std::vector<std::uint32_t>& numbers() const { return numbers_; }
  /// Longest time from an edge's stamp until it was read.
  [[nodiscard]] std::uint64_t worstDelay_ns() const { return worst_delay_ns_; }

 private:
  std::shared_ptr<source::GpioSystem> real_ = source::linuxGpioSystem();
  std::function<void()> before_first_wait_;
  std::vector<std::uint32_t> numbers_;
  std::uint64_t worst_delay_ns_{};
};

/// Numbers of the kernel's threads that serve the interrupts of the bench's lines, in order of the lines.
std::vector<int> interruptThreads();

}  // namespace kerfbench::guest
