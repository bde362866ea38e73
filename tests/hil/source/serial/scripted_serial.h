// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "hil/source/serial/serial_system.h"

namespace kerfbench::source {

/// A scripted serial line. Each answer can be replaced; the first that is set wins.
class ScriptedSerial : public SerialSystem {
 public:
  // Answers of the line.
  int open_error{};
  int get_error{};
  int exclusive_error{};
  int set_error{};
  int flush_error{};
  int read_error{};   ///< Error of the next read.
  int write_error{};  ///< Error of the next write.
  bool hung_up{};
  std::uint32_t runs_at_baud{};  ///< Rate that is set instead of the requested one.
  std::size_t takes{1U << 20U};  ///< Bytes that the line's buffer has room for.
  std::deque<std::uint8_t> to_bench;

  // Record of the calls.
  std::string path;
  std::vector<std::uint8_t> from_bench;
  std::uint32_t baud{};
  std::uint32_t control_flags{};
  int lines_open{};  ///< Balance: +1 by open(), -1 by close().
  bool alone{};
  /// Called before each read().
  std::function<void()> before_read;

  SerialAnswer open(const std::string& which) override;
  SerialAnswer control(int fd, unsigned long request, void* argument) override;
  SerialAnswer read(int fd, std::span<std::byte> into) override;
  SerialAnswer write(int fd, std::span<const std::byte> bytes) override;
  void close(int fd) override;
};

}  // namespace kerfbench::source
