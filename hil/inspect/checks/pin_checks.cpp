// SPDX-License-Identifier: Apache-2.0
// What the pins tell: timing of pulses, and the laser gate against the light that was seen.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "hil/inspect/checks/checks.h"
#include "hil/inspect/evidence/extreme.h"
#include "hil/inspect/evidence/whereabouts.h"
#include "twin/base/constants.h"

namespace kerfbench::inspect::checks {
namespace {

/// One of the times of a drive's data sheet.
struct TimingItem {
  const char* kind;
  double seen_s;
  double required_s;
  std::uint64_t violations;
};

std::vector<TimingItem> itemsOf(const PulseTiming& t) {
  return {{"DIR set-up", t.min_setup_s, t.profile.setup_s, t.setup_violations},
          {"DIR hold", t.min_hold_s, t.profile.hold_s, t.hold_violations},
          {"pulse width", t.min_width_s, t.profile.width_s, t.width_violations},
          {"pulse space", t.min_space_s, t.profile.space_s, t.space_violations},
          {"time from enable to DIR or PUL", t.min_enable_setup_s, t.profile.enable_setup_s,
           t.enable_setup_violations}};
}

/// Pulses that drives never saw, axis by axis, in sentences with a blank before each.
std::string disabledWords(const std::vector<PulseTiming>& pulses) {
  std::string words;
  for (const PulseTiming& timing : pulses) {
    if (timing.disabled_pulses == 0) continue;
    words += fmt::format(
        " {}: {} pulses while the drive was disabled; it is enabled while its enable line is {} "
        "(`{}.enable_low`).",
        timing.axis, timing.disabled_pulses, timing.profile.enable_low ? "low" : "high",
        timing.axis == "feed" ? "belt.feed" : timing.axis);
  }
  return words;
}

}  // namespace

Check pulseTimingCheck(const Evidence& evidence) {
  Check check{
      .name = "pulse_timing", .title = "Pulses keep the drives' timing", .unit = "us", .upper = false};
  check.value = kNan;
  std::uint64_t pulses = 0;
  std::uint64_t violations = 0;
  const PulseTiming* worst_axis = nullptr;
  TimingItem worst{};
  for (const PulseTiming& timing : evidence.pulses) {
    pulses += timing.pulses;
    if (timing.pulses == 0) continue;
    for (const TimingItem& item : itemsOf(timing)) {
      violations += item.violations;
      // An axis that never turned has no set-up time: infinity.
      if (std::isinf(item.seen_s) && item.violations == 0) continue;
      const double margin_us = 1e6 * (item.seen_s - item.required_s);
      if (worst_axis != nullptr && !std::isnan(margin_us) && !(margin_us < check.value)) continue;
      check.value = margin_us;
      worst_axis = &timing;
      worst = item;
      if (std::isnan(margin_us)) break;
    }
  }
  // A time is the difference of two edges. Counting cycles is exact, so an emulator's guard band is nil.
  check.u = check.guard = 2.0 * std::sqrt(2.0) * 1e6 * evidence.pin_u_s;
  decide(check);
  if (worst_axis == nullptr) {
    check.explanation = "No pulse was seen on any axis.";
    return check;
  }
  // The decoder's count is of whole ticks, and is not to be argued away by rounding.
  if (violations > 0 && check.verdict == Verdict::kPass) check.verdict = Verdict::kFail;
  const std::string disabled = disabledWords(evidence.pulses);
  if (!disabled.empty()) check.verdict = Verdict::kFail;
  check.subject = worst_axis->axis;
  check.explanation = fmt::format(
      "Of {} pulses on {} axes {} break a time of their drive; closest is the {} of {}: {:.4g} us, "
      "where {} asks for {:.4g} us.{}",
      pulses, evidence.pulses.size(), violations == 0 ? "none" : std::to_string(violations), worst.kind,
      worst_axis->axis, 1e6 * worst.seen_s, worst_axis->profile.name, 1e6 * worst.required_s, disabled);
  if (worst_axis->first_violation_s >= 0.0) {
    check.where = atTime(worst_axis->first_violation_s);
    check.explanation +=
        fmt::format(" The first violation on this axis is at {:.6f} s.", worst_axis->first_violation_s);
  }
  return check;
}

Finding interlockCheck(const Evidence& evidence) {
  Check check{.name = "interlock", .title = "The laser goes off when the guard opens", .unit = "ms"};
  if (!evidence.guard_open) return notApplicable(check, "The pins show no interlock.");
  check.limit = 1e3 * kLaserOff_s;
  check.u = check.guard = 2.0 * std::sqrt(2.0) * 1e3 * evidence.pin_u_s;
  double worst_s = 0.0;
  double opened_s = 0.0;
  for (const Span& open : *evidence.guard_open) {
    for (const GateInterval& gate : evidence.gates) {
      const double lit_until_s = std::min(gate.off_s, open.to_s);
      if (gate.on_s >= open.to_s || lit_until_s <= open.from_s) continue;
      if (lit_until_s - open.from_s <= worst_s) continue;
      worst_s = lit_until_s - open.from_s;
      opened_s = open.from_s;
    }
  }
  check.value = 1e3 * worst_s;
  decide(check);
  if (evidence.guard_open->empty()) {
    check.explanation = "The guard was closed all through the run.";
  } else if (worst_s == 0.0) {
    check.explanation = fmt::format("The guard was opened {} times, and the gate was off each time.",
                                    evidence.guard_open->size());
  } else {
    check.where = atTime(opened_s);
    check.explanation = fmt::format(
        "The guard opened at {:.6f} s, and the gate was on until {:.4g} ms later.", opened_s, 1e3 * worst_s);
  }
  return check;
}

Check laserGateCheck(const Evidence& evidence, const Tolerances& limits, const LitFrames& followed) {
  Check check{.name = "laser_gate", .title = "The laser is dark while its gate is off", .unit = "ms"};
  check.limit = 1e3 * limits.gate_tail_s;
  check.value = kNan;
  std::vector<GateInterval> gates = evidence.gates;
  std::sort(gates.begin(), gates.end(), [](const auto& a, const auto& b) { return a.on_s < b.on_s; });
  std::size_t lit = 0;
  std::size_t outside = 0;
  double worst_time_s = 0.0;
  for (const vision::FrameMeasurement& frame : evidence.spot.frames) {
    if (!frame.spot_W_mm) continue;
    ++lit;
    if (gates.empty()) continue;
    // Gate intervals do not overlap: only the last that began, and the next, can be nearest.
    const auto next = std::upper_bound(gates.begin(), gates.end(), frame.mid_s,
                                       [](double t, const GateInterval& g) { return t < g.on_s; });
    double outside_s = std::numeric_limits<double>::infinity();
    if (next != gates.end()) outside_s = next->on_s - frame.mid_s;
    if (next != gates.begin())
      outside_s = std::min(outside_s, std::max(frame.mid_s - (next - 1)->off_s, 0.0));
    // What a frame shows in which the gate was open may have shone then.
    if (outside_s < 0.5 * frame.exposure_s) outside_s = 0.0;
    if (outside_s > limits.gate_tail_s) ++outside;
    if (std::isnan(check.value) || 1e3 * outside_s > check.value) {
      check.value = 1e3 * outside_s;
      worst_time_s = frame.mid_s;
    }
  }
  if (lit == 0 && gates.empty()) check.value = 0.0;
  // Light that was seen may have lasted until the next frame. Where frames are scarce that would prove
  // nothing at all: there the limit bounds it, and the explanation names the time of a frame.
  const double unseen_ms = check.value > 0.0 ? std::min(0.5e3 * followed.period_s, 0.25 * check.limit) : 0.0;
  const double seen_ms = check.value;
  check.value += unseen_ms;
  check.u = check.guard = 1e3 * evidence.clock_bound_s + unseen_ms;
  decide(check);
  if (gates.empty()) {
    check.explanation = lit == 0
                            ? "The gate was never on, and no spot was seen."
                            : fmt::format("The spot was seen in {} frames, but the pins show no gate.", lit);
    return check;
  }
  if (lit == 0) {
    check.explanation =
        fmt::format("The gate was on {} times, but the camera never saw the spot.", gates.size());
    return check;
  }
  if (check.value > 0.0) check.where = atTime(worst_time_s);
  check.explanation =
      check.value == 0.0
          ? fmt::format("All {} frames with the spot alight fall into one of {} gate intervals.", lit,
                        gates.size())
          : fmt::format(
                "The spot was seen up to {:.2f} ms outside the gate, at {:.3f} s; {} of {} frames are more "
                "than {:.1f} ms outside. Light that lasts for less than a frame of {:.1f} ms may not be "
                "seen.",
                seen_ms, worst_time_s, outside, lit, 1e3 * limits.gate_tail_s, 1e3 * followed.period_s);
  return check;
}

}  // namespace kerfbench::inspect::checks
