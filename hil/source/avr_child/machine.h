// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <avr_uart.h>
#include <sim_avr.h>

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hil/source/avr_child/core.h"
#include "hil/source/avr_child/image.h"
#include "hil/source/avr_child/pins.h"
#include "hil/source/avr_child/timer_shim.h"
#include "hil/source/emulator/emulator.h"
#include "hil/source/emulator/serial_pace.h"
#include "hil/source/pin_stream.h"

namespace kerfbench::avr_child {

using emulator::PinEvent;
using emulator::RunResult;

/// A microcontroller under simavr, stepped so that nothing depends on how a run is cut into quanta.
///
/// simavr's own avr_run() is not used. Here a timer runs at its own cycle instead of at the end of the
/// instruction that passed it, an interrupt costs its entry cycles, sleep ends on the very cycle, and an
/// instruction that runs over the end of a quantum leaves its after-work to the next quantum. One Machine per
/// process (simavr's logger is global).
class Machine : public emulator::Emulator {
 public:
  /// @throws std::runtime_error if the controller is not known or the image is not fit to run.
  explicit Machine(const emulator::OpenRequest& options);
  ~Machine() override;
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  [[nodiscard]] emulator::Clock clock() const override;
  [[nodiscard]] std::string configuration() const override;
  void drive(std::uint64_t tick, std::uint16_t port, std::uint16_t bit, bool level) override;
  void send(std::span<const std::uint8_t> bytes) override;
  RunResult run(std::uint64_t until) override;

 private:
  struct Input {
    std::uint64_t tick{};
    std::uint16_t port{};
    std::uint16_t bit{};
    bool level{};
  };
  struct SentByte {
    std::uint64_t done_at{};
    std::uint8_t byte{};
  };
  /// A register of timers, or of the UART, whose writes are watched.
  struct Register {
    /// Writes as simavr does.
    void writeOn(avr_t* avr, avr_io_addr_t addr, std::uint8_t value) const;
    Machine* owner{};
    avr_io_write_t write{};
    void* write_param{};
    avr_io_read_t read{};
    void* read_param{};
    std::vector<TimerShim*> timers;
  };

  static void onRegisterWrite(avr_t* avr, avr_io_addr_t addr, std::uint8_t value, void* param);
  static std::uint8_t onCountRead(avr_t* avr, avr_io_addr_t addr, void* param);
  static void onUartOut(avr_irq_t* irq, std::uint32_t value, void* param);
  static void onUartXon(avr_irq_t* irq, std::uint32_t value, void* param);
  static void onUartXoff(avr_irq_t* irq, std::uint32_t value, void* param);
  static void onUartSetup(avr_t* avr, avr_io_addr_t addr, std::uint8_t value, void* param);
  static void onLog(avr_t* avr, int level, const char* format, va_list arguments);

  void load(const Image& image);
  void hookTimers();
  void hookUart();
  void hookUartSetup(unsigned addr);
  void afterReset();
  void setByteTime();
  [[nodiscard]] unsigned cyclesPerBit() const;
  void watchUart();
  [[nodiscard]] bool hasFailed(RunResult& result) const;
  void runTimersTo(std::uint64_t tick);
  void feedInputs();
  void serviceInterrupts();
  void sleepTo(std::uint64_t until);
  void runInstructions(std::uint64_t until);
  [[nodiscard]] std::uint64_t nextInput() const;

  emulator::OpenRequest options_;
  avr_t* avr_{};
  std::unique_ptr<Core> core_;
  std::unique_ptr<Pins> pins_;
  std::vector<std::unique_ptr<TimerShim>> timers_;
  std::vector<std::unique_ptr<Register>> registers_;
  avr_uart_t* uart_{};
  std::deque<Input> inputs_;
  std::deque<std::uint8_t> to_send_;
  std::deque<SentByte> sent_;
  std::uint64_t next_byte_at_{};
  emulator::SerialPace pace_;
  std::uint64_t watermark_{};
  bool xoff_{};
  bool service_due_{};
  bool asleep_{};
  std::string crash_;
  std::string misheard_;
};

}  // namespace kerfbench::avr_child
