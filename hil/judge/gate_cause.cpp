// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/gate_cause.h"

#include <algorithm>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "hil/diagnose/gate_fit.h"
#include "hil/judge/beam_aim.h"
#include "hil/judge/belt_place.h"

namespace kerfbench::judge {
namespace {

constexpr std::size_t kLooks = 4000;
/// Distance from the drawing within which a path is one along it: what it may be off, and run ahead of a
/// belt.
constexpr double kNear_mm = 0.5;

/// When the gate was open. Without a PWM line it may be chopped by its own, and each of its pulses is one.
std::vector<inspect::Span> openSpans(const scenario::Case& test_case, const inspect::Evidence& evidence) {
  if (!test_case.machine.signals.pin(Signal::kLaserPwm)) return evidence.light;
  std::vector<inspect::Span> spans;
  for (const inspect::GateInterval& gate : evidence.gates) spans.push_back({gate.on_s, gate.off_s});
  return spans;
}

bool isWithin(const std::vector<inspect::Span>& spans, double time_s) {
  const auto next = std::ranges::upper_bound(spans, time_s, {}, &inspect::Span::from_s);
  return next != spans.begin() && time_s < (next - 1)->to_s;
}

}  // namespace

std::string gateCause(const scenario::Case& test_case, const source::PinRecording& recording,
                      const inspect::Evidence& evidence) {
  const std::shared_ptr<const SharedSteps> steps = stepsOf(test_case, recording);
  if (!steps) return {};
  const double start_x_mm = scenario::webOf(test_case).start_x_mm;
  const std::vector<inspect::Span> open = openSpans(test_case, evidence);
  diagnose::GatedPath path;
  auto before = steps->at(0.0);
  for (std::size_t i = 1; i <= kLooks; ++i) {
    const double time_s =
        recording.rate.seconds(recording.end) * static_cast<double>(i) / static_cast<double>(kLooks);
    const auto now = steps->at(time_s);
    const bool is_moving = now != before;
    before = now;
    if (!is_moving) continue;
    (isWithin(open, time_s) ? path.open : path.closed)
        .push_back({Eigen::Vector2d(now[0], now[1]), start_x_mm + beltAt_mm(evidence.belt, time_s)});
  }
  const scenario::Scenario& scenario = test_case.scenario;
  if (!diagnose::isGateInverted(path, placeOfSteps(test_case), *test_case.dieline, scenario.print,
                                kNear_mm + scenario.job.kerf_radius_mm))
    return {};
  const bool is_low = test_case.machine.laser.gate_low;
  return fmt::format(
      "The laser's gate is open between the cuts and closed in them: invert the gate in the firmware, or set "
      "`laser.gate_low: {}` if the laser may emit while that pin is {}.",
      !is_low, is_low ? "high" : "low");
}

}  // namespace kerfbench::judge
