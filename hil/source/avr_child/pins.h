// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <avr_ioport.h>
#include <sim_avr.h>

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "hil/source/emulator/emulator.h"

namespace kerfbench::avr_child {

using emulator::PinEvent;

/// Controller's pins, port by port.
///
/// A pin is driven only if its DDR bit is set; then it follows its PORT bit, unless a timer's compare unit is
/// connected to it. simavr lets a compare unit write the PORT register, so that a pin stays high after the
/// unit is disconnected; here the two are kept apart, as on silicon.
///
/// Ticks. simavr's clock stands at the start of an instruction while its store is carried out, and a pin of
/// the silicon changes at its end: events of instructions are stamped one cycle later, those of timers at the
/// timer's own cycle.
class Pins {
 public:
  Pins(avr_t* avr, std::size_t max_events);
  Pins(const Pins&) = delete;
  Pins& operator=(const Pins&) = delete;

  /// Puts a level on an input. @throws std::runtime_error if the controller has no such pin.
  void drive(std::uint16_t port, std::uint16_t bit, bool level);
  /// Again after a reset, which forgets what is outside.
  void redrive();
  /// The port whose PORT register this is, or -1.
  [[nodiscard]] int portOf(avr_io_addr_t port_register) const;
  /// A compare unit takes or leaves its pin.
  void setCompareOutput(int port, unsigned bit, bool connected, bool level);
  /// A reset has cleared the registers.
  void refresh();

  void setInTimer(bool in_timer) { in_timer_ = in_timer; }
  [[nodiscard]] bool flooded() const { return flooded_; }
  /// The events since the last call.
  std::vector<PinEvent> take();

 private:
  /// A handler of simavr's own.
  struct Writer {
    avr_io_write_t call{};
    void* param{};
  };
  struct Port {
    Pins* owner{};
    avr_ioport_t* io{};
    std::uint16_t index{};
    std::uint8_t latch{};      // PORT, as the firmware wrote it
    std::uint8_t direction{};  // DDR
    std::uint8_t connected{};  // bits that a compare unit owns
    std::uint8_t compare{};    // the compare units' levels
    std::uint8_t level{};
    std::uint8_t driven_mask{};
    std::uint8_t driven_level{};
    Writer write_pin{};   // The PIN register's.
    Writer write_port{};  // The PORT register's.
  };
  static void onPort(avr_irq_t* irq, std::uint32_t value, void* param);
  static void onDirection(avr_irq_t* irq, std::uint32_t value, void* param);
  static void onPinWrite(avr_t* avr, avr_io_addr_t addr, std::uint8_t value, void* param);
  static void onPortWrite(avr_t* avr, avr_io_addr_t addr, std::uint8_t value, void* param);
  Writer takeOver(avr_io_addr_t addr, avr_io_write_t handler, Port& port);
  void update(Port& port);
  static void applyExternal(const Port& port);

  static constexpr std::size_t kPorts = 26;
  avr_t* avr_;
  std::size_t max_events_;
  std::array<std::unique_ptr<Port>, kPorts> ports_;
  std::vector<PinEvent> events_;
  bool in_timer_{};
  bool flooded_{};
};

}  // namespace kerfbench::avr_child
