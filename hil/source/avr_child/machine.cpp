// SPDX-License-Identifier: GPL-3.0-or-later
#include "hil/source/avr_child/machine.h"

#include <avr_eeprom.h>
#include <avr_extint.h>
#include <sim_core.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

namespace kerfbench::avr_child {
namespace {

constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t kMostClock_hz = 100'000'000;
constexpr unsigned kWakeCycles = 4;  // What an interrupt takes longer out of sleep (data sheets of ATmega).
constexpr unsigned kMaxLogLines = 50;

Machine* g_machine = nullptr;  // simavr's logger has no parameter of its own

/// simavr colours what it says.
void removeColours(char* text) {
  char* to = text;
  for (const char* from = text; *from != '\0';) {
    if (*from == '\x1b') {
      while (*from != '\0' && *from != 'm') ++from;
      if (*from == 'm') ++from;
    } else {
      *to++ = *from++;
    }
  }
  *to = '\0';
}

}  // namespace

Machine::Machine(const emulator::OpenRequest& options)
    : options_(options), pace_(options.clock_hz, options.baud) {
  emulator::checkRates(options, kMostClock_hz);
  g_machine = this;
  avr_global_logger_set(onLog);
  avr_ = avr_make_mcu_by_name(options.mcu.c_str());
  if (avr_ == nullptr) throw std::runtime_error("simavr has no controller '" + options.mcu + "'");
  const std::size_t eeprom_size = avr_->e2end + 1U;
  Image image = readImage(options.image_path, avr_->flashend + 1U, eeprom_size);
  if (options.eeprom == emulator::kBlankEeprom) {
    image.eeprom.clear();
  } else if (!options.eeprom.empty()) {
    image.eeprom = readEeprom(options.eeprom, eeprom_size);
  }
  avr_init(avr_);
  avr_->frequency = static_cast<std::uint32_t>(options.clock_hz);
  avr_->gdb_port = 0;  // else a bad write opens a debugger's port to the world and waits for ever
  avr_->log = LOG_WARNING;
  boundMemories(*avr_);
  load(image);
  pins_ = std::make_unique<Pins>(avr_, static_cast<std::size_t>(options.max_events));
  hookTimers();
  hookUart();
  core_ = std::make_unique<Core>(avr_);
  afterReset();
}

Machine::~Machine() {
  if (avr_ != nullptr) avr_terminate(avr_);
  g_machine = nullptr;
}

void Machine::load(const Image& image) {
  std::memcpy(avr_->flash, image.flash.data(), image.flash.size());
  avr_->codeend = avr_->flashend;
  avr_->pc = 0;
  if (!image.eeprom.empty()) {
    std::vector<std::uint8_t> bytes = image.eeprom;
    avr_eeprom_desc_t desc{};
    desc.ee = bytes.data();
    desc.size = static_cast<std::uint32_t>(bytes.size());
    avr_ioctl(avr_, static_cast<std::uint32_t>(AVR_IOCTL_EEPROM_SET), &desc);
  }
}

void Machine::hookTimers() {
  for (avr_io_t* io = avr_->io_port; io != nullptr; io = io->next) {
    if (std::strcmp(io->kind, "timer") != 0) continue;
    timers_.push_back(std::make_unique<TimerShim>(avr_, reinterpret_cast<avr_timer_t*>(io), *pins_));
  }
  for (unsigned addr = 32; addr < MAX_IOs + 32U; ++addr) {
    auto watched = std::make_unique<Register>();
    for (const auto& timer : timers_) {
      if (timer->watches(static_cast<avr_io_addr_t>(addr))) watched->timers.push_back(timer.get());
    }
    if (watched->timers.empty()) continue;
    auto& io = avr_->io[AVR_DATA_TO_IO(addr)];
    watched->write = io.w.c;
    watched->write_param = io.w.param;
    for (auto* timer : watched->timers) {
      if (timer->countRegister() == addr) {
        timer->setCountWriter(io.w.c, io.w.param);
        watched->read = io.r.c;
        watched->read_param = io.r.param;
        io.r.c = onCountRead;
        io.r.param = watched.get();
      }
      if (timer->controlRegister() == addr) timer->setControlWriter(io.w.c, io.w.param);
    }
    io.w.c = onRegisterWrite;
    io.w.param = watched.get();
    registers_.push_back(std::move(watched));
  }
}

void Machine::hookUart() {
  for (avr_io_t* io = avr_->io_port; io != nullptr; io = io->next) {
    if (std::strcmp(io->kind, "uart") != 0) continue;
    auto* uart = reinterpret_cast<avr_uart_t*>(io);
    uart->flags = 0;  // neither copies to the console nor real sleeps
    if (uart->name == '0') uart_ = uart;
  }
  if (uart_ == nullptr) return;
  avr_irq_register_notify(uart_->io.irq + UART_IRQ_OUTPUT, onUartOut, this);
  avr_irq_register_notify(uart_->io.irq + UART_IRQ_OUT_XON, onUartXon, this);
  avr_irq_register_notify(uart_->io.irq + UART_IRQ_OUT_XOFF, onUartXoff, this);
  for (const unsigned addr : {unsigned{uart_->ubrrl.reg}, unsigned{uart_->ubrrh.reg},
                              unsigned{uart_->r_ucsra}, unsigned{uart_->r_ucsrb}, unsigned{uart_->r_ucsrc}}) {
    if (addr != 0) hookUartSetup(addr);
  }
}

void Machine::hookUartSetup(unsigned addr) {
  auto watched = std::make_unique<Register>();
  auto& writer = avr_->io[AVR_DATA_TO_IO(addr)].w;
  watched->owner = this;
  watched->write = std::exchange(writer.c, onUartSetup);
  watched->write_param = std::exchange(writer.param, static_cast<void*>(watched.get()));
  registers_.push_back(std::move(watched));
}

void Machine::afterReset() {
  avr_->run_cycle_limit = 1;
  for (std::uint8_t i = 0; i < EXTINT_COUNT; ++i) avr_extint_set_strict_lvl_trig(avr_, i, 0);
  for (const auto& timer : timers_) timer->afterReset();
  pins_->refresh();
  pins_->redrive();
  xoff_ = false;
  service_due_ = false;
  asleep_ = false;
}

void Machine::Register::writeOn(avr_t* avr, avr_io_addr_t addr, std::uint8_t value) const {
  if (write != nullptr) {
    write(avr, addr, value, write_param);
  } else {
    avr_core_watch_write(avr, addr, value);
  }
}

void Machine::onRegisterWrite(avr_t* avr, avr_io_addr_t addr, std::uint8_t value, void* param) {
  const auto& watched = *static_cast<const Register*>(param);
  for (auto* timer : watched.timers) timer->beforeWrite(addr);
  watched.writeOn(avr, addr, value);
  for (auto* timer : watched.timers) timer->afterWrite(addr);
}

std::uint8_t Machine::onCountRead(avr_t* avr, avr_io_addr_t addr, void* param) {
  const auto& watched = *static_cast<const Register*>(param);
  return watched.timers.front()->running() ? watched.read(avr, addr, watched.read_param) : avr->data[addr];
}

void Machine::onUartOut(avr_irq_t* /*irq*/, std::uint32_t value, void* param) {
  auto& self = *static_cast<Machine*>(param);
  self.watchUart();
  const std::uint64_t start =
      self.sent_.empty() ? self.avr_->cycle : std::max(self.avr_->cycle, self.sent_.back().done_at);
  self.sent_.push_back({start + self.uart_->cycles_per_byte, static_cast<std::uint8_t>(value)});
}

void Machine::onUartXon(avr_irq_t* /*irq*/, std::uint32_t /*value*/, void* param) {
  auto& self = *static_cast<Machine*>(param);
  if (!self.xoff_) return;
  self.xoff_ = false;
  self.avr_->run_cycle_count = 0;  // look at the line again
}

void Machine::onUartXoff(avr_irq_t* /*irq*/, std::uint32_t value, void* param) {
  if (value != 0) static_cast<Machine*>(param)->xoff_ = true;
}

void Machine::onUartSetup(avr_t* avr, avr_io_addr_t addr, std::uint8_t value, void* param) {
  const auto& watched = *static_cast<const Register*>(param);
  watched.writeOn(avr, addr, value);
  watched.owner->setByteTime();
}

unsigned Machine::cyclesPerBit() const {
  const unsigned divider = avr_->data[uart_->r_ucsra] >> uart_->u2x.bit & uart_->u2x.mask ? 8U : 16U;
  const unsigned rate = avr_->data[uart_->ubrrl.reg] | (avr_->data[uart_->ubrrh.reg] & 0x0FU) << 8U;
  return divider * (rate + 1);
}

// simavr counts a parity bit always, and looks at U2X only when UBRRL is written.
void Machine::setByteTime() {
  static constexpr std::array<unsigned, 8> kDataBits{5, 6, 7, 8, 8, 8, 8, 9};
  const unsigned size =
      avr_regbit_get(avr_, uart_->ucsz) | static_cast<unsigned>(avr_regbit_get(avr_, uart_->ucsz2) << 2);
  const unsigned parity = uart_->r_ucsrc != 0 && (avr_->data[uart_->r_ucsrc] & 0x30U) != 0 ? 1 : 0;
  uart_->cycles_per_byte = avr_cycle_count_t{cyclesPerBit()} *
                           (1 + kDataBits[size & 7U] + parity + 1 + avr_regbit_get(avr_, uart_->usbs));
}

/// A byte is under way: whether it would be heard.
void Machine::watchUart() {
  if (options_.baud == 0 || !misheard_.empty()) return;
  const auto bits = static_cast<unsigned>(uart_->cycles_per_byte / cyclesPerBit());
  const double rate = static_cast<double>(options_.clock_hz) / static_cast<double>(cyclesPerBit());
  char text[160] = "";
  if (emulator::missesBytes(rate, options_.baud)) {
    std::snprintf(text, sizeof text,
                  "the firmware's UART runs at %.0f baud, with a clock of %llu Hz, and the bench at %u", rate,
                  static_cast<unsigned long long>(options_.clock_hz), options_.baud);
  } else if (bits != emulator::kBitsPerByte) {
    std::snprintf(text, sizeof text,
                  "a byte of the firmware's UART takes %u bits, and the bench has %u (8N1)", bits,
                  emulator::kBitsPerByte);
  }
  misheard_ = text;
  if (!misheard_.empty()) avr_->run_cycle_count = 0;
}

void Machine::onLog(avr_t* avr, int level, const char* format, va_list arguments) {
  if (level > LOG_WARNING) return;
  char line[256];
  std::vsnprintf(line, sizeof line, format, arguments);
  line[std::strcspn(line, "\n")] = '\0';
  removeColours(line);
  static unsigned lines = 0;
  if (lines < kMaxLogLines) std::fprintf(stderr, "simavr: %s\n", line);
  if (lines++ == kMaxLogLines) std::fprintf(stderr, "simavr: further lines left out\n");
  // simavr logs an opcode that does not exist and goes on as if it were a NOP.
  if (g_machine != nullptr && std::strstr(line, "Invalid Opcode") != nullptr) {
    if (g_machine->crash_.empty()) g_machine->crash_ = "invalid opcode";
    if (avr != nullptr) avr->run_cycle_count = 0;
  } else if (g_machine != nullptr && level <= LOG_ERROR && std::strstr(line, "Invalid") != nullptr &&
             g_machine->crash_.empty() && avr != nullptr) {
    g_machine->crash_ = line;
    avr->run_cycle_count = 0;
  }
}

emulator::Clock Machine::clock() const {
  constexpr std::uint32_t kStampError =
      2;  // The store's cycle inside its instruction, and the interrupt's latency.
  return {1, options_.clock_hz, kStampError};
}

std::string Machine::configuration() const {
  return "simavr 1.6, own instructions and stepping; shims: zero-TOP CTC, kept and exact TCNT, late-enabled "
         "interrupts, ICR as TOP, "
         "compare outputs apart from PORT, buffered fast PWM, single-bit SBI on PIN, external input levels, "
         "10-bit UART, interrupt entry and wake-up cycles, no strict level interrupts; mcu " +
         options_.mcu + " at " + std::to_string(options_.clock_hz) + " Hz, " + std::to_string(options_.baud) +
         " baud";
}

void Machine::drive(std::uint64_t tick, std::uint16_t port, std::uint16_t bit, bool level) {
  if (!inputs_.empty() && tick < inputs_.back().tick) throw std::runtime_error("DRIVE goes back in time");
  inputs_.push_back({tick, port, bit, level});
}

void Machine::send(std::span<const std::uint8_t> bytes) {
  if (to_send_.empty() && next_byte_at_ < watermark_) {
    next_byte_at_ = watermark_;
    pace_.restart();
  }
  to_send_.insert(to_send_.end(), bytes.begin(), bytes.end());
}

std::uint64_t Machine::nextInput() const {
  const std::uint64_t pin = inputs_.empty() ? kNever : inputs_.front().tick;
  return to_send_.empty() || xoff_ ? pin : std::min(pin, next_byte_at_);
}

// simavr lets a timer see the cycle at which the instruction ended; here it sees its own.
void Machine::runTimersTo(std::uint64_t tick) {
  const auto cycle = avr_->cycle;
  pins_->setInTimer(true);
  while (avr_->cycle_timers.timer != nullptr && avr_->cycle_timers.timer->when <= tick && !pins_->flooded()) {
    avr_->cycle = avr_->cycle_timers.timer->when;
    avr_cycle_timer_process(avr_);
  }
  pins_->setInTimer(false);
  avr_->cycle = cycle;
}

void Machine::feedInputs() {
  while (!inputs_.empty() && inputs_.front().tick <= avr_->cycle) {
    const Input input = inputs_.front();
    inputs_.pop_front();
    pins_->drive(input.port, input.bit, input.level);
  }
  if (!to_send_.empty() && !xoff_ && next_byte_at_ <= avr_->cycle) {
    const auto byte = to_send_.front();
    to_send_.pop_front();
    // After an XOFF the line has been idle: no catching up.
    const std::uint64_t period = pace_.next();
    next_byte_at_ = next_byte_at_ + period > avr_->cycle ? next_byte_at_ + period : avr_->cycle + period;
    if (uart_ != nullptr && avr_regbit_get(avr_, uart_->rxen) != 0) watchUart();
    if (uart_ != nullptr) avr_raise_irq(uart_->io.irq + UART_IRQ_INPUT, byte);
  }
}

void Machine::serviceInterrupts() {
  const bool enabled = avr_->sreg[S_I] != 0;
  avr_service_interrupts(avr_);
  // simavr enters an interrupt in no time: 4 cycles, 5 where an address has three bytes.
  if (enabled && avr_->sreg[S_I] == 0) avr_->cycle += avr_->address_size > 2 ? 5 : 4;
}

void Machine::sleepTo(std::uint64_t until) {
  if (avr_->interrupt_state != 0) {
    avr_->cycle += 1;
  } else {
    std::uint64_t next = std::min(until, nextInput());
    if (avr_->cycle_timers.timer != nullptr)
      next = std::min<std::uint64_t>(next, avr_->cycle_timers.timer->when);
    avr_->cycle = std::max<std::uint64_t>(avr_->cycle, next);
  }
  service_due_ = true;
}

void Machine::runInstructions(std::uint64_t until) {
  core_->run(std::min(until, nextInput()));
  service_due_ = true;
}

/// Whether the firmware has crashed, or speaks at another rate; the result says so then.
bool Machine::hasFailed(RunResult& result) const {
  if (avr_->state == cpu_Crashed || !crash_.empty()) {
    char where[64];
    std::snprintf(where, sizeof where, "the firmware crashed near address 0x%05x at cycle %llu: ", avr_->pc,
                  static_cast<unsigned long long>(avr_->cycle));
    result.stop = KB_PS_CRASHED;
    result.message = where + (crash_.empty() ? "the program counter left the flash" : crash_);
  } else if (!misheard_.empty()) {
    result.stop = KB_PS_MISHEARD;
    result.message = misheard_;
  }
  return result.stop != KB_PS_REACHED;
}

RunResult Machine::run(std::uint64_t until) {
  RunResult result;
  const auto finish = [&](kb_ps_stop stop, std::string message) {
    result.stop = stop;
    result.message = std::move(message);
  };
  while (result.stop == KB_PS_REACHED) {
    runTimersTo(std::min<std::uint64_t>(avr_->cycle, until));
    if (pins_->flooded()) {
      finish(KB_PS_FLOODED,
             "more than " + std::to_string(options_.max_events) + " pin events in one quantum");
      break;
    }
    if (avr_->run != avr_callback_run_raw) {  // The watchdog asks for a reset through this pointer.
      avr_->run(avr_);
      avr_->run = avr_callback_run_raw;
      afterReset();
    }
    if (hasFailed(result)) break;
    if (avr_->cycle >= until) break;
    feedInputs();
    if (asleep_ && avr_->state == cpu_Running) {  // simavr wakes in no time.
      asleep_ = false;
      avr_->cycle += kWakeCycles;
      continue;
    }
    if (service_due_) {
      service_due_ = false;
      const auto before = avr_->cycle;
      if (avr_->interrupt_state != 0) serviceInterrupts();
      if (avr_->cycle != before) continue;
    }
    if (avr_->state == cpu_Sleeping) {
      if (avr_->sreg[S_I] == 0) {
        finish(KB_PS_ENDED, "the firmware sleeps with interrupts off: nothing can wake it");
        break;
      }
      asleep_ = true;
      sleepTo(until);
    } else if (avr_->state == cpu_Running) {
      runInstructions(until);
    } else {
      finish(KB_PS_CRASHED, "simavr stopped in state " + std::to_string(avr_->state));
    }
  }
  // An instruction may have run on past a stop; nothing at or before its end can follow.
  result.watermark =
      result.stop == KB_PS_REACHED ? until : std::clamp<std::uint64_t>(avr_->cycle + 1, watermark_, until);
  watermark_ = result.watermark;
  result.events = pins_->take();
  std::erase_if(result.events, [&](const PinEvent& event) { return event.tick > result.watermark; });
  while (!sent_.empty() && sent_.front().done_at <= result.watermark) {
    result.uart.push_back(sent_.front().byte);
    sent_.pop_front();
  }
  return result;
}

}  // namespace kerfbench::avr_child
