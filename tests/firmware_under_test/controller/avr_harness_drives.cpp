// SPDX-License-Identifier: GPL-3.0-or-later
// Drives of every kind on the AVR release: the planner's settings for their requirements, a program with
// reversals anywhere, the pins held against the drive's data sheet, steps counted. Linked with simavr, hence
// the licence.
//
//     avr_drives IMAGE.hex
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "avr_harness_bench.h"
#include "firmware_under_test/planner/job/pulses.h"
#include "firmware_under_test/planner/program/link.h"

namespace {

using namespace kerfbench::avr_bench;
using namespace kerfbench::planner;

// Drives of fixtures/machines/drivers.yaml, and one with DIR inverted.
const DriveNeeds kKinds[] = {
    {.name = "galvo-pul-dir", .setup_s = 5e-6, .hold_s = 5e-6, .width_s = 2.5e-6, .space_s = 2.5e-6},
    {.name = "DM556", .setup_s = 5e-6, .hold_s = 10e-6, .width_s = 2.5e-6, .space_s = 2.5e-6},
    {.name = "Gecko201",
     .falling_edge = true,
     .setup_s = 1e-6,
     .hold_s = 20e-6,
     .width_s = 0.5e-6,
     .space_s = 4e-6},
    {.name = "Gecko201, DIR low",
     .falling_edge = true,
     .dir_low = true,
     .setup_s = 1e-6,
     .hold_s = 20e-6,
     .width_s = 0.5e-6,
     .space_s = 4e-6},
    {.name = "TB6560",
     .falling_edge = true,
     .setup_s = 150e-6,
     .hold_s = 150e-6,
     .width_s = 150e-6,
     .space_s = 150e-6},
    {.name = "DRV8825", .setup_s = 0.65e-6, .hold_s = 0.65e-6, .width_s = 1.9e-6, .space_s = 1.9e-6},
};

struct Job {
  Program program;
  std::array<long, KB_AXES> want{};  ///< Final positions, steps.
};

/// Job that turns round anywhere, at all speeds that the settings allow.
Job jobFor(const PulseSettings& settings) {
  Job job;
  std::vector<std::uint8_t>& config = job.program.config;
  config.reserve(KB_CONFIG_LEN);
  for (const int byte : {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})
    config.push_back(static_cast<std::uint8_t>(byte));
  for (const std::uint8_t byte : {settings.invert_a, settings.invert_c, settings.wide, settings.wide_ticks})
    config.push_back(byte);
  config.insert(config.end(), settings.most_steps.begin(), settings.most_steps.end());
  config.insert(config.end(), settings.turn_steps.begin(), settings.turn_steps.end());
  kerfbench::controller_test::appendNoField(config);
  std::uint32_t random = 7;
  for (int i = 0; i < 1200; ++i) {
    std::vector<std::uint8_t> op{KB_OP_MOVE | 0x1F};
    for (std::size_t axis = 0; axis < KB_AXES; ++axis) {
      random = random * 1664525U + 1013904223U;
      const int most = settings.most_steps[axis];
      const int steps = (random >> 9 & 3U) == 0 ? 0 : static_cast<int>(random >> 16) % (2 * most + 1) - most;
      op.push_back(static_cast<std::uint8_t>(static_cast<std::int8_t>(steps)));
      job.want[axis] += steps;
    }
    job.program.ops.push_back(op);
  }
  job.program.ops.push_back({KB_OP_END});
  return job;
}

void runJob(Bench& bench, const Job& job, const std::string& name) {
  Link link(job.program);
  std::uint64_t at = 0;
  while (link.state() != Link::State::kDone && link.state() != Link::State::kFailed && at < 48'000'000) {
    at += 1600;
    serve(bench, link, at);
  }
  check(link.state() == Link::State::kDone, name + ": " + link.message());
}

void checkPins(const Bench& bench, const Drives& drives, const Job& job) {
  const Vector& holding = bench.vectors[4];
  if (holding.count > 0)
    std::printf("      %s: mean %.1f, longest %llu cycles, latest %llu\n", holding.name,
                static_cast<double>(holding.sum) / static_cast<double>(holding.count),
                static_cast<unsigned long long>(holding.longest),
                static_cast<unsigned long long>(holding.latest));
  for (std::size_t i = 0; i < KB_AXES; ++i) {
    const Axis& axis = bench.axes[i];
    const auto us = [](std::uint64_t cycles) { return static_cast<double>(cycles) / 16.0; };
    std::printf(
        "      axis %zu: %ld steps, to %ld of %ld; set-up %.2f, hold %.2f, width %.2f, space %.2f us\n", i,
        axis.steps, axis.position, job.want[i], us(axis.min_setup), us(axis.min_hold), us(axis.min_width),
        us(axis.min_space));
    check(axis.position == job.want[i] && axis.steps > 500, "every step, no matter how often it turns");
    const DriveNeeds& needs = drives[i];
    check(us(axis.min_setup) >= needs.setup_s * 1e6 && us(axis.min_hold) >= needs.hold_s * 1e6 &&
              us(axis.min_width) >= needs.width_s * 1e6 && us(axis.min_space) >= needs.space_s * 1e6,
          "PUL and DIR as the drive needs them");
  }
}

void run(const char* image, const DriveNeeds& drive) {
  Drives drives;
  drives.fill(drive);
  drives[KB_GANTRY_Y] = {};  // This drive has no requirements.
  check(driveFaults({}, drives).empty(), drive.name + ": can be served");
  const PulseSettings settings = pulsesFor({}, drives);
  std::printf(
      "      %s: at most %d steps in a period, %d where it turns, PUL for %s\n", drive.name.c_str(),
      settings.most_steps[0], settings.turn_steps[0],
      settings.wide == 0 ? "less than a tick" : (std::to_string(settings.wide_ticks) + " ticks").c_str());
  const Job job = jobFor(settings);
  Bench bench;
  bench.invert_a = settings.invert_a;
  bench.invert_c = settings.invert_c;
  load(bench, image);
  // The belt is only a load: 40 000 counts/s, half of it where ticks take longer.
  bench.encoder_period = settings.wide == 0 ? 400 : 800;
  startBelt(bench, 100000);
  runJob(bench, job, drive.name);
  checkPins(bench, drives, job);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 64;
  for (const DriveNeeds& drive : kKinds) run(argv[1], drive);
  return failures() == 0 ? 0 : 1;
}
