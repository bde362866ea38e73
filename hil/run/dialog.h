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
};

}  // namespace kerfbench::run
