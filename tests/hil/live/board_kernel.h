// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <vector>

#include "hil/source/signal_source.h"
#include "tests/hil/source/gpio/scripted_kernel.h"
#include "tests/hil/source/serial/scripted_serial.h"
#include "twin/base/signal_map.h"

namespace kerfbench::live {

/// A controller board behind a scripted kernel: a release whose pins are the chip's lines and whose UART is a
/// serial line. Its time is the kernel's clock, which advances only during waits (or where the script is
/// slow), so that a live run on it is the same each time and takes no real time.
class BoardKernel final : public source::ScriptedKernel {
 public:
  /// Signal of each line, in and out.
  using Wiring = std::map<std::uint32_t, Signal>;

  /// Makes a board with `release` at tick 0 when the kernel's clock is at its start.
  BoardKernel(std::unique_ptr<source::SignalSource> release, const SignalMap& pins, Wiring wiring);

  /// Latency of an adapter on USB: the controller's bytes are handed over when this has passed since the last
  /// packet, or when a packet is full. 0: at once.
  std::uint64_t serial_latency_ns{};

  /// Serial line of the board.
  [[nodiscard]] const std::shared_ptr<source::ScriptedSerial>& serial() const { return serial_; }

  source::KernelAnswer control(int fd, unsigned long request_code, void* argument) override;
  source::KernelAnswer poll(int fd, std::uint64_t timeout_ns, short& revents) override;

 private:
  void runTo(std::uint64_t goal_ns);
  void takeEvent(const PinEvent& event);
  void handOver(std::uint64_t now);
  void driveLines(const gpio_v2_line_request& lines, std::uint64_t mask, std::uint64_t bits);
  [[nodiscard]] Tick tickAt(std::uint64_t now_ns) const;
  [[nodiscard]] std::uint64_t stampOf(Tick tick) const;

  std::unique_ptr<source::SignalSource> release_;
  TickRate rate_;
  SignalMap pins_;
  Wiring wiring_;
  std::map<PinId, std::uint32_t> line_of_;  ///< Lines of the release's outputs.
  std::shared_ptr<source::ScriptedSerial> serial_{std::make_shared<source::ScriptedSerial>()};
  std::size_t sent_{};              ///< Bytes of the bench that the release has.
  std::vector<std::uint8_t> held_;  ///< Bytes held by the adapter.
  std::uint64_t last_packet_ns_{};
  source::Batch batch_;
  Tick last_drive_{};
};

}  // namespace kerfbench::live
