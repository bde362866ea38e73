// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>

#include "hil/source/emulator/emulator.h"
#include "hil/source/emulator/serial_pace.h"
#include "hil/source/mcs51_child/chip.h"
#include "hil/source/mcs51_child/part.h"

namespace kerfbench::mcs51_child {

/// A microcontroller of the MCS-51 family as the bench sees it. A tick is a clock of its oscillator.
///
/// An instruction that runs over the end of a quantum leaves what follows it to the next quantum, so that
/// nothing depends on how a run is cut. An input takes effect at the end of the instruction during which it
/// changes.
class Machine : public emulator::Emulator {
 public:
  /// @throws std::runtime_error if the controller is not known or the image is not fit to run.
  explicit Machine(const emulator::OpenRequest& asked);

  [[nodiscard]] emulator::Clock clock() const override;
  [[nodiscard]] std::string configuration() const override;
  void drive(std::uint64_t tick, std::uint16_t port, std::uint16_t bit, bool level) override;
  void send(std::span<const std::uint8_t> bytes) override;
  emulator::RunResult run(std::uint64_t until) override;

 private:
  struct Input {
    Tick tick{};
    std::uint16_t port{};
    std::uint16_t bit{};
    bool level{};
  };
  void settle();
  void feedInputs();
  void watchLine();
  void watchRate(double ticks_per_bit);
  bool hasEnded(emulator::RunResult& result);
  void deliver(emulator::RunResult& result, Tick until);

  emulator::OpenRequest asked_;
  const Part& part_;
  std::unique_ptr<Chip> chip_;
  std::deque<Input> inputs_;
  std::deque<Frame> sent_;
  Tick line_free_at_{};  // When the last byte for the controller is through.
  emulator::SerialPace pace_;
  std::uint64_t begun_{};
  std::uint64_t heard_{};
  Tick watermark_{};
  bool is_settled_{};
  std::string misheard_;
};

}  // namespace kerfbench::mcs51_child
