// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "hil/base/unique_fd.h"
#include "tests/board/board.h"

namespace kerfbench::board {

/// Ports of a board on a chip of the kernel's gpio-sim, through its files below sysfs: outputs pull lines
/// ("…/sim_gpio4/pull"), inputs are the levels of lines that another program drives ("…/value"). The UART is
/// a terminal of the kernel's (pty).
class SimBoard final : public BoardPorts {
 public:
  /// Opens the ports. @throws std::system_error with the path.
  /// @param chip folder of the chip, as /sys/devices/platform/gpio-sim.0/gpiochip1.
  /// @param tty link to be made to the bench's end of the UART.
  SimBoard(const std::filesystem::path& chip, const std::map<Signal, unsigned>& lines,
           std::filesystem::path tty);
  ~SimBoard() override;
  SimBoard(const SimBoard&) = delete;
  SimBoard& operator=(const SimBoard&) = delete;

  std::uint64_t now_ns() override;
  void sleepUntil(std::uint64_t at_ns) override;
  bool level(Signal sensor) override;
  void put(Signal output, bool level) override;
  std::vector<std::uint8_t> receive() override;
  void send(std::span<const std::uint8_t> bytes) override;

 private:
  std::map<Signal, base::UniqueFd> files_;
  base::UniqueFd uart_;
  base::UniqueFd bench_end_;  ///< Kept open, so that the terminal does not hang up before the bench comes.
  std::filesystem::path tty_;
  std::vector<std::uint8_t> unsent_;
};

}  // namespace kerfbench::board
