// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace kerfbench::run {

/// The bench's half of the talk with a controller over its UART: bytes and virtual time in, bytes out.
class Dialog {
 public:
  enum class State { kBusy, kDone, kFailed };
  virtual ~Dialog() = default;
  virtual std::vector<std::uint8_t> step(std::span<const std::uint8_t> received, double now_s) = 0;
  [[nodiscard]] virtual State state() const = 0;
  /// One sentence: how far it is, or why it failed.
  [[nodiscard]] virtual std::string message() const = 0;
  /// Once it is done: for how long no axis of the head may be pulsed before the run ends, s; 0 where the
  /// controller itself has said that it is at rest.
  [[nodiscard]] virtual double quiet_s() const { return 0.0; }
  /// What the controller said that is no fault and that people want to know of, in sentences.
  [[nodiscard]] virtual std::vector<std::string> remarks() const { return {}; }
};

}  // namespace kerfbench::run
