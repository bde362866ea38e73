// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/own_job/mcs51_controller.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firmware_under_test/planner/job/job.h"

namespace kerfbench::planner {
namespace {

/// Times of job.c.in in clocks: of the longest and shortest ways through its tick, by the tables of
/// instructions of Intel 1994 (12 clocks a machine cycle) and STC 2015.
/// tests/firmware_under_test/planner/own_job measures them in the emulator.
struct Core {
  int tick, width, hold, setup, space, late;
};
constexpr Core kTwelveClocks{
    .tick = 172 * 12, .width = 16 * 12, .hold = 16 * 12, .setup = 38 * 12, .space = 28 * 12, .late = 4 * 12};
constexpr Core kOneClock{.tick = 318, .width = 32, .hold = 32, .setup = 65, .space = 48, .late = 12};

struct Part {
  std::string_view name;
  std::size_t code_bytes;
  const Core* core;
};
constexpr std::array kParts{
    Part{"80c51", 4096, &kTwelveClocks},     Part{"8051", 4096, &kTwelveClocks},
    Part{"at89c51", 4096, &kTwelveClocks},   Part{"at89s51", 4096, &kTwelveClocks},
    Part{"80c52", 8192, &kTwelveClocks},     Part{"8052", 8192, &kTwelveClocks},
    Part{"at89c52", 8192, &kTwelveClocks},   Part{"at89s52", 8192, &kTwelveClocks},
    Part{"stc15f2k08s2", 8192, &kOneClock},  Part{"stc15f2k16s2", 16384, &kOneClock},
    Part{"stc15w4k16s4", 16384, &kOneClock}, Part{"stc15f2k32s2", 32768, &kOneClock},
    Part{"stc15w4k32s4", 32768, &kOneClock}, Part{"stc15f2k60s2", 61440, &kOneClock},
};

constexpr int kClocksOfCount = 12;
constexpr int kMostCounts = 256;
constexpr std::size_t kProgramBytes = 520;

std::vector<std::string> names(std::size_t least_bytes) {
  std::vector<std::string> all;
  for (const Part& part : kParts) {
    if (part.code_bytes >= least_bytes) all.emplace_back(part.name);
  }
  return all;
}

Target targetFor(const Core& core, double clock_hz, int counts) {
  Target target;
  const auto seconds = [&](int clocks) { return clocks / clock_hz; };
  target.tick_s = seconds(counts * kClocksOfCount);
  target.ticks_per_period = 32;
  target.max_steps = 31;
  target.longest_delay_ticks = 31;
  target.setup_s = seconds(core.setup);
  target.hold_s = seconds(core.hold);
  target.width_s = seconds(core.width);
  target.space_s = seconds(core.space);
  target.late_s = seconds(core.late);
  target.name = "mcs51, a program that holds its job";
  return target;
}

/// Everything wrong with the pins.
std::vector<std::string> pinIssues(const Mcs51Controller& controller) {
  std::vector<std::string> issues;
  std::vector<Mcs51Pin> taken{{1, 0}, {1, 1}, {1, 2}, {1, 3}};
  const std::array<std::pair<std::string_view, const std::string*>, 5> pins{
      {{"--gate-pin", &controller.gate_pin},
       {"--pwm-pin", &controller.pwm_pin},
       {"--start-pin", &controller.start_pin},
       {"--mark-pin", &controller.mark_pin},
       {"--guard-pin", &controller.guard_pin}}};
  for (const auto& [option, name] : pins) {
    try {
      const Mcs51Pin pin = pinFrom(*name);
      if (std::ranges::find(taken, pin) != taken.end())
        issues.push_back(fmt::format("{} {}: the pin has another use", option, *name));
      taken.push_back(pin);
    } catch (const PlanError& error) {
      issues.push_back(fmt::format("{} {}", option, error.what()));
    }
  }
  return issues;
}

}  // namespace

std::string Mcs51Pin::name() const { return fmt::format("P{}.{}", port, bit); }

Mcs51Pin pinFrom(std::string_view name) {
  const bool fits = name.size() == 4 && (name[0] == 'P' || name[0] == 'p') && name[1] >= '0' &&
                    name[1] <= '3' && name[2] == '.' && name[3] >= '0' && name[3] <= '7';
  if (!fits) throw PlanError(fmt::format("{}: a pin is named P0.0 to P3.7", name));
  return {name[1] - '0', name[3] - '0'};
}

std::string partsWith(std::size_t code_bytes) {
  const std::vector<std::string> found = names(code_bytes);
  return found.empty() ? "none that is known" : fmt::format("{}", fmt::join(found, ", "));
}

Mcs51Account accountOf(const Mcs51Controller& controller) {
  std::vector<std::string> issues = pinIssues(controller);
  const auto refuse = [&] { throw PlanError(fmt::format("{}", fmt::join(issues, "\n"))); };
  const auto* part = std::ranges::find(kParts, std::string_view(controller.mcu), &Part::name);
  if (part == kParts.end())
    issues.push_back(fmt::format("--mcu {}: known are {}", controller.mcu, partsWith(0)));
  if (!(controller.clock_hz >= 1e6 && controller.clock_hz <= 40e6))
    issues.push_back(fmt::format("--clock {:g}: a clock has 1e6 to 40e6 Hz", controller.clock_hz));
  if (!issues.empty()) refuse();
  const double count_s = kClocksOfCount / controller.clock_hz;
  const int least = (part->core->tick + kClocksOfCount - 1) / kClocksOfCount;
  const double counts =
      controller.tick_s > 0.0 ? std::round(std::min(controller.tick_s / count_s, 1e6)) : double(least);
  if (counts < least || counts > kMostCounts) {
    issues.push_back(fmt::format(
        "--tick {:.2f}: that has {:.0f} clocks at {:g} MHz; the longest takes {}, and "
        "the timer counts to {}: {:.2f} to {:.2f} us would fit",
        controller.tick_s * kMicrosecondsPerSecond, counts * kClocksOfCount, controller.clock_hz * 1e-6,
        part->core->tick, kMostCounts * kClocksOfCount, least * count_s * kMicrosecondsPerSecond,
        kMostCounts * count_s * kMicrosecondsPerSecond));
    refuse();
  }
  return {.code_bytes = part->code_bytes,
          .program_bytes = kProgramBytes,
          .tick_clocks = part->core->tick,
          .timer_counts = static_cast<int>(counts),
          .has_port_modes = part->core == &kOneClock,
          .target = targetFor(*part->core, controller.clock_hz, static_cast<int>(counts))};
}

}  // namespace kerfbench::planner
