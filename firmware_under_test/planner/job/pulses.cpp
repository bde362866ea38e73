// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/job/pulses.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "firmware_under_test/controller/protocol.h"

namespace kerfbench::planner {

static_assert(kAxes == KB_AXES);

namespace {

constexpr const char* kNames[kAxes] = {"galvo_x", "galvo_y", "gantry_x", "gantry_y", "feed"};
/// Slack for figures of data sheets, which are whole numbers of some unit; sums of them must not fail by a
/// rounding.
constexpr double kRounding = 1e-12;

/// Number of ticks that a pulse of this width must stay, 0 if it may fall within its tick.
int widthTicks(const Target& target, double width_s) {
  if (width_s <= target.width_s + kRounding) return 0;
  return static_cast<int>(std::ceil((width_s + target.late_s - kRounding) / target.tick_s));
}

double spaceAt(const Target& target, int steps, int width_ticks) {
  const int apart = target.ticks_per_period / steps;
  const int idle = apart - std::max(width_ticks, 1);
  if (width_ticks == 0)
    return idle == 0 ? target.space_s : std::max(target.space_s, idle * target.tick_s - target.late_s);
  return idle <= 0 ? 0.0 : idle * target.tick_s - target.late_s;
}

double setupAt(const Target& target, int steps) {
  const int first = (target.ticks_per_period + 2 * steps - 1) / (2 * steps);  // rounded up
  return std::max(target.setup_s, (first - 1) * target.tick_s + target.setup_s - target.late_s);
}

double holdAt(const Target& target, int steps) {
  const int left = target.ticks_per_period / (2 * steps);
  return std::max(target.hold_s, left * target.tick_s + target.hold_s - target.late_s);
}

struct AxisPulses {
  int most{}, turn{};
};

AxisPulses axisPulses(const Target& target, const DriveNeeds& drive, int width_ticks) {
  AxisPulses pulses;
  const auto good = [](double is_s, double needed_s) { return is_s >= needed_s - kRounding; };
  for (int steps = target.max_steps; steps > 0 && pulses.most == 0; --steps) {
    const bool apart = target.ticks_per_period / steps > width_ticks;
    if (apart && good(spaceAt(target, steps, width_ticks), drive.space_s)) pulses.most = steps;
  }
  for (int steps = pulses.most; steps > 0 && pulses.turn == 0; --steps) {
    if (good(setupAt(target, steps), drive.setup_s) && good(holdAt(target, steps), drive.hold_s))
      pulses.turn = steps;
  }
  return pulses;
}

int commonWidth(const Target& target, const Drives& drives) {
  int ticks = 0;
  for (const DriveNeeds& drive : drives) ticks = std::max(ticks, widthTicks(target, drive.width_s));
  return ticks;
}

}  // namespace

PulseSettings pulsesFor(const Target& target, const Drives& drives) {
  PulseSettings settings;
  const int common = commonWidth(target, drives);
  settings.wide_ticks = static_cast<std::uint8_t>(common);
  for (std::size_t i = 0; i < kAxes; ++i) {
    const DriveNeeds& drive = drives[i];
    const bool wide = widthTicks(target, drive.width_s) > 0;
    const AxisPulses pulses = axisPulses(target, drive, wide ? common : 0);
    settings.most_steps[i] = static_cast<std::uint8_t>(pulses.most);
    settings.turn_steps[i] = static_cast<std::uint8_t>(pulses.turn);
    if (wide) settings.wide = static_cast<std::uint8_t>(settings.wide | 1U << i);
    const unsigned pul = i < KB_FEED ? 1U << (2 * i) : 1U;
    const unsigned inverted = (drive.falling_edge ? pul : 0U) | (drive.dir_low ? pul << 1 : 0U);
    std::uint8_t& port = i < KB_FEED ? settings.invert_a : settings.invert_c;
    port = static_cast<std::uint8_t>(port | inverted);
  }
  return settings;
}

std::vector<std::string> driveFaults(const Target& target, const Drives& drives) {
  std::vector<std::string> faults;
  const int common = commonWidth(target, drives);
  for (std::size_t i = 0; i < kAxes; ++i) {
    const DriveNeeds& drive = drives[i];
    const std::string who = fmt::format("{}: {}", kNames[i], drive.name.empty() ? "its drive" : drive.name);
    bool numbers = true;
    for (const double time_s : {drive.setup_s, drive.hold_s, drive.width_s, drive.space_s})
      numbers = numbers && time_s >= 0.0 && time_s <= 1.0;
    if (!numbers) {
      faults.push_back(who + ": the times of PUL and DIR must be in 0 … 1 s");
      continue;
    }
    const int ticks = widthTicks(target, drive.width_s);
    if (ticks > KB_WIDE_TICKS_MAX) {
      faults.push_back(
          fmt::format("{} needs PUL active for {:g} us; this controller makes {:g} us, or up to {:g} us", who,
                      drive.width_s * kMicrosecondsPerSecond, target.width_s * kMicrosecondsPerSecond,
                      (KB_WIDE_TICKS_MAX * target.tick_s - target.late_s) * kMicrosecondsPerSecond));
      continue;
    }
    const int width = ticks > 0 ? common : 0;
    const AxisPulses pulses = axisPulses(target, drive, width);
    if (pulses.most == 0) {
      faults.push_back(fmt::format(
          "{} needs PUL idle for {:g} us; after pulses of {:g} us this controller leaves {:g} us at most",
          who, drive.space_s * kMicrosecondsPerSecond, width * target.tick_s * kMicrosecondsPerSecond,
          spaceAt(target, 1, width) * kMicrosecondsPerSecond));
    } else if (pulses.turn == 0) {
      faults.push_back(fmt::format(
          "{} needs DIR stable for {:g} us before PUL and {:g} us after; this controller gives {:g} and {:g} "
          "us at most",
          who, drive.setup_s * kMicrosecondsPerSecond, drive.hold_s * kMicrosecondsPerSecond,
          setupAt(target, 1) * kMicrosecondsPerSecond, holdAt(target, 1) * kMicrosecondsPerSecond));
    }
  }
  return faults;
}

}  // namespace kerfbench::planner
