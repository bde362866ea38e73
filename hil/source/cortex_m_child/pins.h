// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "hil/source/cortex_m_child/core_time.h"
#include "hil/source/cortex_m_child/device.h"
#include "hil/source/emulator/emulator.h"

namespace kerfbench::cortex_m_child {

struct Pin {
  unsigned port{};
  unsigned bit{};
  bool operator==(const Pin&) const = default;
};

/// General-purpose pins, port by port (STMicroelectronics 2015 RM0008, chapter 9).
///
/// An output is driven by ODR, or in the alternate function by the timer that has it; an alternate function
/// that no modelled device has stays low. An open-drain output that is not pulled low counts as high, because
/// inputs of drives have pull-ups. An input reads what the bench puts on it, and else its pull-up or
/// pull-down; a floating one reads low.
class Pins {
 public:
  static constexpr unsigned kPorts = 7;

  Pins(Present& present, const CoreTime& time, std::size_t max_events);
  Pins(const Pins&) = delete;
  Pins& operator=(const Pins&) = delete;

  void reset();
  /// The registers of a port.
  [[nodiscard]] Device& port(unsigned index) { return ports_[index]; }
  /// The bench puts a level on a pin.
  void drive(Pin pin, bool level);
  /// A timer takes a pin in its alternate function, with this level, or leaves it.
  void setAlternate(Pin pin, bool is_taken, bool level);
  /// A device that is no modelled output takes a pin for itself, or leaves it: the port drives it no more.
  void setTaken(Pin pin, bool is_taken);
  /// Level that a device sees.
  [[nodiscard]] bool level(Pin pin) const { return (ports_[pin.port].seen >> pin.bit & 1U) != 0; }
  /// Called after levels that devices see have changed.
  std::function<void(unsigned port, std::uint32_t changed)> on_change;

  [[nodiscard]] bool flooded() const { return flooded_; }
  /// The events up to a tick; later ones are kept.
  std::vector<emulator::PinEvent> take(std::uint64_t until_tick);

 private:
  struct Port final : Device {
    std::uint32_t read(std::uint32_t offset) override;
    void write(std::uint32_t offset, std::uint32_t value) override;
    void reset() override;
    [[nodiscard]] std::uint32_t mode(unsigned bit) const { return modes >> (4 * bit) & 0xFU; }

    Pins* owner{};
    std::uint16_t index{};
    std::uint64_t modes{};  ///< CRL and CRH: four bits for each pin.
    std::uint32_t latch{};  ///< ODR
    std::uint32_t lock{};
    std::uint32_t foreign{};  ///< Pins of devices that drive them by themselves.
    std::uint32_t taken{};    ///< Pins of timers, and their levels.
    std::uint32_t timer_level{};
    std::uint32_t driven{};  ///< Pins that the bench has put a level on, and these.
    std::uint32_t driven_level{};
    std::uint32_t outputs{};  ///< Pins that are outputs, and those that pull low only.
    std::uint32_t open_drain{};
    std::uint32_t alternate{};
    std::uint32_t pulled{};  ///< Inputs with a pull-up or pull-down; ODR says which.
    std::uint32_t analog{};
    std::uint32_t level{};  ///< What the pin stream has told.
    std::uint32_t seen{};
  };
  static constexpr std::uint64_t kFloatingInputs = 0x4444444444444444;

  void decode(Port& port);
  void update(Port& port);
  /// Pins of a port have changed their level.
  void note(const Port& port, std::uint16_t changed);

  Present& present_;
  const CoreTime& time_;
  std::size_t max_events_;
  std::array<Port, kPorts> ports_;
  std::vector<emulator::PinEvent> events_;
  std::uint64_t taken_to_{};
  bool flooded_{};
};

}  // namespace kerfbench::cortex_m_child
