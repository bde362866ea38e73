// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/machine.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "hil/source/cortex_m_child/image.h"

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kStampErrorTicks = 24;  // See docs/reference/cortex-m-controllers.md, Time.
constexpr double kReset_s = 20e-6;              // Shortest pulse of NRST that a reset makes (DS5319).
constexpr double kClockSetUp_s = 20e-3;         // Longer than the oscillators' and the PLL's start.
constexpr unsigned kPinReset = 26, kPowerReset = 27, kSoftwareReset = 28, kWatchdogReset = 29;  // RCC_CSR
constexpr std::uint64_t kMostClock_hz = 100'000'000;
// Bits of CFSR.
constexpr std::uint32_t kInstructionBus = 1U << 8, kPreciseBus = 1U << 9, kUndefinedInstruction = 1U << 16,
                        kInvalidState = 1U << 17, kUnalignedAccess = 1U << 24, kDivisionByZero = 1U << 25;

/// Whether this is a register of a port: what is written there has no event of its own.
bool isPort(std::uint32_t address) { return address >= 0x40010800 && address < 0x40012400; }

const Part& partFor(const emulator::OpenRequest& asked) {
  const Part* part = partNamed(asked.mcu);
  if (part == nullptr)
    throw std::runtime_error("there is no controller '" + asked.mcu + "' among the STM32F103 emulated");
  emulator::checkRates(asked, kMostClock_hz);
  if (!asked.eeprom.empty())
    throw std::runtime_error(
        "eeprom: an STM32F103 has no EEPROM; what firmware keeps instead is in its flash, that is in the "
        "image");
  return *part;
}

}  // namespace

Machine::Machine(const emulator::OpenRequest& asked)
    : asked_(asked),
      part_(partFor(asked)),
      flash_(readFlash(asked.image_path, part_)),
      sram_(part_.sram_bytes),
      system_memory_(kSystemMemoryBytes, 0xFF),
      time_(asked.clock_hz, Rcc::kHsi_hz),
      bus_(present_, rcc_, flash_, sram_),
      dma_(present_, nvic_, bus_),
      pins_(present_, time_, static_cast<std::size_t>(asked.max_events)),
      exti_(nvic_, pins_, afio_),
      systick_(present_, nvic_),
      control_(present_, nvic_, systick_, part_.device_id),
      flash_interface_(present_, nvic_, time_, flash_, part_.page_bytes),
      watchdog_(present_, time_),
      usb_({present_, nvic_, exti_, pins_, rcc_, time_}),
      line_(present_, time_, usarts_, usb_, asked.baud),
      core_(present_, *this, flash_, sram_, system_memory_),
      // NOLINTNEXTLINE(bugprone-throw-keyword-missing): exceptions of the core, and nothing to throw.
      exceptions_(present_, core_, nvic_, control_, *this, sram_) {
  writeIdentity(part_, system_memory_);
  addDevices();
  addUnmodelled();
  connect();
  rcc_.recordReset(kPowerReset);
  rcc_.recordReset(kPinReset);
  clock_due_tick_ = static_cast<std::uint64_t>(kClockSetUp_s * static_cast<double>(asked.clock_hz));
  exceptions_.reset();
}

void Machine::addDevices() {
  const Timer::Surroundings around{present_, nvic_, dma_, pins_, afio_, rcc_};
  for (const char digit : part_.timers) {
    const auto number = static_cast<unsigned>(digit - '0');
    timers_.push_back(std::make_unique<Timer>(around, number));
    const std::string name = "TIM" + std::to_string(number);
    if (number == 1) bus_.add({0x40012C00, timers_.back().get(), ClockBus::kApb2, 11, name});
    if (number != 1)
      bus_.add({0x40000000 + (number - 2) * 0x400, timers_.back().get(), ClockBus::kApb1, number - 2, name});
    timed_.push_back(timers_.back().get());
  }
  for (const char digit : part_.usarts) {
    const auto number = static_cast<unsigned>(digit - '0');
    usarts_.push_back(std::make_unique<Usart>(present_, nvic_, dma_, rcc_, number));
    const std::string name = "USART" + std::to_string(number);
    if (number == 1) bus_.add({0x40013800, usarts_.back().get(), ClockBus::kApb2, 14, name});
    if (number != 1)
      bus_.add({0x40004000 + (number - 1) * 0x400, usarts_.back().get(), ClockBus::kApb1, 15 + number, name});
    timed_.push_back(usarts_.back().get());
  }
  const unsigned ports = part_.page_bytes > 1024 ? 7 : 5;
  for (unsigned i = 0; i < ports; ++i)
    bus_.add({0x40010800 + i * 0x400, &pins_.port(i), ClockBus::kApb2, 2 + i,
              "GPIO" + std::string(1, static_cast<char>('A' + i))});
  bus_.add({0x40010000, &afio_, ClockBus::kApb2, 0, "AFIO"});
  bus_.add({0x40010400, &exti_, ClockBus::kAlways, 0, "EXTI"});
  bus_.add({0x40003000, &watchdog_, ClockBus::kAlways, 0, "IWDG"});
  bus_.add({0x40005C00, &usb_, ClockBus::kApb1, 23, "USB"});
  bus_.add({0x40006000, &usb_.packetMemory(), ClockBus::kApb1, 23, "the packet memory of USB"});
  bus_.add({0x40006C00, &backup_, ClockBus::kApb1, 27, "BKP"});
  bus_.add({0x40007000, &power_, ClockBus::kApb1, 28, "PWR"});
  bus_.add({0x40020000, &dma_, ClockBus::kAhb, 0, "DMA1"});
  bus_.add({0x40021000, &rcc_, ClockBus::kAlways, 0, "RCC"});
  bus_.add({0x40022000, &flash_interface_, ClockBus::kAlways, 0, "FLASH"});
  bus_.add({0x40023000, &crc_, ClockBus::kAhb, 6, "CRC"});
  bus_.add({kSystemBase, &control_, ClockBus::kAlways, 0, "the core"});
  timed_.insert(timed_.end(), {&systick_, &dma_, &watchdog_, &usb_});
}

void Machine::addUnmodelled() {
  struct Known {
    std::uint32_t base{};
    ClockBus bus{};
    unsigned clock_bit{};
    const char* name{};
  };
  static constexpr Known kKnown[] = {
      {0x40002800, ClockBus::kApb1, 28, "RTC"},  {0x40002C00, ClockBus::kApb1, 11, "WWDG"},
      {0x40003800, ClockBus::kApb1, 14, "SPI2"}, {0x40005400, ClockBus::kApb1, 21, "I2C1"},
      {0x40005800, ClockBus::kApb1, 22, "I2C2"}, {0x40006400, ClockBus::kApb1, 25, "CAN"},
      {0x40012400, ClockBus::kApb2, 9, "ADC1"},  {0x40012800, ClockBus::kApb2, 10, "ADC2"},
      {0x40013000, ClockBus::kApb2, 12, "SPI1"}};
  static constexpr Known kHighDensity[] = {
      {0x40000C00, ClockBus::kApb1, 3, "TIM5"},   {0x40001000, ClockBus::kApb1, 4, "TIM6"},
      {0x40001400, ClockBus::kApb1, 5, "TIM7"},   {0x40003C00, ClockBus::kApb1, 15, "SPI3"},
      {0x40004C00, ClockBus::kApb1, 19, "UART4"}, {0x40005000, ClockBus::kApb1, 20, "UART5"},
      {0x40007400, ClockBus::kApb1, 29, "DAC"},   {0x40013400, ClockBus::kApb2, 13, "TIM8"},
      {0x40013C00, ClockBus::kApb2, 15, "ADC3"},  {0x40018000, ClockBus::kAhb, 10, "SDIO"},
      {0x40020400, ClockBus::kAhb, 1, "DMA2"}};
  for (const Known& known : kKnown) bus_.add({known.base, nullptr, known.bus, known.clock_bit, known.name});
  if (part_.page_bytes <= 1024) return;
  for (const Known& known : kHighDensity)
    bus_.add({known.base, nullptr, known.bus, known.clock_bit, known.name});
}

void Machine::connect() {
  pins_.on_change = [this](unsigned port, std::uint32_t changed) {
    exti_.onPins(port, changed);
    for (const auto& timer : timers_) timer->onPins(port, changed);
  };
  afio_.on_remap = [this] {
    for (const auto& timer : timers_) timer->onRemap();
  };
  exti_.on_event = [this] { exceptions_.signalEvent(); };
  dma_.on_enabled = [this] {
    for (Device* device : timed_) device->serveDma();
  };
  dma_.on_write = [this](std::uint32_t address, std::uint32_t bytes) {
    next_device_event_ = 0;  // Whatever it was, it may have set up a device.
    if (address >= kSramBase && address - kSramBase < sram_.size()) core_.forgetCode(address, bytes);
  };
  for (const auto& usart : usarts_)
    usart->on_transmit = [this](const Usart& from, std::uint8_t byte, Cycle end) {
      line_.onTransmit(from, byte, end);
    };
  flash_interface_.on_timing = [this] {
    core_.setFlashTiming(flash_interface_.waitStates(), flash_interface_.prefetches());
  };
  flash_interface_.on_erase = [this](std::uint32_t offset, std::uint32_t bytes) {
    core_.forgetCode(kFlashBase + offset, bytes);
  };
  rcc_.on_reset = [this](ClockBus bus, std::uint32_t bits) { resetDevices(bus, bits); };
}

void Machine::resetDevices(ClockBus bus, std::uint32_t bits) {
  for (const Bus::Slot& slot : bus_.slots()) {
    if (slot.device != nullptr && slot.bus == bus && (bits >> slot.clock_bit & 1U) != 0) slot.device->reset();
  }
}

void Machine::reset(unsigned cause) {
  present_.cycle += time_.cyclesIn(kReset_s);
  for (const Bus::Slot& slot : bus_.slots()) {
    if (slot.device != nullptr) slot.device->reset();
  }
  systick_.reset();
  nvic_.reset();
  core_.setTraps(false, false);
  rcc_.recordReset(cause);
  rcc_.recordReset(kPinReset);
  clock_is_due_ = false;
  onClock();
  clock_due_tick_ = time_.tickOf(present_.cycle) +
                    static_cast<std::uint64_t>(kClockSetUp_s * static_cast<double>(asked_.clock_hz));
  exceptions_.reset();
  findEvents();
}

/// The firmware may have set another clock.
void Machine::onClock() {
  if (rcc_.coreHz() == time_.coreHz()) return;
  time_.changeClock(present_.cycle, rcc_.coreHz());
  if (clock_is_due_) checkClock();
}

void Machine::checkClock() {
  if (time_.coreHz() == asked_.clock_hz || !present_.misheard.empty()) return;
  present_.misheard = "the firmware runs its core at " + rcc_.clockInWords() +
                      " (HSE and HSI of 8000000 Hz), and the scenario says " +
                      std::to_string(asked_.clock_hz) + " Hz";
}

emulator::Clock Machine::clock() const { return {1, asked_.clock_hz, kStampErrorTicks}; }

std::string Machine::configuration() const {
  return "Cortex-M3; cycles by instruction class, pipeline, flash lines; "
         "HSE 8 MHz, LSI 40 kHz; mcu " +
         asked_.mcu + " at " + std::to_string(asked_.clock_hz) + " Hz, " + std::to_string(asked_.baud) +
         " baud";
}

void Machine::drive(std::uint64_t tick, std::uint16_t port, std::uint16_t bit, bool level) {
  if (!inputs_.empty() && tick < inputs_.back().tick) throw std::runtime_error("DRIVE goes back in time");
  if (port >= Pins::kPorts || bit >= 16 ||
      part_.ports.find(static_cast<char>('A' + port)) == std::string_view::npos)
    throw std::runtime_error("the controller has no pin " + std::to_string(bit) + " of port " +
                             std::to_string(port));
  inputs_.push_back({tick, {port, bit}, level});
}

void Machine::send(std::span<const std::uint8_t> bytes) { line_.send(bytes, watermark_); }

Cycle Machine::findDeviceEvent() const {
  Cycle next = kNever;
  for (const Device* device : timed_) next = std::min(next, device->nextEvent());
  return next;
}

Cycle Machine::findInput() {
  std::uint64_t tick = line_.nextTick();
  if (!inputs_.empty()) tick = std::min(tick, inputs_.front().tick);
  if (!clock_is_due_) tick = std::min(tick, clock_due_tick_);
  return tick == kNever ? kNever : time_.cycleAt(tick);
}

void Machine::runDevicesTo(Cycle cycle) {
  device_cycle_ = std::max(device_cycle_, cycle);
  if (cycle < next_device_event_) return;
  const Cycle present = present_.cycle;
  for (;;) {
    Device* first = nullptr;
    Cycle when = kNever;
    for (Device* device : timed_) {
      const Cycle next = device->nextEvent();
      if (next < when) when = next, first = device;
    }
    if (first == nullptr || when > cycle) break;
    present_.cycle = when;
    first->runTo(when);
    if (pins_.flooded()) break;
  }
  present_.cycle = present;
  next_device_event_ = findDeviceEvent();
}

/// What comes from outside first.
void Machine::feedInput() {
  const std::uint64_t line = line_.nextTick();
  const std::uint64_t pin = inputs_.empty() ? kNever : inputs_.front().tick;
  if (!clock_is_due_ && clock_due_tick_ <= std::min(line, pin)) {
    clock_is_due_ = true;
    checkClock();
  } else if (pin <= line) {
    const Input input = inputs_.front();
    inputs_.pop_front();
    pins_.drive(input.pin, input.level);
  } else {
    line_.run();
  }
}

void Machine::advanceTo(Cycle cycle) {
  const Cycle present = present_.cycle;
  while (next_input_ <= cycle) {
    present_.cycle = std::max(next_input_, std::min(device_cycle_, present));
    runDevicesTo(present_.cycle);
    feedInput();
    findEvents();
    if (pins_.flooded() || !present_.misheard.empty()) break;
  }
  present_.cycle = present;
  runDevicesTo(cycle);
}

void Machine::refreshLimit() {
  const bool must_stop = !present_.failure.empty() || !present_.misheard.empty() || pins_.flooded() ||
                         (nvic_.takeNews() && nvic_.next());
  core_.setLimit(must_stop ? 0 : std::min({end_, next_device_event_, next_input_}));
}

void Machine::findEvents() {
  next_device_event_ = findDeviceEvent();
  next_input_ = findInput();
}

std::optional<std::uint32_t> Machine::readDevice(std::uint32_t address, unsigned bytes) {
  present_.cycle += bus_.waitCycles(address);
  runDevicesTo(present_.cycle);
  control_.setCurrent(exceptions_.currentException());
  const auto value = bus_.read(address, bytes);
  if (!value) bad_access_ = "it reads " + hex32(address) + ", where there is no device";
  if (address < kSystemBase && !isPort(address)) next_input_ = findInput();  // A USART may be ready again.
  refreshLimit();
  return value;
}

bool Machine::writeDevice(std::uint32_t address, unsigned bytes, std::uint32_t value) {
  present_.cycle += bus_.waitCycles(address);
  runDevicesTo(present_.cycle);
  for (const auto& timer : timers_) {
    // A change of the clocks counts from here on.
    if (address - 0x40021000U < 0x400U) timer->runTo(present_.cycle);
  }
  const bool is_done = bus_.write(address, bytes, value);
  if (!is_done) bad_access_ = "it writes to " + hex32(address) + ", where there is no device";
  if (address - kSramAliasBase < 32 * sram_.size())
    core_.forgetCode(kSramBase + (address - kSramAliasBase) / 32, 1);
  if (address >= kSystemBase) core_.setTraps(control_.trapsUnaligned(), control_.trapsDivision());
  if (!isPort(address)) {
    onClock();
    findEvents();
  }
  refreshLimit();
  return is_done;
}

bool Machine::writeFlash(std::uint32_t offset, unsigned bytes, std::uint32_t value) {
  if (flash_interface_.program(offset, bytes, value)) {
    core_.setLimit(0);  // Much time has passed.
    return true;
  }
  bad_access_ = "it writes other than a half-word to the flash, at " + hex32(kFlashBase + offset);
  return false;
}

void Machine::sleepTo(Cycle end) {
  if (nvic_.wakes() || (exceptions_.awaitsEvent() && exceptions_.takeEvent())) return exceptions_.wake();
  // Devices may still move pins, and bytes be on their way.
  has_halted_ =
      !nvic_.canWake(systick_.ticks()) && !exceptions_.awaitsEvent() && next_device_event_ == kNever;
  present_.cycle = std::max(present_.cycle, std::min({end, next_device_event_, next_input_}));
}

void Machine::runCore() {
  refreshLimit();
  switch (const Stop stop = core_.run()) {
    case Stop::kLimit:
      break;
    case Stop::kTrap:
      exceptions_.executeTrap();
      break;
    case Stop::kExceptionExit:
      exceptions_.returnFrom(core_.faultAddress());
      break;
    default:
      fault(stop);
      break;
  }
}

void Machine::fault(Stop stop) {
  const std::uint32_t address = core_.faultAddress();
  const std::string where = hex32(address);
  if (stop == Stop::kBadFetch) {
    exceptions_.fault(kBusFault, kInstructionBus, "it goes to " + where + ", where nothing can be executed");
  } else if (stop == Stop::kBadAccess) {
    const std::string what = std::exchange(bad_access_, {});
    exceptions_.fault(kBusFault, kPreciseBus,
                      what.empty() ? "it accesses " + where + ", where there is no memory" : what, address);
  } else if (stop == Stop::kUnaligned) {
    exceptions_.fault(kUsageFault, kUnalignedAccess, "it accesses " + where + ", which is not aligned");
  } else if (stop == Stop::kDivisionByZero) {
    exceptions_.fault(kUsageFault, kDivisionByZero, "it divides by zero");
  } else if (stop == Stop::kNotThumb) {
    exceptions_.fault(kUsageFault, kInvalidState, "it jumps to an even address, which leads out of Thumb");
  } else {
    const std::string code = hex32(core_.halfWord(core_.pc()).value_or(0)).replace(2, 4, "");
    exceptions_.fault(kUsageFault, kUndefinedInstruction, "the instruction " + code + " does not exist");
  }
}

void Machine::step(Cycle end) {
  if (control_.takeResetRequest()) return reset(kSoftwareReset);
  if (watchdog_.takeResetRequest()) return reset(kWatchdogReset);
  if (exceptions_.enterNext()) return;
  if (exceptions_.isAsleep()) return sleepTo(end);
  runCore();
}

bool Machine::hasEnded(emulator::RunResult& result) {
  if (pins_.flooded()) {
    result.stop = KB_PS_FLOODED;
    result.message = "more than " + std::to_string(asked_.max_events) + " pin events in one quantum";
  } else if (!present_.failure.empty()) {
    result.stop = KB_PS_CRASHED;
    result.message =
        present_.failure + " (PC " + hex32(core_.pc()) + ", cycle " + std::to_string(present_.cycle) + ")";
  } else if (!present_.misheard.empty()) {
    result.stop = KB_PS_MISHEARD;
    result.message = present_.misheard;
  } else if (has_halted_) {
    result.stop = KB_PS_ENDED;
    result.message = "the firmware sleeps with all interrupts off: nothing can wake it";
  }
  return result.stop != KB_PS_REACHED;
}

emulator::RunResult Machine::run(std::uint64_t until) {
  emulator::RunResult result;
  findEvents();
  for (;;) {
    end_ = time_.cycleAt(until);
    advanceTo(std::min(present_.cycle, end_));
    if (hasEnded(result) || present_.cycle >= end_) break;
    step(end_);
  }
  result.watermark =
      result.stop == KB_PS_REACHED ? until : std::clamp(time_.tickOf(present_.cycle) + 1, watermark_, until);
  watermark_ = result.watermark;
  result.events = pins_.take(result.watermark);
  result.uart = line_.takeSent(result.watermark);
  return result;
}

}  // namespace kerfbench::cortex_m_child
