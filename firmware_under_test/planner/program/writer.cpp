// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/program/writer.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>

#include "firmware_under_test/controller/protocol.h"
#include "firmware_under_test/planner/head/stepper.h"
#include "firmware_under_test/planner/program/program.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

/// Share of change above which the gain is sent anew.
constexpr double kGainShare = 0.002;

/// Periods for which the spot stays that are many: their mean is what the sheet gets.
constexpr double kManyPeriods = 8.0;

}  // namespace

Writer::Writer(const Axes& axes, const MachineParameters& machine, const JobParameters& job,
               double belt_speed_mm_s)
    : axes_(axes),
      machine_(machine),
      job_(job),
      v_(belt_speed_mm_s),
      period_s_(axes.periodS()),
      p_W_mm_(axes.wakesAt()) {}

void Writer::period(const Vector2d& p_W_mm, const Sample* mark, int entity) {
  Entry entry;
  Vector2d wanted = axes_.stepsAt(p_W_mm);
  for (int i = 0; i < 2; ++i) wanted[i] = againstDetent(wanted[i], machine_.steppers);
  entry.wanted = wanted;
  entry.entity = entity;
  entry.feed_steps = feedSteps();
  if (mark != nullptr && mark->marked_mm > 0.0) {
    entry.power = powerOf(*mark);
  } else {
    owed_w_ = 0.0;
  }
  if (following_) {
    const double gain = axes_.xStepsPerMm(p_W_mm) * machine_.encoder_count_mm * 4096.0;
    if (std::abs(gain - gain_) > kGainShare * gain) {
      gain_ = gain;
      entry.gain = static_cast<std::uint16_t>(std::lround(gain));
    }
  }
  entries_.push_back(std::move(entry));
  p_W_mm_ = p_W_mm;
}

void Writer::hold(int periods) {
  for (int i = 0; i < periods; ++i) period(p_W_mm_, nullptr, -1);
}

void Writer::reposition(const Vector2d& to_W_mm, double v0_mm_s) {
  const Reposition move(p_W_mm_, v0_mm_s, to_W_mm, job_, axes_);
  for (int k = 1; k <= move.periods(); ++k) period(move.at(k), nullptr, -1);
}

void Writer::waitMark(std::int32_t offset) {
  Entry entry;
  entry.op.push_back(KB_OP_WAIT_MARK);
  append(entry.op, static_cast<std::uint32_t>(offset), 4);
  entry.waits = true;
  entries_.push_back(std::move(entry));
}

void Writer::follow(bool on) {
  following_ = on;
  Entry entry;
  entry.op = {KB_OP_FOLLOW, static_cast<std::uint8_t>(on ? axes_.firstAxis() + 1 : 0)};
  entries_.push_back(std::move(entry));
}

std::vector<Payload> Writer::finish() {
  std::vector<Payload> ops;
  const std::vector<std::array<int, 2>> to = positions();
  std::array<int, 2> steps{};
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    Entry& entry = entries_[i];
    if (!entry.wanted) {
      ops.push_back(std::move(entry.op));
      continue;
    }
    const std::array<int, 2> count{to[i][0] - steps[0], to[i][1] - steps[1]};
    steps = to[i];
    checkCount(entry, count);
    ops.push_back(move(entry, count));
  }
  ops.emplace_back(1, KB_OP_END);
  return ops;
}

/// Positions of both axes after each entry. The length of a wait is not known, so the rotors rest behind it.
std::vector<std::array<int, 2>> Writer::positions() const {
  std::vector<std::array<int, 2>> to(entries_.size());
  for (std::size_t begin = 0; begin < entries_.size();) {
    std::size_t end = begin + 1;
    while (end < entries_.size() && !entries_[end].waits) ++end;
    for (int axis = 0; axis < 2; ++axis) choose(begin, end, axis, to);
    begin = end;
  }
  return to;
}

void Writer::choose(std::size_t begin, std::size_t end, int axis, std::vector<std::array<int, 2>>& to) const {
  const auto a = static_cast<std::size_t>(axis);
  const int from = begin == 0 ? 0 : to[begin - 1][a];
  std::vector<double> wanted;
  for (std::size_t i = begin; i < end; ++i) {
    if (entries_[i].wanted) wanted.push_back((*entries_[i].wanted)[axis]);
  }
  std::vector<int> chosen;
  if (machine_.steppers.resonance_hz > 0.0) {
    const auto first = static_cast<std::size_t>(axes_.firstAxis());
    const StepSource source{period_s_, axes_.target().ticks_per_period, axes_.pulses().most_steps[first + a],
                            machine_.tracking_delay_s};
    chosen = StepChoice(machine_.steppers, source).along(wanted, from);
  } else {
    for (const double place : wanted) chosen.push_back(static_cast<int>(std::lround(place)));
  }
  std::size_t next = 0;
  for (std::size_t i = begin; i < end; ++i)
    to[i][a] = entries_[i].wanted ? chosen[next++] : (i == 0 ? 0 : to[i - 1][a]);
}

void Writer::checkCount(const Entry& entry, const std::array<int, 2>& count) {
  for (int i = 0; i < 2; ++i) {
    const auto axis = static_cast<std::size_t>(axes_.firstAxis() + i);
    const int most = axes_.pulses().most_steps[axis];
    const int steps = count[static_cast<std::size_t>(i)];
    if (std::abs(steps) > most) {
      throw PlanError(
          fmt::format("E{}: axis {} would need {} steps in one period of {:g} ms; the limit is {}",
                      entry.entity, "xy"[i], steps, period_s_ * 1e3, most));
    }
  }
  for (int i = 0; i < 2; ++i) checkTurn(i, count[static_cast<std::size_t>(i)], entry.entity);
}

Payload Writer::move(const Entry& entry, const std::array<int, 2>& count) const {
  std::uint8_t mask = 0;
  Payload op(1);  // The operation itself comes last, when its mask is known.
  const auto axis = [&](int number, int steps) {
    if (steps == 0) return;
    mask = static_cast<std::uint8_t>(mask | (1U << static_cast<unsigned>(number)));
    op.push_back(static_cast<std::uint8_t>(static_cast<std::int8_t>(steps)));
  };
  axis(axes_.firstAxis(), count[0]);
  axis(axes_.firstAxis() + 1, count[1]);
  axis(KB_FEED, entry.feed_steps);
  if (entry.power) {
    mask |= KB_OP_POWER;
    op.push_back(*entry.power);
  }
  if (entry.gain) {
    mask |= KB_OP_GAIN;
    append(op, *entry.gain, 2);
  }
  op[0] = static_cast<std::uint8_t>(KB_OP_MOVE | mask);
  return op;
}

/// PWM byte of a mark. Where the spot stays for many periods, what rounding left of the energy of one is
/// owed to the next: a step of the PWM is little of a fast beam's power and much of a slow one's.
std::uint8_t Writer::powerOf(const Sample& mark) {
  if (!job_.power)
    return static_cast<std::uint8_t>(std::lround(std::min(powerByte(mark, machine_, job_), 255.0)));
  const PowerModel& model = *job_.power;
  const double power_w = powerSetting(mark, machine_, job_).power_w;
  if (mark.marked_mm / mark.z * kManyPeriods > model.wish().spot_diameter_mm) owed_w_ = 0.0;
  const double wanted_w = std::clamp(power_w + owed_w_, model.laser().least_w, model.laser().most_w);
  const std::uint8_t byte = model.byteFor(model.laser().power.inverse(wanted_w).value());
  owed_w_ += power_w - model.powerOf(byte);
  return byte;
}

/// Refuses a turn that the firmware would delay to set DIR up and hold it as long as the drive needs: the
/// beam would be late.
void Writer::checkTurn(int axis, int count, int entity) {
  const int turn = axes_.pulses().turn_steps[static_cast<std::size_t>(axes_.firstAxis() + axis)];
  const int before = std::exchange(count_before_[static_cast<std::size_t>(axis)], count);
  if (before * count >= 0 || (std::abs(before) <= turn && std::abs(count) <= turn)) return;
  throw PlanError(
      fmt::format("E{}: axis {} turns round from {} to {} steps in a period of {:g} ms; its drive allows "
                  "{} for the time that "
                  "DIR must be stable: accelerate less",
                  entity, "xy"[axis], before, count, period_s_ * 1e3, turn));
}

/// The belt's ramps are straight in speed and take whole periods.
int Writer::feedSteps() {
  if (pitch_period_) {
    ++*pitch_period_;
    const double to_mm = pitches_ * job_.pitch_mm + feedOfPitch(job_).at(*pitch_period_ * period_s_);
    if (*pitch_period_ >= feedOfPitchPeriods(job_, period_s_)) {
      pitch_period_.reset();
      ++pitches_;
    }
    return feedTo(to_mm);
  }
  if (feed_speed_ == 0.0 && feed_target_ == 0.0) return 0;
  const double step = v_ / std::max(1, feedRampPeriods(v_, job_, period_s_));
  const double before = feed_speed_;
  feed_speed_ += std::clamp(feed_target_ - feed_speed_, -step, step);
  if (std::abs(feed_speed_ - feed_target_) < 1e-6 * v_) feed_speed_ = feed_target_;
  feed_mm_ += 0.5 * (before + feed_speed_) * period_s_;
  return feedTo(feed_mm_);
}

int Writer::feedTo(double belt_mm) {
  const long to = std::lround(belt_mm / machine_.feed_step_mm);
  const int count = static_cast<int>(to - feed_steps_);
  feed_steps_ = to;
  return count;
}

}  // namespace kerfbench::planner
