// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/diagnosis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/diagnose/direct_causes.h"
#include "hil/diagnose/fitted_causes.h"
#include "hil/diagnose/lost_steps.h"

namespace kerfbench::diagnose {
namespace {

bool has(const std::vector<Cause>& causes, std::string_view key) {
  return std::ranges::any_of(causes, [&](const Cause& cause) { return cause.key == key; });
}

bool isOfPulses(const Cause& cause) { return cause.key == kPulsesLost || cause.key == kPulsesDoubled; }

/// What pins show and what fits can be one and the same: the fit then says how much it explains.
void merge(std::vector<Cause>& direct, std::vector<Cause>& fitted) {
  for (Cause& seen : direct) {
    const auto same = std::ranges::find_if(fitted, [&](const Cause& cause) {
      return (isOfPulses(seen) && isOfPulses(cause)) || (seen.key == "loop_soft" && cause.key == seen.key) ||
             (seen.key == "dir_timing" && (cause.key == "axis_slipped" || cause.key == kPulledOut));
    });
    if (same == fitted.end()) continue;
    seen.share = same->share;
    seen.left_mm = same->left_mm;
    seen.score = same->score;
    if (isOfPulses(seen)) {
      seen.key = same->key;
      seen.size.U = std::max(seen.size.U, 0.0);
      seen.sentence += " " + same->sentence;
    }
    fitted.erase(same);
  }
}

/// A cause that explains less of the deviation than this is not the answer to why.
constexpr double kMostOfIt = 0.5;

/// Where nearly all of a deviation arises that nothing explains, or little of it, and what to look at there;
/// empty: not at one place, or too little.
std::string whereItArises(const Fitted& fitted, const Evidence& evidence, bool is_partly_explained) {
  constexpr double kNearlyAll = 0.8;
  constexpr double kWorthOfLimit = 0.3;
  const double sum = fitted.stage_mm2[0] + fitted.stage_mm2[1] + fitted.stage_mm2[2];
  if (!(fitted.deviation_mm > kWorthOfLimit * evidence.limit_mm) || !(sum > 0.0)) return {};
  const auto most = std::ranges::max_element(fitted.stage_mm2);
  if (*most < kNearlyAll * sum) return {};
  const std::array<const char*, 3> kSaid{
      "between drawing and program: look at the planner or at the G-code that was sent",
      "between program and pulses: look at the release, at what it was told of the machine, and at how it "
      "follows the belt",
      "between pulses and beam: the pulses are right; look at the calibration of the head (correction table, "
      "mounting) "
      "and at the axes"};
  return fmt::format("No known cause{}, but {:.0f} % of the deviation arise {}.",
                     is_partly_explained ? " explains most of it" : "", 100.0 * *most / sum,
                     kSaid[static_cast<std::size_t>(most - fitted.stage_mm2.begin())]);
}

std::string noneSentence(const Fitted& fitted, bool is_partly_explained) {
  const std::string none = is_partly_explained ? "No known cause explains most of this."
                                               : "None of the known causes explains this.";
  double sum = 0.0;
  for (const double square : fitted.stage_mm2) sum += square;
  if (!(sum > 0.0) || std::isnan(fitted.deviation_mm)) return none;
  return fmt::format(
      "{} Of the deviation of {:.3f} mm RMS {:.0f} % arise between drawing and program, {:.0f} % "
      "between program and pulses, {:.0f} % between pulses and cut.",
      none, fitted.deviation_mm, 100.0 * fitted.stage_mm2[0] / sum, 100.0 * fitted.stage_mm2[1] / sum,
      100.0 * fitted.stage_mm2[2] / sum);
}

}  // namespace

Diagnosis diagnose(const Evidence& evidence) {
  Diagnosis diagnosis;
  if (evidence.passed) return diagnosis;
  std::vector<Cause> direct = directCauses(evidence);
  Fitted fitted;
  // With an edge the cut lies beside the line on purpose.
  if (!evidence.edges_judged) fitted = fittedCauses(evidence);
  diagnosis.deviation_mm = fitted.deviation_mm;
  merge(direct, fitted.causes);
  // A sheet that is not followed leaves nothing else to be fitted.
  if (has(direct, "belt_ignored")) {
    for (Cause& seen : direct)
      for (const Cause& cause : fitted.causes)
        if (seen.key == "belt_ignored" && cause.key == seen.key) seen.share = cause.share;
    fitted.causes.clear();
  }
  // Steps that go the wrong way at reversals look like play, and like a slip.
  if (has(direct, "dir_timing"))
    std::erase_if(fitted.causes, [](const Cause& cause) {
      return cause.key == "backlash_x" || cause.key == "backlash_y" || cause.key == "axis_slipped";
    });
  // Axes that are swapped, or a gate that is inverted, leave nothing to be fitted.
  const bool is_elsewhere = has(direct, kPulledOut) || has(direct, kBeamUnseen);
  if (is_elsewhere || has(direct, "axes") || has(direct, "gate_inverted") || has(direct, "encoder_reversed"))
    fitted.causes.clear();
  diagnosis.causes = std::move(direct);
  std::ranges::move(fitted.causes, std::back_inserter(diagnosis.causes));
  for (Cause& cause : diagnosis.causes) {
    if (cause.instead.empty()) continue;
    cause.sentence += fmt::format(" This run cannot tell it from: {}.", fmt::join(cause.instead, ", "));
  }
  const bool is_partly_explained = !diagnosis.causes.empty();
  if (is_partly_explained) diagnosis.sentence = diagnosis.causes.front().sentence;
  if (!evidence.failed || (is_partly_explained && explainsMost(diagnosis.causes.front()))) return diagnosis;
  diagnosis.arises = whereItArises(fitted, evidence, is_partly_explained);
  diagnosis.sentence = is_partly_explained && !diagnosis.arises.empty()
                           ? diagnosis.arises
                           : noneSentence(fitted, is_partly_explained);
  return diagnosis;
}

bool explainsMost(const Cause& cause) {
  return cause.direct || std::isnan(cause.share) || cause.share >= kMostOfIt;
}

const std::vector<std::string>& causeKeys() {
  static const std::vector<std::string> kKeys{"axes",
                                              "axes_lag",
                                              "axis_lag_x",
                                              "axis_lag_y",
                                              "axis_slipped",
                                              "backlash_x",
                                              "backlash_y",
                                              "beam_unseen",
                                              "belt_ignored",
                                              "dir_timing",
                                              "encoder_reversed",
                                              "encoder_scale",
                                              "entity_missing",
                                              "entity_twice",
                                              "gate_early",
                                              "gate_inverted",
                                              "gate_late",
                                              "head_offset",
                                              "head_rotation",
                                              "head_scale",
                                              "head_scale_x",
                                              "head_scale_y",
                                              "head_shear",
                                              "kerf_radius",
                                              "kerf_uncompensated",
                                              "kerf_wrong_side",
                                              "latency",
                                              "loop_soft",
                                              "mean_speed",
                                              "pincushion_missing",
                                              "power_loop_rings",
                                              "power_scale",
                                              "power_steady",
                                              "program_offset",
                                              "program_rotation",
                                              "program_scale",
                                              "program_scale_x",
                                              "program_scale_y",
                                              "program_shear",
                                              "pulse_width",
                                              "pulses_doubled",
                                              "pulses_lost",
                                              "sheet_reference",
                                              "step_scale",
                                              "step_scale_x",
                                              "step_scale_y",
                                              "stepper_pulled_out",
                                              "stopped",
                                              "table_missing",
                                              "table_other",
                                              "table_sign"};
  return kKeys;
}

}  // namespace kerfbench::diagnose
