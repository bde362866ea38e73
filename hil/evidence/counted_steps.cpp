// SPDX-License-Identifier: Apache-2.0
#include "hil/evidence/counted_steps.h"

#include <algorithm>
#include <cmath>

namespace kerfbench::evidence {
namespace {

bool isHigh(std::uint16_t levels, PinId pin) { return ((levels >> pin.bit) & 1U) != 0; }

}  // namespace

std::int32_t StepCounter::Axis::stepBy(const PinEvent& event) {
  if (enable && event.port == enable->port) enabled = profile.enabledBy(isHigh(event.level, *enable));
  if (event.port == dir.port) dir_port = event.level;
  if (event.port != pul.port) return 0;
  pul_port = event.level;
  const bool high = isHigh(pul_port, pul);
  if (high == pul_high) return 0;
  pul_high = high;
  if (high != profile.active_edge_rising || !enabled) return 0;
  return profile.senseOf(isHigh(dir_port, dir));
}

std::optional<StepCounter> StepCounter::from(const PinWiring& wiring) {
  if (wiring.drives.size() < 2) return std::nullopt;
  StepCounter counted;
  for (std::size_t i = 0; i < 2; ++i) {
    const DriveWiring& drive = wiring.drives[i];
    const std::optional<PinId> pul = wiring.signals.pin(drive.pul);
    const std::optional<PinId> dir = wiring.signals.pin(drive.dir);
    if (!pul || !dir) return std::nullopt;
    Axis& axis = counted.axes_[i];
    axis.pul = *pul;
    axis.dir = *dir;
    axis.enable = wiring.signals.pin(enableOf(drive.pul));
    axis.profile = drive.profile;
    axis.enabled = !axis.enable || axis.profile.enabledBy(false);
  }
  return counted;
}

std::optional<CountedSteps> CountedSteps::from(TickRate rate, const PinWiring& wiring) {
  const std::optional<StepCounter> counter = StepCounter::from(wiring);
  if (!counter) return std::nullopt;
  CountedSteps counted;
  counted.rate_ = rate;
  counted.counter_ = *counter;
  return counted;
}

std::optional<CountedSteps> CountedSteps::of(const source::PinRecording& recording, const PinWiring& wiring) {
  std::optional<CountedSteps> counted = from(recording.rate, wiring);
  if (!counted) return std::nullopt;
  for (const PinEvent& event : recording.outputs) counted->take(event);
  counted->end();
  return counted;
}

void CountedSteps::add(std::span<const PinEvent> events, Tick until) {
  for (const PinEvent& event : events) take(event);
  fillBefore(until);
}

void CountedSteps::take(const PinEvent& event) {
  fillBefore(event.tick);
  counter_.take(event);
}

/// Most events need no division: they come well before the period's end.
void CountedSteps::fillBefore(Tick tick) {
  if (tick < surely_within_) return;
  const std::size_t period = periodOf(tick);
  fillUpTo(period);
  constexpr Tick kRounding = 2;
  const Tick end = rate_.ticksAt(static_cast<double>(period + 1) * kRaster_s);
  surely_within_ = end - std::min(end, kRounding);
}

std::size_t CountedSteps::periodOf(Tick tick) const {
  return static_cast<std::size_t>(std::max(0.0, rate_.seconds(tick)) / kRaster_s);
}

void CountedSteps::fillUpTo(std::size_t period) {
  while (steps_.size() < period) steps_.push_back(counter_.now());
}

std::size_t CountedSteps::indexAt(double time_s) const {
  const double period = std::floor(time_s / kRaster_s);
  if (!(period > 0.0) || steps_.empty()) return 0;
  return std::min(static_cast<std::size_t>(period), steps_.size() - 1);
}

CountedSteps::Steps CountedSteps::at(double time_s) const {
  return steps_.empty() ? counter_.now() : steps_[indexAt(time_s)];
}

void CountedSteps::passed(double time_s) const { steps_.giveBack(0, indexAt(time_s)); }

}  // namespace kerfbench::evidence
