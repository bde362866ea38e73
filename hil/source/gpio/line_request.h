// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hil/source/gpio/chip_lines.h"
#include "hil/source/gpio/system.h"

namespace kerfbench::source {

/// Edge as the kernel reports it.
struct KernelEdge {
  std::uint64_t stamp_ns{};    ///< CLOCK_MONOTONIC, taken in the interrupt.
  std::size_t line{};          ///< Index among the lines that were asked for.
  bool level{};                ///< Level after the edge; on a late interrupt thread that of a later edge.
  std::uint32_t seqno{};       ///< Among all edges of the request, from 1; counted in the interrupt.
  std::uint32_t line_seqno{};  ///< Among those of the line, from 1; counted in the interrupt's thread.
};

/// Edges that the kernel keeps for a reader that is late: the most that it grants (16 for each of 64).
inline constexpr std::uint32_t kEventBuffer = 1024;

/// Lines of one chip as inputs with both edges, in one request of the kernel's second interface
/// (linux/gpio.h): libgpiod 1.6 speaks the first, which drops edges without a word.
///
/// One request for all lines, because only then the kernel numbers edges in the interrupt itself, so that two
/// edges which became one before its thread ran leave a gap.
class LineRequest {
 public:
  /// @throws GpioError: chip missing, no gpiochip, not allowed, kernel without the second interface, line
  /// beyond the chip or taken (and by whom), fewer than two lines.
  LineRequest(std::shared_ptr<GpioSystem> system, const std::filesystem::path& chip,
              std::vector<ChipLine> lines);

  /// Edges that one read() takes; fewer: the kernel had no more.
  static constexpr std::size_t kMostAtOnce = 64;
  /// Waits up to `timeout` for edges and appends what there is, kMostAtOnce at most; false: none came.
  /// @throws GpioError when the chip has gone, or what the kernel says makes no sense.
  bool read(std::chrono::nanoseconds timeout, std::vector<KernelEdge>& edges);
  /// Levels of all lines now. @throws GpioError as read().
  std::vector<bool> levels();
  [[nodiscard]] const std::vector<ChipLine>& lines() const { return lines_; }

 private:
  void request();
  [[noreturn]] void gone(int error) const;

  std::shared_ptr<GpioSystem> system_;
  std::string chip_;
  std::vector<ChipLine> lines_;
  GpioFd chip_fd_;
  GpioFd fd_;
};

/// Reason why edges of this chip cannot be read by the second interface, in words; empty: they can.
std::string edgeTrouble(GpioSystem& system, const std::filesystem::path& chip);

}  // namespace kerfbench::source
