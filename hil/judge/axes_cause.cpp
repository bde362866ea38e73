// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/axes_cause.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "hil/diagnose/axes_fit.h"
#include "hil/judge/beam_aim.h"

namespace kerfbench::judge {
namespace {

constexpr std::size_t kLookedAt = 400;
/// Share of the path's limit from which on a distance is worth a cause.
constexpr double kWorth = 0.4;
/// Share of the limit that a cause leaves at most: belts and loops that are followed leave something.
constexpr double kLeft = 2.0;

std::array<diagnose::AxisNames, 2> namesOf(const twin::MachineDescription& machine) {
  if (machine.kind == twin::MachineDescription::Kind::kGantry)
    return {{{"gantry_x", "step_mm"}, {"gantry_y", "step_mm"}}};
  return {{{"galvo_x", "step_urad"}, {"galvo_y", "step_urad"}}};
}

/// Instants spread evenly over the time in which the laser shone.
std::vector<double> instantsIn(const std::vector<inspect::Span>& light) {
  double lit_s = 0.0;
  for (const inspect::Span& span : light) lit_s += span.to_s - span.from_s;
  const double pitch_s = lit_s / static_cast<double>(kLookedAt);
  std::vector<double> times_s;
  double behind_s = 0.5 * pitch_s;  // From the begin of a span to its first instant.
  for (const inspect::Span& span : light) {
    double at_s = span.from_s + behind_s;
    for (; at_s < span.to_s && pitch_s > 0.0; at_s += pitch_s) times_s.push_back(at_s);
    behind_s = at_s - span.to_s;
  }
  return times_s;
}

double beltAt_mm(const std::vector<inspect::BeltEdge>& belt, double time_s) {
  const auto next = std::ranges::upper_bound(belt, time_s, {}, &inspect::BeltEdge::time_s);
  return next == belt.begin() ? 0.0 : (next - 1)->x_mm;
}

}  // namespace

std::string axesCause(const scenario::Case& test_case, const source::PinRecording& recording,
                      const inspect::Evidence& evidence) {
  const std::shared_ptr<const SharedSteps> steps = stepsOf(test_case, recording);
  if (!steps) return {};
  const double start_x_mm = scenario::webOf(test_case).start_x_mm;
  std::vector<diagnose::LitInstant> path;
  for (const double time_s : instantsIn(evidence.light)) {
    const auto [x, y] = steps->at(time_s);
    path.push_back({Eigen::Vector2d(x, y), start_x_mm + beltAt_mm(evidence.belt, time_s)});
  }
  const scenario::Scenario& scenario = test_case.scenario;
  diagnose::AxesFitOptions options;
  options.worth_mm = kWorth * scenario.limits.path_mm;
  options.left_mm = kLeft * scenario.limits.path_mm;
  // Following the belt, and a path beside the lines, can look like a scale.
  options.with_scale =
      !scenario.sheetMoves() && !scenario.belt_by_controller && scenario.job.kerf_radius_mm == 0.0;
  const std::optional<diagnose::AxesFit> fit =
      diagnose::fitAxes(path, placeOfSteps(test_case), *test_case.dieline, scenario.print, options);
  return fit ? diagnose::sentenceOf(*fit, namesOf(test_case.machine)) : std::string();
}

}  // namespace kerfbench::judge
