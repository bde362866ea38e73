// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hil/base/unique_fd.h"
#include "hil/source/serial/serial_system.h"

namespace kerfbench::source {

/// A controller's UART behind a serial line of this computer: 8 data bits, no parity, one stop bit, no flow
/// control, nothing translated, nobody else on it. Any baud rate (termios2, BOTHER), as 250 000 is none of
/// the old list.
class SerialLine {
 public:
  /// Largest error of the driver's nearest rate: half a bit in ten, shared by both ends.
  static constexpr double kMaxBaudError = 0.02;

  /// @throws SerialError: no such line, not allowed, no serial line, used by others, rate not to be had.
  SerialLine(std::shared_ptr<SerialSystem> system, std::string path, std::uint32_t baud);
  ~SerialLine();
  SerialLine(const SerialLine&) = delete;
  SerialLine& operator=(const SerialLine&) = delete;

  /// Queues bytes for the controller.
  void write(std::span<const std::uint8_t> bytes) {
    waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
  }
  /// Hands the line of the queue what it takes now, and appends what has come. Never waits.
  /// @throws SerialError when the line hangs up or fails.
  void pump(std::vector<std::uint8_t>& received);
  /// Throws away what has come.
  void discard();
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  using SerialFd = base::OwnedFd<base::SystemClose<std::shared_ptr<SerialSystem>>>;

  void configure(std::uint32_t baud);
  void allowOthers();
  void send();
  void receive(std::vector<std::uint8_t>& received);
  [[noreturn]] void fail(const std::string& what, int error) const;

  std::shared_ptr<SerialSystem> system_;
  std::string path_;
  SerialFd fd_;
  bool is_alone_{};
  std::vector<std::uint8_t> waiting_;
};

}  // namespace kerfbench::source
