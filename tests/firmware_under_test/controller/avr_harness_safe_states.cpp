// SPDX-License-Identifier: GPL-3.0-or-later
// Time in which the AVR release turns the laser off, in cycles at its pins under simavr, at any moment of a
// failure of guard, limit or line. Linked with simavr, hence the licence.
//
//     avr_safe_states CONTROLLER.hex ALL_STUCK.hex
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>

#include <avr_uart.h>

#include "avr_harness_bench.h"

namespace avr_bench = kerfbench::avr_bench;
using namespace kerfbench::avr_bench;

namespace {

using kerfbench::planner::Link;
using kerfbench::planner::Program;

constexpr std::uint64_t kPeriodCycles = std::uint64_t{KB_TICK_CYCLES} * KB_TICKS_PER_PERIOD;
constexpr std::uint64_t kLaserOffCycles = 1600;  // 100 us
// Time after which a silent host gives up; it waits 0.25 s.
constexpr std::uint64_t kHostGivesUp = 400 * kPeriodCycles;

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

/// A release in the middle of a cut, with its laser and its axes.
class Rig {
 public:
  explicit Rig(const char* image) : link_(litProgram()) {
    bench.busy_wire = false;
    load(bench, image);
  }
  ~Rig() { unload(bench); }
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  /// Puts a word on the line, whatever the host says. 0x8000: with a framing error.
  void line(std::uint32_t word) { avr_raise_irq(bench.rx, word); }

  void runTo(std::uint64_t cycle) {
    while (now() < cycle) {
      avr_bench::runTo(bench, std::min(cycle, next_step_));
      if (now() < next_step_) continue;
      serve(bench, link_, now());
      next_step_ = now() + 1600;
    }
  }
  /// Runs until the laser is on and the job under way, then to this cycle of a period.
  void runIntoCut(std::uint64_t phase) {
    while (!lit() && now() < KB_CPU_HZ) runTo(now() + 1000);
    if (!lit()) throw std::runtime_error("the laser never came on: " + link_.message());
    runTo(bench.gate_rise + 40 * kPeriodCycles + phase);
  }
  [[nodiscard]] std::uint64_t now() const { return bench.avr->cycle; }
  [[nodiscard]] bool lit() const { return (bench.levels['C'] & 4U) != 0; }
  [[nodiscard]] std::string message() const { return link_.message(); }
  [[nodiscard]] std::uint64_t lastPulse() const {
    std::uint64_t last = 0;
    for (const Axis& axis : bench.axes)
      if (axis.rise != kNever) last = std::max(last, axis.rise);
    return last;
  }

  Bench bench;

 private:
  Link link_;
  std::uint64_t next_step_{};
};

/// Checks laser and axes after an input has changed, at moments all over a period.
void sweepInput(const char* image, const char* name, int bit, bool level, const char* reason) {
  std::uint64_t worst = 0, best = ~0ULL, worst_pulse = 0;
  bool told = true, dark = true;
  constexpr std::uint64_t kMoments = 48;
  for (std::uint64_t k = 0; k < kMoments; ++k) {
    Rig rig(image);
    rig.runIntoCut(k * (kPeriodCycles + 37) / kMoments);
    const std::uint64_t caused = rig.now();
    driveInput(rig.bench, 'L', bit, level ? 1 : 0);
    rig.runTo(caused + 4 * kPeriodCycles);
    driveInput(rig.bench, 'L', bit, level ? 0 : 1);  // The cause goes away, the safe state stays.
    rig.runTo(caused + 60 * kPeriodCycles);
    worst = std::max(worst, rig.bench.gate_fall - caused);
    best = std::min(best, rig.bench.gate_fall - caused);
    worst_pulse = std::max(worst_pulse, rig.lastPulse() > caused ? rig.lastPulse() - caused : 0);
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
  rig.bench.cut_line = true;
  for (unsigned i = 0; i < KB_LINE_ERRORS_MAX; ++i) {  // The line is held low.
    rig.line(UART_INPUT_FE);
    rig.runTo(caused + (i + 1) * kByteCycles);
  }
  rig.runTo(caused + kHostGivesUp);
  const std::uint64_t known = caused + (KB_LINE_ERRORS_MAX - 1) * kByteCycles + 2 * kPeriodCycles;
  std::printf("framing errors: laser off %.1f us after the first of %u\n",
              static_cast<double>(rig.bench.gate_fall - caused) / 16, KB_LINE_ERRORS_MAX);
  check(rig.bench.gate_fall > caused && rig.bench.gate_fall <= known + kLaserOffCycles && !rig.lit(),
        "framing errors: laser off within 100 us of the period that knows them");
  check(rig.message().find("disturbed") != std::string::npos, "framing errors: the reason is told");
}

/// Checks a release whose main loop and interrupts are both stuck: the watchdog alone is left.
void allStuck(const char* image) {
  Rig rig(image);
  rig.runIntoCut(0);
  rig.line(KB_SYNC);  // The frame never comes to its end.
  rig.bench.cut_line = true;
  const std::uint64_t caused = rig.now();
  rig.runTo(caused + kHostGivesUp);
  // The window: frames pause for 20 ms before they are given up, a period to notice, 16 ms of the watchdog.
  constexpr std::uint64_t kWindow = 320'000 + 2 * kPeriodCycles + 256'000;
  std::printf("all stuck: laser off %.2f ms after the broken frame, %d reset\n",
              static_cast<double>(rig.bench.gate_fall - caused) / 16e3, rig.bench.resets);
  check(rig.bench.resets == 1, "all stuck: the watchdog resets once");
  check(
      rig.bench.gate_fall > caused && rig.bench.gate_fall <= caused + kWindow + kLaserOffCycles && !rig.lit(),
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
  return failures() == 0 ? 0 : 1;
}
