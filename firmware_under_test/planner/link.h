// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "firmware_under_test/planner/plan.h"

namespace kerfbench::planner {

/// The host half of protocol.h as a pure state machine: bytes and time in, bytes out. Says HELLO until answered,
/// then CONFIG, fills the queue, START, keeps the queue full, waits for DONE.
class Link {
 public:
  enum class State { kConnecting, kConfiguring, kLoading, kRunning, kDone, kFailed };
  explicit Link(Program program);

  /// Bytes from the controller and the time now (virtual seconds); returns bytes for it.
  std::vector<std::uint8_t> step(std::span<const std::uint8_t> received, double now_s);

  [[nodiscard]] State state() const;
  /// One sentence for people: why it failed, or how far it is.
  [[nodiscard]] std::string message() const;
  /// Share of the program sent, 0 … 1.
  [[nodiscard]] double progress() const;

 private:
  Program program_;
  // state
};

}  // namespace kerfbench::planner
