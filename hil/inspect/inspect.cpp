// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/inspect.h"

#include <algorithm>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "hil/inspect/checks/spot_checks.h"
#include "hil/inspect/edges/edges.h"
#include "hil/inspect/evidence/spot_association.h"
#include "hil/inspect/evidence/whereabouts.h"

namespace kerfbench::inspect {
namespace {

/// What makes every further look pointless, because the parts of the evidence do not fit together.
std::vector<std::string> structuralProblems(const Evidence& evidence) {
  std::vector<std::string> problems;
  const auto& entities = evidence.dieline->entities;
  for (std::size_t i = 0; i < entities.size(); ++i) {
    if (entities[i].id != static_cast<int>(i))
      problems.push_back(fmt::format("Entity {} has the id {}.", i, entities[i].id));
  }
  if (std::all_of(entities.begin(), entities.end(),
                  [](const dieline::Entity& e) { return e.process == dieline::Process::kIgnore; })) {
    problems.emplace_back("The dieline has nothing to cut.");
  }
  if (evidence.kerf.entities.empty()) problems.emplace_back("No entity was measured by the kerf camera.");
  for (const vision::EntityKerf& kerf : evidence.kerf.entities) {
    if (kerf.entity < 0 || kerf.entity >= static_cast<int>(entities.size())) {
      problems.push_back(
          fmt::format("The kerf scan names E{}, which the dieline does not have.", kerf.entity));
    }
  }
  return problems;
}

void append(std::vector<std::string>& to, const std::vector<std::string>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// What needs no camera.
std::vector<Finding> pinFindings(const Evidence& evidence) {
  return {checks::pulseTimingCheck(evidence), checks::interlockCheck(evidence),
          checks::accountFinding(evidence), checks::finishFinding(evidence)};
}

/// A finding taken back; what does not apply stays so.
Finding withheld(const Finding& finding, const std::string& reason) {
  return finding ? notJudged(*finding, reason) : finding;
}

/// Takes back what judges nothing, for a reason that all have in common; what does not apply stays so.
void withhold(std::vector<Finding>& findings, const std::string& reason) {
  for (Finding& finding : findings) finding = withheld(finding, reason);
}

void add(const Finding& finding, InspectionResult& result) {
  if (finding) {
    result.checks.push_back(*finding);
  } else {
    result.unjudged.push_back(finding.why());
  }
}

/// Dark for no longer than this the laser is still fed: pulses of weak marks, at a twentieth of a power that
/// is given out each 0.1 ms. A bridge of a perforation, 1 mm at 300 mm/s, takes longer.
constexpr double kBetweenPulses_s = 2e-3;

/// When the laser was fed: openings of the gate, without what the PWM line keeps dark in them. A firmware may
/// jump with its gate open, and no power.
std::vector<GateInterval> fedIntervals(const Evidence& evidence) {
  std::vector<GateInterval> gates = evidence.gates;
  std::ranges::sort(gates, {}, &GateInterval::on_s);
  std::vector<GateInterval> fed;
  auto last = gates.end();
  for (const Span& pulse : evidence.light) {
    const auto gate = std::ranges::upper_bound(gates, pulse.from_s, {}, &GateInterval::on_s);
    if (!fed.empty() && gate == last && pulse.from_s - fed.back().off_s <= kBetweenPulses_s) {
      fed.back().off_s = pulse.to_s;
    } else {
      fed.push_back({pulse.from_s, pulse.to_s});
    }
    last = gate;
  }
  return fed;
}

/// What the cameras show, measured. With `edges` the evidence's kerf is an edgeScan().
struct Measured {
  const Evidence& evidence;
  const Tolerances& limits;
  const checks::EdgeSides* edges;
  double half_light_mm{};  ///< Half of the kerfs' mean width by the light.
  double half_kerf_mm{};
  LitFrames lit{};
  DeviationResult deviations{};
  checks::Stillness stillness{};
};

Measured measured(const Evidence& evidence, const Tolerances& limits, const checks::EdgeSides* edges,
                  double half_light_mm, InspectionResult& result) {
  Measured m{evidence, limits, edges, half_light_mm};
  m.lit = followDieline(evidence.spot, *evidence.dieline, fedIntervals(evidence));
  m.half_kerf_mm = edges != nullptr ? checks::halfKerf(evidence.kerf, *edges) : 0.0;
  std::optional<LitFrames> from_kerf;  // Only where it differs.
  if (edges != nullptr) {
    from_kerf = m.lit;
    checks::measureFromBeamLine(*edges, m.half_kerf_mm, m.lit);
    checks::measureFromOwnKerf(evidence.kerf, *edges, *from_kerf);
  }
  append(result.problems, checks::spotProblems(evidence, m.lit));

  m.deviations = checks::measureLines(evidence, limits, edges);
  result.entities = checks::measureEntities(evidence, limits, m.deviations);
  result.rms_mm = m.deviations.all.rms;
  for (std::size_t i = 0; i < m.deviations.layers.size(); ++i) {
    result.layers.push_back(
        {m.deviations.layer_names[i], m.deviations.layers[i].worst, m.deviations.layers[i].rms});
  }
  result.joints = checks::measureJoints(evidence);
  checks::countPasses(evidence, m.lit, result.entities);
  m.stillness = checks::measureCuts(evidence, from_kerf ? *from_kerf : m.lit, limits);
  result.cuts = m.stillness.cuts;
  for (const UncertaintyBudget& budget : {m.deviations.budget, m.stillness.budget}) {
    if (!budget.entries.empty()) result.budgets.push_back(budget);
  }
  return m;
}

/// Checks that need something burnt, something lit, or neither; in the order of the report.
std::vector<Finding> cameraFindings(const Measured& m, const InspectionResult& result) {
  const Evidence& evidence = m.evidence;
  const Tolerances& limits = m.limits;
  const Check path = checks::pathCheck(evidence, limits, m.deviations);
  std::vector<Finding> cut{
      m.edges == nullptr ? path : checks::edgeCheck(path, *m.edges, m.half_kerf_mm, m.half_light_mm),
      checks::jointsCheck(evidence, limits, result.joints, result.entities)};
  std::vector<Finding> lit{checks::stillnessCheck(limits, m.lit, m.stillness),
                           checks::excursionCheck(limits, m.stillness),
                           checks::beltCheck(evidence, limits, m.lit),
                           checks::spotSeenCheck(evidence, m.lit),
                           checks::spotPathCheck(evidence, limits, m.lit),
                           checks::repeatCheck(evidence, limits, m.lit, result.entities),
                           checks::dwellCheck(evidence, limits, m.lit)};
  std::vector<Finding> form{checks::bridgesCheck(evidence, limits),
                            checks::depthCheck(evidence, limits),
                            checks::evenDepthCheck(evidence, limits),
                            checks::orderedDepthCheck(evidence, limits),
                            checks::perforationCheck(evidence, limits),
                            checks::kerfWidthCheck(evidence, limits, result.entities),
                            checks::orderedWidthCheck(evidence, limits, result.entities),
                            checks::laserTimingCheck(evidence, limits, result.entities, m.edges)};
  std::vector<Finding> light{checks::laserGateCheck(evidence, limits, m.lit),
                             checks::gateLagCheck(evidence, limits, m.lit),
                             checks::lineEnergyCheck(evidence, limits, m.lit)};
  const bool blank = checks::isBlank(result.entities);
  if (!blank && checks::isElsewhere(evidence)) {
    const std::string reason =
        "Most of the cut lies where no line of the dieline is, so the kerfs that were read belong to others "
        "or to "
        "none; see path, coverage and stray.";
    cut[1] = withheld(cut[1], reason);
    withhold(form, reason);
  }
  if (checks::isBesideEveryLine(m.lit)) {
    const std::string reason =
        "Nearly all frames show the spot beside every line, so nothing tells which of them it followed; see "
        "spot_path.";
    for (Finding* finding : {&lit[0], &lit[1], &lit[5], &light[1]}) *finding = withheld(*finding, reason);
  }
  const bool dark = m.lit.lit == 0;
  if (blank) {
    withhold(cut, "Nothing was cut along the dieline; see coverage.");
    withhold(form, "Nothing was cut along the dieline; see coverage.");
  }
  if (blank && dark) {
    withhold(lit, "Nothing was cut and no spot was seen; see coverage.");
    withhold(light, "Nothing was cut and no spot was seen; see coverage.");
  }
  std::vector<Finding> all;
  for (std::vector<Finding>* part : {&cut, &lit}) std::ranges::move(*part, std::back_inserter(all));
  all.emplace_back(checks::coverageCheck(evidence, limits, result.entities));
  std::ranges::move(form, std::back_inserter(all));
  all.emplace_back(checks::strayCheck(evidence, limits));
  std::ranges::move(light, std::back_inserter(all));
  return all;
}

bool anyFails(const std::vector<Check>& checks, std::initializer_list<std::string_view> names) {
  return std::ranges::any_of(checks, [&](const Check& check) {
    return check.verdict == Verdict::kFail && std::ranges::find(names, check.name) != names.end();
  });
}

void measureAndDecide(const Evidence& evidence, const Tolerances& limits, const checks::EdgeSides* edges,
                      double half_light_mm, InspectionResult& result) {
  append(result.problems, checks::kerfProblems(evidence));
  const Measured m = measured(evidence, limits, edges, half_light_mm, result);
  const bool sound = result.problems.size() == evidence.guard_problems.size();
  const std::vector<std::string> doubts = checks::doubtsOf(evidence, m.lit, limits);
  append(result.problems, doubts);
  for (const Finding& finding : cameraFindings(m, result)) add(finding, result);
  for (const Finding& finding : pinFindings(evidence)) add(finding, result);
  for (Check& check : result.checks) {
    complete(check.where, m.lit, *evidence.dieline);
    if (const std::string risk = riskSentence(check); !risk.empty()) check.explanation += " " + risk;
  }
  // No reading's value can argue away that a line is not there, that something is burnt elsewhere, or that
  // the laser was on behind an open guard; the last is a matter of pins alone.
  const bool is_unguarded = anyFails(result.checks, {"interlock"});
  const bool is_proven = is_unguarded || anyFails(result.checks, {"coverage", "stray"});
  const bool is_trusted =
      sound && (doubts.empty() || is_proven) && (evidence.guard_problems.empty() || is_unguarded);
  result.verdict = combine(result.checks, is_trusted);
}

}  // namespace

InspectionResult inspect(const Evidence& evidence, const Tolerances& limits) {
  if (evidence.dieline == nullptr) throw std::invalid_argument("inspect: the evidence has no dieline");
  InspectionResult result;
  result.problems = evidence.problems;
  append(result.problems, evidence.guard_problems);
  append(result.problems, evidence.kerf.problems);
  if (evidence.gates.empty() && evidence.end && stoppedByItself(*evidence.end, evidence.gates)) {
    const bool sound = result.problems.empty();
    for (const Finding& finding : pinFindings(evidence)) add(finding, result);
    result.verdict = combine(result.checks, sound);
    return result;
  }
  auto structural = structuralProblems(evidence);
  append(structural, checks::numberProblems(evidence, limits));
  append(result.problems, structural);
  if (!structural.empty()) return result;
  if (limits.edge == Tolerances::Edge::kCentre) {
    measureAndDecide(evidence, limits, nullptr, 0.0, result);
    return result;
  }
  const checks::EdgeSides edges = checks::kerfSides(*evidence.dieline, limits.edge, limits.open_cuts);
  append(result.problems, edges.problems);
  Evidence at_edges = evidence;
  const double half_light_mm = checks::halfKerf(evidence.kerf, edges);
  if (evidence.beam_radius_mm > 0.0) {
    at_edges.kerf =
        checks::severedScan(evidence.kerf, edges, evidence.beam_radius_mm, limits.board_transmission);
  }
  at_edges.kerf = checks::edgeScan(at_edges.kerf, *evidence.dieline, edges);
  measureAndDecide(at_edges, limits, &edges, half_light_mm, result);
  result.edges = std::move(at_edges.kerf);
  return result;
}

}  // namespace kerfbench::inspect
