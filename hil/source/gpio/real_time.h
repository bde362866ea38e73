// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hil/source/gpio/system.h"

namespace kerfbench::source {

/// Real-time priority and locked memory for the thread that reads pins, as far as they are allowed, until it
/// is destroyed.
class RealTime {
 public:
  /// Just below the kernel's interrupt threads (50), without
  /// which there is nothing to read.
  static constexpr int kPriority = 49;

  explicit RealTime(std::shared_ptr<GpioSystem> system);
  ~RealTime() { system_->leaveRealTime(); }
  RealTime(const RealTime&) = delete;
  RealTime& operator=(const RealTime&) = delete;
  /// Rights that lack, what that costs, and how to grant them.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  std::shared_ptr<GpioSystem> system_;
  std::vector<std::string> notes_;
};

}  // namespace kerfbench::source
