// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/inspect.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "hil/inspect/checks/checks.h"
#include "hil/inspect/checks/spot_checks.h"
#include "hil/inspect/edges/edges.h"
#include "hil/inspect/evidence/spot_association.h"

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
std::vector<Check> pinChecks(const Evidence& evidence) {
  std::vector<Check> of_pins{checks::pulseTimingCheck(evidence)};
  if (evidence.account) of_pins.push_back(checks::accountCheck(*evidence.account));
  if (evidence.end) of_pins.push_back(checks::finishCheck(*evidence.end, evidence.gates));
  return of_pins;
}

/// What the cameras show, measured. With `edges` the evidence's kerf is an edgeScan().
struct Measured {
  const Evidence& evidence;
  const Tolerances& limits;
  const checks::EdgeSides* edges;
  double half_kerf_mm{};
  LitFrames lit{};
  DeviationResult deviations{};
  checks::Stillness stillness{};
};

Measured measured(const Evidence& evidence, const Tolerances& limits, const checks::EdgeSides* edges,
                  InspectionResult& result) {
  Measured m{evidence, limits, edges};
  m.lit = followDieline(evidence.spot, *evidence.dieline);
  m.half_kerf_mm = edges != nullptr ? checks::halfKerf(evidence.kerf, *edges) : 0.0;
  LitFrames motion = m.lit;
  if (edges != nullptr) {
    checks::measureFromBeamLine(*edges, m.half_kerf_mm, m.lit);
    checks::measureFromOwnKerf(evidence.kerf, *edges, motion);
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
  m.stillness = checks::measureCuts(evidence, motion, limits);
  result.cuts = m.stillness.cuts;
  for (const UncertaintyBudget& budget : {m.deviations.budget, m.stillness.budget}) {
    if (!budget.entries.empty()) result.budgets.push_back(budget);
  }
  return m;
}

/// Checks that need something burnt, something lit, or neither; in the order of the report.
void addCameraChecks(const Measured& m, InspectionResult& result) {
  const auto add = [&](auto check) {
    if constexpr (requires { check.has_value(); }) {
      if (check) result.checks.push_back(std::move(*check));
    } else {
      result.checks.push_back(std::move(check));
    }
  };
  const bool blank = checks::isBlank(result.entities);
  const bool dark = m.lit.lit == 0;
  if (!blank) {
    Check path = checks::pathCheck(m.evidence, m.limits, m.deviations);
    add(m.edges == nullptr ? path : checks::edgeCheck(path, *m.edges, m.half_kerf_mm));
    add(checks::jointsCheck(m.evidence, m.limits, result.joints, result.entities));
  }
  if (!(blank && dark)) {
    add(checks::stillnessCheck(m.limits, m.lit, m.stillness));
    add(checks::excursionCheck(m.limits, m.stillness));
    add(checks::beltCheck(m.evidence, m.limits, m.lit));
    add(checks::spotSeenCheck(m.evidence, m.lit));
    add(checks::spotPathCheck(m.evidence, m.limits, m.lit));
  }
  add(checks::coverageCheck(m.evidence, m.limits, result.entities));
  if (!(blank && dark)) add(checks::repeatCheck(m.evidence, m.limits, m.lit, result.entities));
  if (!blank) {
    add(checks::depthCheck(m.evidence, m.limits));
    add(checks::evenDepthCheck(m.evidence, m.limits));
    add(checks::perforationCheck(m.evidence, m.limits, result.entities));
    add(checks::kerfWidthCheck(m.evidence, m.limits, result.entities));
    add(checks::laserTimingCheck(m.evidence, m.limits, result.entities, m.edges));
  }
  add(checks::strayCheck(m.evidence, m.limits));
  if (!(blank && dark)) {
    add(checks::laserGateCheck(m.evidence, m.limits));
    add(checks::gateLagCheck(m.evidence, m.limits, m.lit));
    add(checks::lineEnergyCheck(m.evidence, m.limits, m.lit));
  }
}

void measureAndDecide(const Evidence& evidence, const Tolerances& limits, const checks::EdgeSides* edges,
                      InspectionResult& result) {
  append(result.problems, checks::kerfProblems(evidence));
  addCameraChecks(measured(evidence, limits, edges, result), result);
  for (Check& check : pinChecks(evidence)) result.checks.push_back(std::move(check));
  for (Check& check : result.checks) {
    if (const std::string risk = riskSentence(check); !risk.empty()) check.explanation += " " + risk;
  }
  result.verdict = combine(result.checks, result.problems.empty());
}

}  // namespace

InspectionResult inspect(const Evidence& evidence, const Tolerances& limits) {
  if (evidence.dieline == nullptr) throw std::invalid_argument("inspect: the evidence has no dieline");
  InspectionResult result;
  result.problems = evidence.problems;
  append(result.problems, evidence.kerf.problems);
  if (evidence.gates.empty() && evidence.end && stoppedByItself(*evidence.end, evidence.gates)) {
    const bool sound = result.problems.empty();
    result.checks = pinChecks(evidence);
    result.verdict = combine(result.checks, sound);
    return result;
  }
  auto structural = structuralProblems(evidence);
  append(structural, checks::numberProblems(evidence, limits));
  append(result.problems, structural);
  if (!structural.empty()) return result;
  if (limits.edge == Tolerances::Edge::kCentre) {
    measureAndDecide(evidence, limits, nullptr, result);
    return result;
  }
  const checks::EdgeSides edges = checks::kerfSides(*evidence.dieline, limits.edge);
  append(result.problems, edges.problems);
  Evidence at_edges = evidence;
  at_edges.kerf = checks::edgeScan(evidence.kerf, *evidence.dieline, edges);
  measureAndDecide(at_edges, limits, &edges, result);
  result.edges = std::move(at_edges.kerf);
  return result;
}

}  // namespace kerfbench::inspect
