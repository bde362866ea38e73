// SPDX-License-Identifier: GPL-3.0-or-later
// How soon the AVR release puts the laser out, in cycles at its pins under simavr, whatever the moment at
// which guard, limit or line fail. Linked with simavr, hence the licence.
//
//     avr_safe_states CONTROLLER.hex ALL_STUCK.hex
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <stdexcept>
#include <string>
#include <vector>

#include <avr_extint.h>
#include <avr_ioport.h>
#include <avr_uart.h>
#include <sim_avr.h>
#include <sim_core.h>
#include <sim_hex.h>

#include "firmware_under_test/controller/protocol.h"
#include "firmware_under_test/planner/link.h"
#include "no_field.h"

namespace {

using kerfbench::planner::Link;
using kerfbench::planner::Program;

constexpr std::uint64_t kByteCycles = 640;
constexpr std::uint64_t kPeriodCycles = std::uint64_t{KB_TICK_CYCLES} * KB_TICKS_PER_PERIOD;
constexpr std::uint64_t kLaserOffCycles = 1600;              // 100 us
constexpr std::uint64_t kHostGivesUp = 400 * kPeriodCycles;  // it cannot ask any more, and waits 0.25 s

Program litProgram() {
  Program program;
  program.config.assign(17, 0);
  program.config.resize(27, KB_MAX_STEPS_PER_PERIOD);
  kerfbench::controller_test::appendNoField(program.config);
  for (int i = 0; i < 1500; ++i)
    program.ops.push_back({KB_OP_MOVE | KB_OP_POWER | 0x0F, 31, 0xE1, 29, 0xE5, 255});
  program.ops.push_back({KB_OP_END});
  return program;
}

/// A release with guard and limits at rest, its host on the line, and what its laser and its axes do.
class Rig {
 public:
  explicit Rig(const char* image) : avr_(avr_make_mcu_by_name("atmega2560")), link_(litProgram()) {
    avr_init(avr_);
    avr_->frequency = KB_CPU_HZ;
    avr_->sleep = [](avr_t*, avr_cycle_count_t) {};
    avr_->log = LOG_ERROR;
    std::uint32_t size = 0, base = 0;
    std::uint8_t* const bytes = read_ihex_file(image, &size, &base);
    if (bytes == nullptr) throw std::runtime_error(std::string("cannot read ") + image);
    std::memcpy(avr_->flash + base, bytes, size);
    std::free(bytes);
    avr_->codeend = avr_->flashend;
    std::uint32_t flags = 0;
    avr_ioctl(avr_, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    rx_ = avr_io_getirq(avr_, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
    avr_irq_register_notify(
        avr_io_getirq(avr_, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT),
        [](avr_irq_t*, std::uint32_t value, void* self) {
          static_cast<Rig*>(self)->heard_.push_back(static_cast<std::uint8_t>(value));
        },
        this);
    afterReset();
    hookPort('A', [](avr_irq_t*, std::uint32_t value, void* self) {
      auto& rig = *static_cast<Rig*>(self);
      if ((value & ~rig.port_a_ & 0x55U) != 0) rig.last_pulse = rig.avr_->cycle;
      rig.port_a_ = value;
    });
    hookPort('C', [](avr_irq_t*, std::uint32_t value, void* self) {
      auto& rig = *static_cast<Rig*>(self);
      rig.gate(value);
    });
  }
  ~Rig() { avr_terminate(avr_); }
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  void input(int bit, bool level) {
    avr_raise_irq(avr_io_getirq(avr_, AVR_IOCTL_IOPORT_GETIRQ('L'), bit), level ? 1 : 0);
  }
  /// What the line carries, whatever the host says. 0x8000: with a framing error.
  void line(std::uint32_t word) { avr_raise_irq(rx_, word); }

  void runTo(std::uint64_t cycle) {
    while (avr_->cycle < cycle) {
      if (avr_->cycle >= next_byte_) {
        next_byte_ = avr_->cycle + kByteCycles;
        if (!to_controller_.empty() && !host_silent) {
          avr_raise_irq(rx_, to_controller_.front());
          to_controller_.pop_front();
        }
      }
      if (avr_->cycle >= next_step_) {
        next_step_ = avr_->cycle + 1600;
        std::vector<std::uint8_t> heard;
        heard.swap(heard_);
        const auto bytes = link_.step(heard, static_cast<double>(avr_->cycle) / KB_CPU_HZ);
        to_controller_.insert(to_controller_.end(), bytes.begin(), bytes.end());
      }
      avr_run(avr_);
      if (avr_->run != avr_callback_run_raw) {  // how simavr's watchdog asks for a reset
        avr_->run(avr_);
        avr_->run = avr_callback_run_raw;
        afterReset();
        gate(0);
        ++resets;
      }
    }
  }
  /// Until the laser is on and the job under way, then to this cycle of a period.
  void runIntoCut(std::uint64_t phase) {
    while (gate_on_ == 0 && avr_->cycle < KB_CPU_HZ) runTo(avr_->cycle + 1000);
    if (gate_on_ == 0) throw std::runtime_error("the laser never came on: " + link_.message());
    runTo(gate_on_ + 40 * kPeriodCycles + phase);
  }
  [[nodiscard]] std::uint64_t now() const { return avr_->cycle; }
  [[nodiscard]] bool lit() const { return lit_; }
  [[nodiscard]] std::string message() const { return link_.message(); }

  std::uint64_t gate_fall{}, last_pulse{};
  int resets{};
  bool host_silent{};

 private:
  void hookPort(char port, avr_irq_notify_t notify) {
    avr_irq_register_notify(avr_io_getirq(avr_, AVR_IOCTL_IOPORT_GETIRQ(port), IOPORT_IRQ_REG_PORT), notify,
                            this);
  }
  void afterReset() {
    avr_->pc = 0;
    for (std::uint8_t i = 0; i < 8; ++i) avr_extint_set_strict_lvl_trig(avr_, i, 0);
    input(0, false);
    input(1, false);
    input(2, true);
  }
  void gate(std::uint32_t port_c) {
    const bool lit = (port_c & 4U) != 0;
    if (lit && gate_on_ == 0) gate_on_ = avr_->cycle;
    if (!lit && lit_) gate_fall = avr_->cycle;
    lit_ = lit;
  }

  avr_t* avr_;
  Link link_;
  avr_irq_t* rx_{};
  std::deque<std::uint8_t> to_controller_;
  std::vector<std::uint8_t> heard_;
  std::uint64_t next_byte_{}, next_step_{}, gate_on_{};
  std::uint32_t port_a_{};
  bool lit_{};
};

int failures = 0;
void check(bool good, const std::string& what) {
  std::printf("%s  %s\n", good ? "ok  " : "FAIL", what.c_str());
  if (!good) ++failures;
}

/// Laser and axes after an input has changed, at moments all over a period.
void sweepInput(const char* image, const char* name, int bit, bool level, const char* reason) {
  std::uint64_t worst = 0, best = ~0ULL, worst_pulse = 0;
  bool told = true, dark = true;
  constexpr std::uint64_t kMoments = 48;
  for (std::uint64_t k = 0; k < kMoments; ++k) {
    Rig rig(image);
    rig.runIntoCut(k * (kPeriodCycles + 37) / kMoments);
    const std::uint64_t caused = rig.now();
    rig.input(bit, level);
    rig.runTo(caused + 4 * kPeriodCycles);
    rig.input(bit, !level);  // the cause goes away, the safe state stays
    rig.runTo(caused + 60 * kPeriodCycles);
    worst = std::max(worst, rig.gate_fall - caused);
    best = std::min(best, rig.gate_fall - caused);
    worst_pulse = std::max(worst_pulse, rig.last_pulse > caused ? rig.last_pulse - caused : 0);
    told = told && rig.message().find(reason) != std::string::npos;
    dark = dark && !rig.lit();
  }
  std::printf("%s: laser off after %.2f … %.2f us, last pulse %.2f us\n", name,
              static_cast<double>(best) / 16, static_cast<double>(worst) / 16,
              static_cast<double>(worst_pulse) / 16);
  check(worst <= kLaserOffCycles && dark, std::string(name) + ": laser off within 100 us, and for good");
  check(worst_pulse <= 2 * kPeriodCycles, std::string(name) + ": axes stand within two periods");
  check(told, std::string(name) + ": the reason is told");
}

void framingErrors(const char* image) {
  Rig rig(image);
  rig.runIntoCut(0);
  const std::uint64_t caused = rig.now();
  rig.host_silent = true;
  for (unsigned i = 0; i < KB_LINE_ERRORS_MAX; ++i) {  // a line held low
    rig.line(UART_INPUT_FE);
    rig.runTo(caused + (i + 1) * kByteCycles);
  }
  rig.runTo(caused + kHostGivesUp);
  const std::uint64_t known = caused + (KB_LINE_ERRORS_MAX - 1) * kByteCycles + 2 * kPeriodCycles;
  std::printf("framing errors: laser off %.1f us after the first of %u\n",
              static_cast<double>(rig.gate_fall - caused) / 16, KB_LINE_ERRORS_MAX);
  check(rig.gate_fall > caused && rig.gate_fall <= known + kLaserOffCycles && !rig.lit(),
        "framing errors: laser off within 100 us of the period that knows them");
  check(rig.message().find("disturbed") != std::string::npos, "framing errors: the reason is told");
}

/// Main loop and interrupts both stuck: the watchdog alone is left.
void allStuck(const char* image) {
  Rig rig(image);
  rig.runIntoCut(0);
  rig.line(KB_SYNC);  // a frame that never comes to its end
  rig.host_silent = true;
  const std::uint64_t caused = rig.now();
  rig.runTo(caused + kHostGivesUp);
  // Frames pause for 20 ms before they are given up, a period to notice, 16 ms of the watchdog.
  constexpr std::uint64_t kWindow = 320'000 + 2 * kPeriodCycles + 256'000;
  std::printf("all stuck: laser off %.2f ms after the broken frame, %d reset\n",
              static_cast<double>(rig.gate_fall - caused) / 16e3, rig.resets);
  check(rig.resets == 1, "all stuck: the watchdog resets once");
  check(rig.gate_fall > caused && rig.gate_fall <= caused + kWindow + kLaserOffCycles && !rig.lit(),
        "all stuck: laser off by the watchdog's reset");
  check(rig.message().find("watchdog") != std::string::npos, "all stuck: the reason is told");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 64;
  try {
    sweepInput(argv[1], "guard", 2, false, "interlock");
    sweepInput(argv[1], "limit", 0, true, "end-of-travel");
    framingErrors(argv[1]);
    allStuck(argv[2]);
  } catch (const std::exception& error) {
    std::printf("%s\n", error.what());
    return 1;
  }
  return failures == 0 ? 0 : 1;
}
