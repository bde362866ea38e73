// SPDX-License-Identifier: GPL-3.0-or-later
// The AVR release under simavr, with the host half on its UART: exact step counts, pulse timing in cycles, a
// tick that never fails at full load. Linked with simavr, hence the licence.
//
//     avr_harness IMAGE.hex [--expect-fault dir|steps]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "avr_harness_bench.h"
#include "firmware_under_test/planner/program/link.h"

using namespace kerfbench::avr_bench;
using kerfbench::planner::Link;

namespace {

constexpr int kPeriods = 2500;             // 2 s
constexpr double kCountsPerPeriod = 32.0;  // 40 000 counts/s: edges of A at 20 kHz

struct Job {
  kerfbench::planner::Program program;
  std::array<long, KB_AXES> want{};  ///< Final positions, steps.
};

std::vector<std::uint8_t> config() {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(KB_CONFIG_LEN);
  putU32(bytes, static_cast<std::uint32_t>(std::lround(kCountsPerPeriod / 1.01 * 65536.0)));
  for (const int byte : {20, 12, 0}) bytes.push_back(static_cast<std::uint8_t>(byte));
  putU32(bytes, static_cast<std::uint32_t>(std::lround(1.2 * kCountsPerPeriod * 65536.0)));
  for (const int byte : {0, 0, 0, 0, 0, 0, 31, 31, 31, 31, 31, 31, 31, 31, 31, 31})
    bytes.push_back(static_cast<std::uint8_t>(byte));
  kerfbench::controller_test::appendNoField(bytes);
  return bytes;
}

/// Job with the longest operation: all axes, two of them at full speed with a turn now and then, power and
/// gain each time.
Job fullLoad() {
  Job job;
  job.program.config = config();
  job.program.ops.push_back({KB_OP_FOLLOW, KB_FEED + 1});
  job.program.ops.push_back({KB_OP_WAIT_MARK, 40, 0, 0, 0});
  std::uint32_t random = 12345;
  for (int i = 0; i < kPeriods; ++i) {
    random = random * 1664525U + 1013904223U;
    const int sign = (i / 7) % 2 == 0 ? 1 : -1;
    const std::array<int, KB_AXES> steps{31 * sign, -31 * sign, static_cast<int>(random >> 24) % 20 - 9,
                                         static_cast<int>(random >> 16 & 0xFFU) % 63 - 31, 0};
    std::vector<std::uint8_t> op{static_cast<std::uint8_t>(KB_OP_MOVE | KB_OP_GAIN | KB_OP_POWER | 0x1F)};
    for (std::size_t a = 0; a < KB_AXES; ++a) {
      op.push_back(static_cast<std::uint8_t>(static_cast<std::int8_t>(steps[a])));
      job.want[a] += steps[a];
    }
    op.push_back(static_cast<std::uint8_t>(random >> 8));
    op.push_back(0x00);
    op.push_back(0x10);  // gain 4096: one step a count
    job.program.ops.push_back(op);
  }
  job.program.ops.push_back({KB_OP_END});
  return job;
}

/// Runs the link's program to its end. Returns the largest correction of the feed axis, steps.
long runJob(Bench& bench, Link& link) {
  std::uint64_t sent_bytes = 0, run_from = 0;
  long worst_correction = 0;
  std::uint64_t at = 0;
  while (link.state() != Link::State::kDone && link.state() != Link::State::kFailed && at < 80'000'000) {
    at += 1600;
    const std::size_t sent = serve(bench, link, at);
    if (link.state() == Link::State::kRunning && !bench.running) {
      bench.running = true;
      run_from = at;
    }
    if (bench.running) sent_bytes += sent;
    worst_correction = std::max(worst_correction, std::labs(bench.axes[KB_FEED].position));
  }
  std::printf("link: %s\n", link.message().c_str());
  check(link.state() == Link::State::kDone, "the program is done");
  const double seconds = static_cast<double>(at - run_from) / 16e6;
  std::printf("ran %.3f s, %.0f bytes/s to the controller while running\n", seconds,
              static_cast<double>(sent_bytes) / seconds);
  return worst_correction;
}

void checkTicks(Bench& bench) {
  std::printf(
      "tick interrupt: %llu calls, mean %.1f, longest %llu cycles; start to start %llu..%llu cycles\n",
      static_cast<unsigned long long>(bench.tick().count),
      static_cast<double>(bench.tick().sum) /
          static_cast<double>(std::max<std::uint64_t>(bench.tick().count, 1)),
      static_cast<unsigned long long>(bench.tick().longest),
      static_cast<unsigned long long>(bench.min_interval),
      static_cast<unsigned long long>(bench.max_interval));
  std::printf("first gate rise %.3f ms after the mark\n",
              (static_cast<double>(bench.gate_rise) - static_cast<double>(bench.mark_rise)) / 16e3);
  const auto expected_ticks = static_cast<double>(bench.avr->cycle - bench.first_tick) / KB_TICK_CYCLES;
  check(std::abs(static_cast<double>(bench.ticks) - expected_ticks) < 3.0,
        "a tick each 400 cycles: " + std::to_string(bench.ticks) + " of " + std::to_string(expected_ticks));
}

struct Pins {
  bool steps_good{true}, timing_good{true};
};

Pins pinsOf(const Bench& bench, const Job& job) {
  Pins pins;
  for (std::size_t a = 0; a < KB_AXES; ++a) {
    const Axis& axis = bench.axes[a];
    std::printf("axis %zu: position %ld of %ld, %ld steps; set-up %lld, hold %lld, width %lld..%llu cycles\n",
                a, axis.position, job.want[a], axis.steps, static_cast<long long>(axis.min_setup),
                static_cast<long long>(axis.min_hold), static_cast<long long>(axis.min_width),
                static_cast<unsigned long long>(axis.max_width));
    pins.steps_good = pins.steps_good && axis.position == job.want[a] && axis.steps > 0;
    pins.timing_good =
        pins.timing_good && axis.min_setup >= 80 && axis.min_hold >= 80 && axis.min_width >= 40;
  }
  return pins;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 64;
  const std::string_view expected_fault = argc > 3 ? argv[3] : "";
  const Job job = fullLoad();
  Bench bench;
  bench.busy_wire = expected_fault.empty();
  load(bench, argv[1]);
  bench.encoder_period = 400;
  startBelt(bench, 100000);
  raiseMarkAt(bench, 8000000);
  Link link(job.program);
  const long worst_correction = runJob(bench, link);
  checkTicks(bench);
  const Pins pins = pinsOf(bench, job);
  // The feed axis had to go this far, and back at the end: 2500 periods at 1 % of 32 / 1.01 counts.
  const double belt_lead = kPeriods * kCountsPerPeriod * (1.0 - 1.0 / 1.01);
  std::printf("correction: at most %ld steps, belt lead %.1f counts\n", worst_correction, belt_lead);
  // A DIR that is late costs steps too: of that release only the timing is checked.
  if (expected_fault != "dir") {
    check((expected_fault == "steps") != pins.steps_good,
          expected_fault.empty() ? "steps exact" : "steps lost");
  }
  check((expected_fault == "dir") != pins.timing_good,
        expected_fault == "dir" ? "DIR late" : "DIR set-up and hold >= 80 cycles, PUL width >= 40 cycles");
  if (expected_fault.empty()) {
    check(std::abs(static_cast<double>(worst_correction) - belt_lead) < 40.0,
          "the feed axis follows the belt");
    // The interrupts of mark, encoder and UART may delay a tick; the next must still find it done.
    check(bench.max_interval <= 400 + 300, "a tick is late by at most 300 cycles");
    check(bench.tick().longest <= 300, "the tick interrupt takes at most 300 cycles");
  }
  return failures() == 0 ? 0 : 1;
}
