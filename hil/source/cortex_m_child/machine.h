// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hil/source/cortex_m_child/bus.h"
#include "hil/source/cortex_m_child/core.h"
#include "hil/source/cortex_m_child/core_time.h"
#include "hil/source/cortex_m_child/dma.h"
#include "hil/source/cortex_m_child/exceptions.h"
#include "hil/source/cortex_m_child/exti.h"
#include "hil/source/cortex_m_child/flash_interface.h"
#include "hil/source/cortex_m_child/parts.h"
#include "hil/source/cortex_m_child/pins.h"
#include "hil/source/cortex_m_child/rcc.h"
#include "hil/source/cortex_m_child/serial_line.h"
#include "hil/source/cortex_m_child/small_devices.h"
#include "hil/source/cortex_m_child/system_control.h"
#include "hil/source/cortex_m_child/timer.h"
#include "hil/source/cortex_m_child/usart.h"
#include "hil/source/cortex_m_child/usb_device.h"
#include "hil/source/cortex_m_child/watchdog.h"
#include "hil/source/emulator/emulator.h"

namespace kerfbench::cortex_m_child {

/// An STM32F103 that runs an image.
///
/// Devices and core have one time, in cycles of the core. The core runs until an instruction would begin at
/// or after the next event of a device; an access of the core to a device brings all devices to the access's
/// cycle first. Inputs are looked at between instructions only, so that nothing depends on how a run is cut
/// into quanta.
class Machine final : public emulator::Emulator, private CoreBus, private DeviceTime {
 public:
  /// @throws std::runtime_error if the part is not known or the image is not fit to run.
  explicit Machine(const emulator::OpenRequest& asked);

  [[nodiscard]] emulator::Clock clock() const override;
  [[nodiscard]] std::string configuration() const override;
  void drive(std::uint64_t tick, std::uint16_t port, std::uint16_t bit, bool level) override;
  void send(std::span<const std::uint8_t> bytes) override;
  emulator::RunResult run(std::uint64_t until) override;

 private:
  struct Input {
    std::uint64_t tick{};
    Pin pin;
    bool level{};
  };

  std::optional<std::uint32_t> readDevice(std::uint32_t address, unsigned bytes) override;
  bool writeDevice(std::uint32_t address, unsigned bytes, std::uint32_t value) override;
  bool writeFlash(std::uint32_t offset, unsigned bytes, std::uint32_t value) override;
  void runDevicesTo(Cycle cycle) override;

  void addDevices();
  void addUnmodelled();
  void connect();
  void reset(unsigned cause);
  void resetDevices(ClockBus bus, std::uint32_t bits);
  void onClock();
  void checkClock();
  [[nodiscard]] Cycle findDeviceEvent() const;
  [[nodiscard]] Cycle findInput();
  void findEvents();
  void feedInput();
  void advanceTo(Cycle cycle);
  void refreshLimit();
  void step(Cycle end);
  void sleepTo(Cycle end);
  void runCore();
  void fault(Stop stop);
  [[nodiscard]] bool hasEnded(emulator::RunResult& result);

  emulator::OpenRequest asked_;
  const Part& part_;
  Present present_;
  std::vector<std::uint8_t> flash_, sram_, system_memory_;
  CoreTime time_;
  Rcc rcc_;
  Nvic nvic_;
  Bus bus_;
  Dma dma_;
  Pins pins_;
  Afio afio_;
  Exti exti_;
  SysTick systick_;
  SystemControl control_;
  FlashInterface flash_interface_;
  Watchdog watchdog_;
  UsbDevice usb_;
  CrcUnit crc_;
  KeptRegisters power_, backup_;
  std::vector<std::unique_ptr<Timer>> timers_;
  Usarts usarts_;
  SerialLine line_;
  Core core_;
  ExceptionUnit exceptions_;
  std::vector<Device*> timed_;  ///< Devices with events.
  std::deque<Input> inputs_;
  std::uint64_t watermark_{};
  std::uint64_t clock_due_tick_{};  ///< The firmware has set its clock until then.
  bool clock_is_due_{};
  Cycle device_cycle_{};       ///< Where all devices stand at least.
  Cycle next_device_event_{};  ///< The earliest of all devices; at most too early.
  Cycle next_input_{};
  Cycle end_{};
  std::string bad_access_;  ///< What was wrong with an access, where there is more to say than the address.
  bool has_halted_{};
};

}  // namespace kerfbench::cortex_m_child
