// SPDX-License-Identifier: GPL-3.0-or-later
// Both mirrors at full speed at once, one of them following the belt's encoder, the UART never at rest: every
// pulse is counted against the program, period by period, and the interrupts are timed. Linked with simavr,
// hence the licence.
//
//     avr_rates IMAGE.hex SECONDS
//
// Asserts what docs/reference/controller.md states.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>

#include "avr_harness_bench.h"
#include "firmware_under_test/planner/program/link.h"

namespace {

using namespace kerfbench::avr_bench;
using kerfbench::planner::Link;

constexpr double kHz = 16e6;
constexpr std::uint64_t kPeriodCycles = 12800;
constexpr double kCountsPerPeriod = 32.0;  // 40 000 counts/s: edges of A at 20 kHz
constexpr double kSwing = 0.01;  // Share by which the belt is faster and slower than the program assumes.
constexpr double kSwingPeriods = 2500.0;  // Period of the swing: 2 s.
// Cycles from a period's border to a time at which none of its pulses can come.
constexpr std::uint64_t kBorder = 365;
constexpr int kOffset = 40;  // Counts from the mark to the first period.
// Most steps: 35 and 38.75 kHz; three steps of X are left for the following.
constexpr int kMostX = 28, kMostY = 31;

// Limits of docs/reference/controller.md.
constexpr std::uint64_t kLongestTick = 300, kLongestMark = 180, kLongestOther = 100, kLatestTick = 260,
                        kLatestUart = 640;
constexpr double kWorstFollow = 2.0;  // Limit in steps; here a step is a count.
constexpr std::size_t kSettled = 50;
constexpr double kLeastRateHz = 25e3;

struct Job {
  std::vector<std::array<int, 2>> steps;  // Steps of X and Y in each period.
  std::vector<std::array<int, 2>> seen;
  std::uint64_t start{kNever};
  double counts{}, counts_at_mark{};
  std::uint64_t count_at{};
  std::vector<double> belt;  // Belt in counts beyond the mark, at the end of each period.
};

/// Job that goes back and forth with reversals at full speed, and slow stretches in between.
Job jobOf(int periods) {
  Job job;
  std::uint32_t random = 2026;
  int left = 0, x = 0, y = 0;
  // The first period marks the start: a single step comes in the middle of its period.
  job.steps.push_back({0, 1});
  for (int i = 1; i < periods; ++i) {
    if (left-- == 0) {
      random = random * 1664525U + 1013904223U;
      left = 2 + static_cast<int>(random >> 28);
      const bool slow = (random >> 20 & 31U) == 0;
      const int sign = (random & 0x10000U) != 0 ? 1 : -1;
      x = (x > 0 ? -1 : 1) * (slow ? static_cast<int>(random >> 24 & 7U) : kMostX);
      y = sign * (slow ? static_cast<int>(random >> 12 & 7U) : kMostY);
    }
    job.steps.push_back({x, y});
  }
  return job;
}

kerfbench::planner::Program programOf(const Job& job) {
  kerfbench::planner::Program program;
  program.config.reserve(KB_CONFIG_LEN);
  putU32(program.config, static_cast<std::uint32_t>(std::lround(kCountsPerPeriod * 65536.0)));
  for (const int byte : {8, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 31, 31, 31, 31, 31, 31, 31, 31, 31, 31})
    program.config.push_back(static_cast<std::uint8_t>(byte));
  kerfbench::controller_test::appendNoField(program.config);
  program.ops.push_back({KB_OP_FOLLOW, KB_GALVO_X + 1});
  program.ops.push_back({KB_OP_WAIT_MARK, kOffset, 0, 0, 0});
  int power = 0;
  for (const auto& steps : job.steps) {
    program.ops.push_back({KB_OP_MOVE | KB_OP_GAIN | KB_OP_POWER | 3, static_cast<std::uint8_t>(steps[0]),
                           static_cast<std::uint8_t>(steps[1]), static_cast<std::uint8_t>(power++), 0x00,
                           0x10});  // gain 4096: one step a count
  }
  program.ops.push_back({KB_OP_END});
  return program;
}

void onStep(Bench& bench, std::size_t axis) {
  if (axis > KB_GALVO_Y) return;
  Job& job = *static_cast<Job*>(bench.context);
  const std::uint64_t now = bench.avr->cycle;
  const int sign = (bench.levels['A'] >> bench.axes[axis].dir & 1U) != 0 ? 1 : -1;
  // A period's first pulse comes a tick after its border, its last with the next border, each up to 300
  // cycles late. The single step comes with the sixteenth tick, whose time is known exactly.
  if (job.start == kNever && axis == KB_GALVO_Y) {
    job.start = bench.tick().asked - 16 * KB_TICK_CYCLES + kBorder;
    // X has followed since the border.
    job.seen.push_back({static_cast<int>(bench.axes[KB_GALVO_X].position), 0});
  }
  if (job.start == kNever) return;
  const std::size_t period = (now - job.start) / kPeriodCycles;
  if (period >= job.seen.size()) job.seen.resize(period + 1);
  job.seen[period][axis] += sign;
}

/// Swings the belt's speed.
void onCount(Bench& bench) {
  Job& job = *static_cast<Job*>(bench.context);
  const std::uint64_t now = bench.avr->cycle;
  if (bench.mark_rise != 0 && job.counts_at_mark == 0.0) {
    job.counts_at_mark = job.counts + static_cast<double>(bench.mark_rise - job.count_at) /
                                          static_cast<double>(now - job.count_at);
  }
  while (job.start != kNever && now > job.start - kBorder + (job.belt.size() + 1) * kPeriodCycles) {
    const std::uint64_t end = job.start - kBorder + (job.belt.size() + 1) * kPeriodCycles;
    const double part = (static_cast<double>(end) - static_cast<double>(job.count_at)) /
                        static_cast<double>(now - job.count_at);
    job.belt.push_back(job.counts + part - job.counts_at_mark);
  }
  job.counts += 1.0;
  job.count_at = now;
  const double phase =
      2.0 * std::numbers::pi * static_cast<double>(bench.avr->cycle) / kPeriodCycles / kSwingPeriods;
  bench.encoder_period = static_cast<std::uint64_t>(std::lround(400.0 / (1.0 + kSwing * std::sin(phase))));
}

void say(const char* what, double value, const char* unit) {
  std::printf("      %s: %.2f %s\n", what, value, unit);
}

/// Checks the pulses against the program, period by period.
void checkPulses(const Bench& bench, const Job& job) {
  long want_x = 0, want_y = 0, seen_x = 0, wrong_y = 0, pulses_y = 0, least = 1 << 30;
  double worst_follow = 0.0;
  long in_window[2]{};
  constexpr std::size_t kWindow = 1250;  // a second
  for (std::size_t i = 0; i < job.steps.size(); ++i) {
    const auto seen = i < job.seen.size() ? job.seen[i] : std::array<int, 2>{};
    want_x += job.steps[i][0];
    want_y += job.steps[i][1];
    pulses_y += std::abs(job.steps[i][1]);
    seen_x += seen[0];
    wrong_y += seen[1] != job.steps[i][1] ? 1 : 0;
    // A belt that is ahead at the start is caught up with three steps a period.
    if (i > kSettled) {
      const double ahead = job.belt[i] - kOffset - kCountsPerPeriod * static_cast<double>(i + 1);
      worst_follow = std::max(worst_follow, std::abs(ahead - static_cast<double>(seen_x - want_x)));
    }
    for (int axis = 0; axis < 2; ++axis) {
      in_window[axis] += std::abs(seen[static_cast<std::size_t>(axis)]);
      if (i >= kWindow) in_window[axis] -= std::abs(job.seen[i - kWindow][static_cast<std::size_t>(axis)]);
      if (i + 1 >= kWindow) least = std::min(least, in_window[axis]);
    }
  }
  const Axis& x = bench.axes[KB_GALVO_X];
  const Axis& y = bench.axes[KB_GALVO_Y];
  std::printf("X: %ld pulses, Y: %ld pulses, %.1f s; slowest second of either: %.2f kHz\n", x.steps, y.steps,
              static_cast<double>(job.steps.size()) * kPeriodCycles / kHz, 1e-3 * static_cast<double>(least));
  check(wrong_y == 0 && y.steps == pulses_y && y.position == want_y,
        "Y: every period has exactly the program's pulses: " + std::to_string(y.steps) + " of " +
            std::to_string(pulses_y));
  check(x.position == want_x,
        "X: ends where the program ends: " + std::to_string(x.position) + " of " + std::to_string(want_x));
  say("X beside program and belt", worst_follow, "steps at most");
  check(worst_follow <= kWorstFollow, "X: is where program and belt want it at the end of every period");
  check(static_cast<double>(least) >= kLeastRateHz, "both mirrors make 25 kHz and more in every second");
}

void checkTiming(Bench& bench) {
  // Limits of galvo-pul-dir in fixtures/machines/drivers.yaml: set-up and hold 5 us, width and space 2.5 us.
  std::uint64_t setup = kNever, hold = kNever, width = kNever, space = kNever;
  for (const Axis& axis : bench.axes) {
    setup = std::min(setup, axis.min_setup);
    hold = std::min(hold, axis.min_hold);
    width = std::min(width, axis.min_width);
    space = std::min(space, axis.min_space);
  }
  say("DIR set up", static_cast<double>(setup) / 16.0, "us at least");
  say("DIR held", static_cast<double>(hold) / 16.0, "us at least");
  say("PUL active", static_cast<double>(width) / 16.0, "us at least");
  say("PUL idle", static_cast<double>(space) / 16.0, "us at least");
  check(setup >= KB_SETUP_CYCLES && hold >= KB_HOLD_CYCLES && width >= KB_WIDTH_CYCLES &&
            space >= KB_SPACE_CYCLES,
        "PUL and DIR keep what the release says of itself");
  // Ticks never overlap, however late one is: the next begins when it has ended.
  say("from DIR to the tick's end, on to the next tick at the earliest, and to its PUL",
      static_cast<double>(bench.min_tail + bench.min_gap + bench.min_head) / 16.0, "us at least");
  check(bench.min_tail + bench.min_gap + bench.min_head >= std::max(KB_SETUP_CYCLES, KB_SPACE_CYCLES),
        "and would keep DIR's set-up and PUL's pause at any delay of a tick");
  std::uint64_t in_interrupts = 0;
  for (const Vector& vector : bench.vectors) {
    if (vector.number == 18) continue;  // The vector is not used here.
    std::printf(
        "      %-20s %9llu calls, longest %3llu cycles (%.2f us), mean %.1f; latest start %3llu cycles after "
        "its cause\n",
        vector.name, static_cast<unsigned long long>(vector.count),
        static_cast<unsigned long long>(vector.longest), static_cast<double>(vector.longest) / 16.0,
        static_cast<double>(vector.sum) / static_cast<double>(std::max<std::uint64_t>(vector.count, 1)),
        static_cast<unsigned long long>(vector.latest));
    in_interrupts += vector.sum;
    const std::uint64_t stated = &vector == &bench.tick() ? kLongestTick
                                 : vector.number == 4     ? kLongestMark
                                                          : kLongestOther;
    check(vector.count > 0 && vector.longest <= stated,
          std::string(vector.name) + ": takes no longer than stated");
  }
  check(bench.tick().latest <= kLatestTick, "a tick starts no later than stated");
  check(bench.vectors[3].latest < kLatestUart, "a byte is taken before the next one comes");
  say("share of the processor in interrupts",
      100.0 * static_cast<double>(in_interrupts) / static_cast<double>(bench.avr->cycle), "%");
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc == 3 ? std::atof(argv[2]) : 0.0;
  if (!(seconds >= 3.0) || seconds > 3600.0) {
    std::fprintf(stderr, "usage: avr_rates IMAGE.hex SECONDS (3 … 3600)\n");
    return 64;
  }
  Job job = jobOf(static_cast<int>(seconds * kHz / kPeriodCycles));
  Bench bench;
  bench.context = &job;
  bench.on_step = onStep;
  bench.on_count = onCount;
  load(bench, argv[1]);
  bench.encoder_period = 400;
  startBelt(bench, 100000);
  raiseMarkAt(bench, 8000000);

  Link link(programOf(job));
  const auto most_cycles = static_cast<std::uint64_t>((seconds + 3.0) * kHz);
  std::uint64_t at = 0;
  while (link.state() != Link::State::kDone && link.state() != Link::State::kFailed && at < most_cycles) {
    at += 1600;
    serve(bench, link, at);
    bench.running = link.state() == Link::State::kRunning;
  }
  std::printf("link: %s\n", link.message().c_str());
  check(link.state() == Link::State::kDone, "the program is done");
  const auto expected_ticks = static_cast<double>(bench.avr->cycle - bench.first_tick) / KB_TICK_CYCLES;
  check(std::abs(static_cast<double>(bench.ticks) - expected_ticks) < 3.0,
        "a tick each 400 cycles: " + std::to_string(bench.ticks));
  checkPulses(bench, job);
  checkTiming(bench);
  return failures() == 0 ? 0 : 1;
}
