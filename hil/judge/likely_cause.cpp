// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/likely_cause.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "hil/diagnose/asked_motion.h"
#include "hil/diagnose/axes_fit.h"
#include "hil/inspect/evidence/emitted_light.h"
#include "hil/inspect/verdict/verdict.h"
#include "hil/judge/beam_aim.h"
#include "hil/judge/belt_place.h"
#include "hil/judge/gate_cause.h"

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

std::string axesCause(const scenario::Case& test_case, const SharedSteps& steps,
                      const inspect::Evidence& evidence) {
  const double start_x_mm = scenario::webOf(test_case).start_x_mm;
  std::vector<diagnose::LitInstant> path;
  for (const double time_s : instantsIn(evidence.light)) {
    const auto [x, y] = steps.at(time_s);
    path.push_back({Eigen::Vector2d(x, y), start_x_mm + beltAt_mm(evidence.belt, time_s)});
  }
  const scenario::Scenario& scenario = test_case.scenario;
  diagnose::AxesFitOptions options;
  options.worth_mm = kWorth * scenario.limits.path_mm;
  options.left_mm = kLeft * scenario.limits.path_mm;
  // Following the belt, and a path beside the lines, can look like a scale; where the program is known a
  // scale is found by comparing with it (hil/diagnose/stage_fit.h).
  options.with_scale = scenario.firmware.dialog != scenario::FirmwareChoice::Dialog::kKerfbench &&
                       !scenario.sheetMoves() && !scenario.belt_by_controller &&
                       scenario.job.kerf_radius_mm == 0.0;
  const std::optional<diagnose::AxesFit> fit =
      diagnose::fitAxes(path, placeOfSteps(test_case), *test_case.dieline, scenario.print, options);
  return fit ? diagnose::sentenceOf(*fit, namesOf(test_case.machine)) : std::string();
}

/// What the pulses ask for in each opening of the gate, as far as the beam has a place.
std::vector<diagnose::AskedCut> askedCuts(const scenario::Case& test_case, const SharedSteps& steps,
                                          const inspect::Evidence& evidence) {
  const diagnose::PlaceOfSteps place = placeOfSteps(test_case);
  const double start_x_mm = scenario::webOf(test_case).start_x_mm;
  const inspect::EmittedLight light(evidence.light);
  std::vector<diagnose::AskedCut> cuts;
  for (const inspect::GateInterval& gate : evidence.gates) {
    diagnose::AskedCut& cut = cuts.emplace_back();
    for (double from_s = gate.on_s; from_s + diagnose::kSpan_s <= gate.off_s; from_s += diagnose::kSpan_s) {
      const auto [x, y] = steps.at(from_s);
      const std::optional<Eigen::Vector2d> p_W_mm = place(Eigen::Vector2d(x, y));
      if (!p_W_mm) break;
      cut.push_back({*p_W_mm, start_x_mm + beltAt_mm(evidence.belt, from_s),
                     light.between(from_s, from_s + diagnose::kSpan_s) / diagnose::kSpan_s});
    }
  }
  return cuts;
}

/// The first of the checks with one of these names that fails.
const inspect::Check* failing(const std::vector<inspect::Check>& checks,
                              std::initializer_list<std::string_view> names) {
  const auto found = std::ranges::find_if(checks, [&](const inspect::Check& check) {
    return check.verdict == inspect::Verdict::kFail && std::ranges::find(names, check.name) != names.end();
  });
  return found == checks.end() ? nullptr : &*found;
}

/// How far off the axes may be because drives have made steps the wrong way, where DIR did not keep their
/// times.
double doubtfulSteps_mm(const scenario::Case& test_case, const inspect::Evidence& evidence) {
  std::uint64_t doubtful = 0;
  for (const PulseTiming& timing : evidence.pulses)
    doubtful += timing.setup_violations + timing.hold_violations;
  return 2.0 * diagnose::longestStep_mm(placeOfSteps(test_case)) * static_cast<double>(doubtful);
}

/// The joint that lies farthest off; null if none was measured.
const inspect::JointResult* worstJoint(const std::vector<inspect::JointResult>& joints) {
  using Kind = inspect::JointResult::Kind;
  const inspect::JointResult* worst = nullptr;
  for (const inspect::JointResult& joint : joints) {
    const bool is_judged = joint.kind != Kind::kRounding && joint.kind != Kind::kOvershoot &&
                           !joint.short_leg && std::isfinite(joint.mm.value);
    if (is_judged && (worst == nullptr || std::abs(joint.mm.value) > std::abs(worst->mm.value)))
      worst = &joint;
  }
  return worst;
}

/// How near to a corner the pulses lead while the laser shines: one that they cut off, or that the laser
/// leaves out, is no matter of the axes. Infinite where the beam has no place.
double nearestLit_mm(const scenario::Case& test_case, const SharedSteps& steps,
                     const inspect::Evidence& evidence, const inspect::JointResult& corner) {
  constexpr double kStep_s = 2e-4;
  constexpr double kFineStep_s = 2e-5;
  constexpr double kFineWithin_mm = 2.0;
  const diagnose::PlaceOfSteps place = placeOfSteps(test_case);
  const double origin_mm =
      scenario::webOf(test_case).start_x_mm - corner.unit * test_case.scenario.print.pitch_mm;
  const auto away_mm = [&](double time_s) {
    const auto [x, y] = steps.at(time_s);
    const std::optional<Eigen::Vector2d> p_W_mm = place(Eigen::Vector2d(x, y));
    if (!p_W_mm) return std::numeric_limits<double>::infinity();
    const Eigen::Vector2d sheet_mm(origin_mm + beltAt_mm(evidence.belt, time_s), 0.0);
    return (*p_W_mm - sheet_mm - corner.p_S_mm).norm();
  };
  double nearest_mm = std::numeric_limits<double>::infinity();
  for (const inspect::Span& span : evidence.light) {
    double at_s = span.from_s;
    while (at_s < span.to_s) {
      const double here_mm = away_mm(at_s);
      nearest_mm = std::min(nearest_mm, here_mm);
      at_s += here_mm < kFineWithin_mm ? kFineStep_s : kStep_s;
    }
    nearest_mm = std::min(nearest_mm, away_mm(span.to_s));
  }
  return nearest_mm;
}

std::string motionCause(const scenario::Case& test_case, const SharedSteps& steps,
                        const inspect::Evidence& evidence, const std::vector<diagnose::AskedCut>& cuts,
                        const inspect::JointResult& corner) {
  const scenario::Scenario& scenario = test_case.scenario;
  const double allowed_mm = kWorth * scenario.limits.path_mm;
  const auto asked = diagnose::askedMotion(cuts, *test_case.dieline, scenario.print);
  if (!asked || asked->off_mm > allowed_mm) return {};
  if (nearestLit_mm(test_case, steps, evidence, corner) > allowed_mm) return {};
  return fmt::format(
      "The axes do not follow at corners: the pulses lead to within {:.3f} mm of the drawing, and a corner "
      "of the cut "
      "lies {:.3f} mm off. The pulses ask for {:.0f} mm/s² along x and {:.0f} mm/s² along y at most: ask for "
      "less (Grbl: "
      "$120, $121).",
      asked->off_mm, corner.mm.value, asked->acceleration_mm_s2.x(), asked->acceleration_mm_s2.y());
}

}  // namespace

PlainCauses plainCauses(const scenario::Case& test_case, const source::PinRecording& recording,
                        const inspect::Evidence& evidence, const inspect::InspectionResult& result) {
  const std::vector<inspect::Check>& checks = result.checks;
  const std::shared_ptr<const SharedSteps> steps = stepsOf(test_case, recording);
  if (!steps) return {};
  PlainCauses causes;
  // What is lit with the gate the wrong way round says nothing of axes.
  causes.gate = gateCause(test_case, recording, evidence);
  if (causes.gate.empty()) causes.axes = axesCause(test_case, *steps, evidence);
  if (!causes.gate.empty() || !causes.axes.empty() ||
      failing(checks, {"path", "edge", "spot_path", "stillness_x", "stillness_peak", "gate_lag"}))
    return causes;
  if (!failing(checks, {"joints", "kerf_width", "line_energy", "dwell", "depth", "even_depth"})) return {};
  const std::vector<diagnose::AskedCut> cuts = askedCuts(test_case, *steps, evidence);
  if (const auto power = diagnose::steadyPower(cuts)) return {.steady_power = diagnose::sentenceOf(*power)};
  const inspect::JointResult* const worst = worstJoint(result.joints);
  if (failing(checks, {"joints"}) == nullptr || worst == nullptr ||
      worst->kind != inspect::JointResult::Kind::kCorner ||
      doubtfulSteps_mm(test_case, evidence) > worst->mm.value)
    return {};
  return {.corners = motionCause(test_case, *steps, evidence, cuts, *worst)};
}

}  // namespace kerfbench::judge
