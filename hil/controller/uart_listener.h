// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hil/inspect/verdict/controller_state.h"
#include "hil/source/vcd.h"

namespace kerfbench::controller {

/// Names of the reference controller's faults (controller/protocol.h) by number; the first is "ok".
std::vector<std::string> faultNames();
/// "unknown" for a number beyond them.
std::string faultName(std::uint8_t fault);

/// Decoder of the reference controller's UART, apart from the dialog with it.
class UartListener {
 public:
  /// Steps of its axes, as KB_STATE lists them.
  static constexpr std::size_t kAxes = 5;
  struct BeltWord {
    double time_s{};  ///< Time of the last byte of the KB_STATE.
    long long counts{};
  };
  /// End of the run as the controller reports it.
  struct End {
    double time_s{};
    bool done{};           ///< False: stopped.
    std::uint8_t fault{};  ///< enum kb_fault.
  };
  struct Account {
    BeltWord first_belt;  ///< Belt in the run's first KB_STATE: its zero is when the controller woke.
    BeltWord belt;
    std::array<long long, kAxes> steps{};
  };

  UartListener() = default;
  /// Takes the bytes of a whole recording.
  explicit UartListener(const source::PinRecording& recording);
  void hear(std::span<const std::uint8_t> bytes, double now_s);
  /// Changes of its state, by time.
  [[nodiscard]] const std::vector<inspect::ControllerState>& reports() const { return reports_; }
  /// First report of an end, since later ones may be of what the controller did then; nullopt: none came.
  [[nodiscard]] const std::optional<End>& end() const { return end_; }
  /// Bytes that are part of no whole report; what waits for its end is not among them.
  [[nodiscard]] std::size_t strayBytes() const { return stray_bytes_; }
  /// Last KB_STATE since the controller stopped or was done; nullopt: none came.
  [[nodiscard]] const std::optional<Account>& account() const { return account_; }

 private:
  void frame(std::uint8_t type, std::span<const std::uint8_t> payload, double now_s);

  std::vector<std::uint8_t> pending_;
  std::vector<inspect::ControllerState> reports_;
  std::optional<BeltWord> first_belt_;
  std::optional<Account> account_;
  std::optional<End> end_;
  std::size_t stray_bytes_{};
};

}  // namespace kerfbench::controller
