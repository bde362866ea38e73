// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/strip_controller.h"

#include <algorithm>
#include <cmath>

namespace kerfbench::validation {
double StripJob::formula_s(int pieces) const {
  const double feed_s = length_mm / feed_mm_s;
  const double cut_s = width_mm / cut_mm_s;
  return regime == Regime::kContinuous ? pieces * feed_s + cut_s : pieces * (feed_s + cut_s);
}

double StripJob::ramps_s(int pieces) const {
  const double outside_s = run_up_mm / cut_mm_s;
  // The head leaves x = 0 at rest and is level with its line once it has its speed.
  if (regime == Regime::kContinuous) return 0.5 * feed_mm_s / gantry_acceleration_mm_s2 + outside_s;
  const double run_up_s = cut_mm_s / gantry_acceleration_mm_s2 + outside_s;
  return pieces * (feed_mm_s / feed_acceleration_mm_s2 + run_up_s) + (pieces - 1) * 0.5 * outside_s;
}

double StripJob::cycle_s() const {
  const double a = gantry_acceleration_mm_s2;
  const double outside_s = run_up_mm / cut_mm_s;
  const double together_s = width_mm / cut_mm_s + 2.0 * outside_s;  // Time at the speed of the line.
  Track x(0.0);
  x.speedUpTo(feed_mm_s, a);
  x.keepUntil(x.time_s() + together_s);
  x.moveTo(0.0, return_mm_s, a);
  return x.time_s() + std::max(0.0, (cut_mm_s - feed_mm_s) / a);
}

double StripJob::returnLimit_mm_s() const {
  return feed_mm_s / (length_mm * cut_mm_s / (feed_mm_s * width_mm) - 1.0);
}

StripController::StripController(const StripJob& job, const twin::MachineDescription& machine, TickRate rate)
    : job_(job),
      map_(machine.signals),
      rate_(rate),
      x_(Signal::kGantryXPul, Signal::kGantryXDir, machine.gantry_x.step, 0.0),
      y_(Signal::kGantryYPul, Signal::kGantryYDir, machine.gantry_y.step, 0.0),
      feed_(Signal::kFeedPul, Signal::kFeedDir, machine.belt.feed.step, 0.0),
      ports_(16, 0) {
  const double a = job_.gantry_acceleration_mm_s2;
  const double outside_mm = 0.5 * job_.cut_mm_s * job_.cut_mm_s / a + job_.run_up_mm;
  y_.track().moveTo(-0.5 * job_.width_mm - outside_mm, job_.cut_mm_s, a);
  free_s_ = y_.track().time_s();
}

void StripController::planCrossing(double edge_s) {
  const double sense = StripController::sense(cut_);
  const double a = job_.gantry_acceleration_mm_s2;
  const double outside_s = job_.run_up_mm / job_.cut_mm_s;
  const double cut_s = job_.width_mm / job_.cut_mm_s;
  Track& y = y_.track();
  y.keepUntil(edge_s - outside_s - job_.cut_mm_s / a);
  y.speedUpTo(sense * job_.cut_mm_s, a);
  y.keepUntil(edge_s + cut_s + outside_s);
  y.speedUpTo(0.0, a);
  gate_.push_back({edge_s - 0.5 * outside_s, true});
  gate_.push_back({edge_s + cut_s + 0.5 * outside_s, false});
}

void StripController::planCut() {
  ++cut_;
  const double a = job_.gantry_acceleration_mm_s2;
  const double v = job_.feed_mm_s;
  const double catch_up_s = v / a;
  const double outside_s = job_.run_up_mm / job_.cut_mm_s;
  const double line_s = cut_ * job_.length_mm / v;
  const double ready_s = free_s_ + std::max(v, job_.cut_mm_s) / a;
  // Time at which the head is with the line, at its speed.
  const double level_s = std::max(line_s + 0.5 * catch_up_s, ready_s);
  planCrossing(level_s + outside_s);
  Track& x = x_.track();
  x.keepUntil(level_s - catch_up_s);
  x.speedUpTo(v, a);
  x.keepUntil(level_s + 2.0 * outside_s + job_.width_mm / job_.cut_mm_s);
  x.moveTo(0.0, job_.return_mm_s, a);
  free_s_ = std::max(x.time_s(), y_.track().time_s());
}

void StripController::planFeed() {
  ++cut_;
  const double run_up_s = job_.cut_mm_s / job_.gantry_acceleration_mm_s2 + job_.run_up_mm / job_.cut_mm_s;
  Track& feed = feed_.track();
  feed.keepUntil(cut_ == 1 ? 0.0 : free_s_);
  feed.moveTo(cut_ * job_.length_mm, job_.feed_mm_s, job_.feed_acceleration_mm_s2);
  planCrossing(feed.time_s() + run_up_s);
  free_s_ = gate_.back().time_s;
}

void StripController::advance(Tick until, std::vector<PinEvent>& events) {
  const double until_s = rate_.seconds(until);
  const bool continuous = job_.regime == StripJob::Regime::kContinuous;
  while ((continuous ? x_ : feed_).track().time_s() <= until_s) continuous ? planCut() : planFeed();
  if (!started_) {
    started_ = true;
    writes_.push_back({1, Signal::kLaserPwm, true});
  }
  for (PulseTrain* train : {&x_, &y_, &feed_}) train->appendUntil(until_s, rate_, writes_);
  while (!gate_.empty() && gate_.front().time_s < until_s) {
    writes_.push_back({rate_.ticksAt(gate_.front().time_s), Signal::kLaserGate, gate_.front().open});
    gate_.pop_front();
  }
  std::ranges::stable_sort(writes_, {}, &PinWrite::tick);
  const auto later = std::ranges::upper_bound(writes_, until, {}, &PinWrite::tick);
  for (auto write = writes_.begin(); write != later; ++write) {
    const auto pin = map_.pin(write->signal);
    if (!pin) continue;
    std::uint16_t& port = ports_.at(pin->port);
    const auto mask = static_cast<std::uint16_t>(1U << pin->bit);
    const std::uint16_t before = port;
    port = static_cast<std::uint16_t>(write->level ? port | mask : port & ~mask);
    const auto changed = static_cast<std::uint16_t>(before ^ port);
    if (changed != 0) events.push_back({write->tick, pin->port, changed, port, 0});
  }
  writes_.erase(writes_.begin(), later);
}

}  // namespace kerfbench::validation
