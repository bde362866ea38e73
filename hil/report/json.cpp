// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hil/dieline/geometry.h"
#include "hil/report/causes.h"
#include "hil/report/diagnosis_section.h"
#include "hil/report/headline.h"
#include "hil/report/html_text.h"
#include "hil/report/json_parts.h"
#include "hil/report/run_report.h"

namespace kerfbench::report {
namespace {

OrderedJson budgetJson(const inspect::UncertaintyBudget& b) {
  OrderedJson j;
  j["quantity"] = b.quantity;
  j["unit"] = b.unit;
  j["as_read"] = rounded(b.as_read);
  j["sources"] = OrderedJson::array();
  for (const inspect::BudgetEntry& e : b.entries) {
    j["sources"].push_back({{"source", e.source},
                            {"standard_uncertainty", rounded(e.u)},
                            {"correction", rounded(-e.correction)}});
  }
  j["budget"] = {{"value", rounded(b.analytic_value)}, {"U", rounded(b.analytic_U)}};
  j["monte_carlo"] = {
      {"value", rounded(b.monte_carlo_value)}, {"U", rounded(b.monte_carlo_U)}, {"draws", b.draws}};
  return j;
}

// 12 digits: zeros of mirrors are a few urad.
OrderedJson digits(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::stod(fmt::format("{:.12g}", value));
}

OrderedJson modelJson(const ModelFacts& model) {
  OrderedJson j;
  j["twin"] = model.twin;
  j["imperfections"] = model.imperfections;
  j["sampled"] = OrderedJson::array();
  for (const SampledValue& sampled : model.sampled) {
    j["sampled"].push_back(
        {{"name", sampled.name}, {"value", digits(sampled.value)}, {"unit", sampled.unit}});
  }
  j["lost_steps"] = OrderedJson::array();
  for (const LostStepsNote& lost : model.lost_steps) {
    j["lost_steps"].push_back({{"axis", lost.axis},
                               {"time_s", rounded(lost.time_s)},
                               {"place", digits(lost.place)},
                               {"unit", lost.unit},
                               {"full_steps", lost.full_steps}});
  }
  if (model.partings.empty()) return j;
  j["partings"] = OrderedJson::array();
  for (const SpotParting& parting : model.partings) {
    j["partings"].push_back({{"unit", parting.unit},
                             {"entity", parting.entity},
                             {"from_s", rounded(parting.time_s.front())},
                             {"frames", parting.time_s.size()},
                             {"mean_x_mm", rounded(parting.mean_x_mm)},
                             {"mean_y_mm", rounded(parting.mean_y_mm)},
                             {"worst_mm", rounded(parting.worst_mm)},
                             {"worst_s", rounded(parting.worst_s)}});
  }
  return j;
}

OrderedJson cutsJson(const std::vector<inspect::CutResult>& cuts) {
  const auto judged =
      std::ranges::count_if(cuts, [](const inspect::CutResult& c) { return std::isfinite(c.drift_mm); });
  OrderedJson j = {{"count", cuts.size()}, {"judged", judged}, {"list", OrderedJson::array()}};
  for (const inspect::CutResult& c : cuts) j["list"].push_back(cutJson<OrderedJson>(c));
  return j;
}

OrderedJson inputsJson(const std::vector<InputFile>& inputs) {
  OrderedJson j = OrderedJson::array();
  for (const InputFile& input : inputs) j.push_back({{"file", input.name}, {"sha256", input.sha256}});
  return j;
}

OrderedJson evidenceJson(const std::vector<EvidencePart>& evidence) {
  OrderedJson j = OrderedJson::array();
  for (const EvidencePart& part : evidence) j.push_back({{"name", part.name}, {"sha256", part.sha256}});
  return j;
}

std::string_view timeName(inspect::Whereabouts::Time time) {
  using Time = inspect::Whereabouts::Time;
  switch (time) {
    case Time::kNone:
      break;
    case Time::kPins:
      return "pins";
    case Time::kFrame:
      return "frame";
    case Time::kPassing:
      return "passing";
    case Time::kMidway:
      return "midway";
  }
  return "unknown";
}

OrderedJson whereJson(const inspect::Whereabouts& where) {
  OrderedJson j;
  j["unit"] = where.unit >= 0 ? OrderedJson(where.unit) : OrderedJson();
  j["entity"] = where.entity >= 0 ? OrderedJson(where.entity) : OrderedJson();
  j["x_mm"] = rounded(where.x_mm);
  j["y_mm"] = rounded(where.y_mm);
  j["time_s"] = rounded(where.time_s);
  j["time_of"] = timeName(where.time);
  j["within_s"] = rounded(where.within_s);
  return j;
}

// Name of the check that brings each along, of those that did not pass.
std::map<std::string, std::string> leadersOf(const std::vector<inspect::Check>& checks) {
  std::map<std::string, std::string> leaders;
  for (const inspect::Verdict verdict :
       {inspect::Verdict::kFail, inspect::Verdict::kInvalid, inspect::Verdict::kNotProven})
    for (const FailureGroup& group : failureGroups(checks, verdict))
      for (const inspect::Check* check : group.followers) leaders[check->name] = group.primary->name;
  return leaders;
}

// The checks with what a person reads of them; the digest binds them without.
OrderedJson checksJson(const std::vector<inspect::Check>& checks) {
  OrderedJson list = OrderedJson::array();
  auto leaders = leadersOf(checks);
  for (const inspect::Check& c : checks) {
    auto j = checkJson<OrderedJson>(c);
    j["title"] = c.title;
    j["explanation"] = c.explanation;
    j["value_is"] = c.at_least ? "at_least" : "measured";
    j["where"] = whereJson(c.where);
    j["along_with"] = leaders[c.name];
    list.push_back(std::move(j));
  }
  return list;
}

// The entities with what the dieline says of each.
OrderedJson entitiesJson(const RunReport& report) {
  OrderedJson list = OrderedJson::array();
  for (const inspect::EntityResult& e : report.result.entities) {
    auto j = entityJson<OrderedJson>(e);
    const auto index = static_cast<std::size_t>(e.entity);
    if (index < report.dieline->entities.size()) {
      const dieline::Entity& entity = report.dieline->entities[index];
      j["process"] = dieline::processName(entity.process);
      j["layer"] = entity.layer;
      j["origin"] = entity.origin;
    }
    list.push_back(std::move(j));
  }
  return list;
}

OrderedJson headlineJson(const RunReport& report) {
  const Headline headline = headlineOf(report);
  return {{"check", headline.check}, {"what", headline.what}, {"how_much", headline.how_much},
          {"where", headline.where}, {"when", headline.when}, {"cause", headline.cause}};
}

}  // namespace

std::string verdictJson(const RunReport& report, const Digests& digests) {
  const inspect::InspectionResult& result = report.result;
  OrderedJson root;
  root["schema_version"] = 1;
  root["verdict"] = inspect::verdictName(result.verdict);
  root["exit_code"] = inspect::exitCode(result.verdict);
  root["summary"] = verdictSentence(report);
  root["headline"] = headlineJson(report);
  root["next_steps"] = nextSteps(report);
  root["likely_cause"] = likelyCauseOf(report);
  root["diagnosis"] = diagnosisJson(report);
  root["digest"] = digests.results;
  root["scenario"] = report.scenario;
  root["machine"] = report.machine;
  root["firmware"] = report.firmware;
  root["source"] = report.source_id;
  root["serial_number"] = report.serial_number;
  root["seed"] = report.seed;
  root["model"] = modelJson(report.model);
  root["virtual_s"] = rounded(report.virtual_s);
  root["problems"] = result.problems;
  root["checks"] = checksJson(result.checks);
  root["not_judged"] = OrderedJson::array();
  for (const inspect::Unjudged& u : result.unjudged)
    root["not_judged"].push_back(unjudgedJson<OrderedJson>(u));
  root["reservations"] = OrderedJson::array();
  for (const Reservation& r : reservationsOf(report))
    root["reservations"].push_back({{"kind", r.kind}, {"text", r.text}});
  root["entities"] = entitiesJson(report);
  root["layers"] = OrderedJson::array();
  for (const inspect::LayerResult& l : result.layers) {
    root["layers"].push_back({{"layer", l.layer},
                              {"worst_mm", quantityJson<OrderedJson>(l.worst_mm)},
                              {"rms_mm", quantityJson<OrderedJson>(l.rms_mm)}});
  }
  root["rms_mm"] = quantityJson<OrderedJson>(result.rms_mm);
  root["joints"] = OrderedJson::array();
  for (const inspect::JointResult& j : result.joints) root["joints"].push_back(jointJson<OrderedJson>(j));
  root["uncertainty_budgets"] = OrderedJson::array();
  for (const inspect::UncertaintyBudget& b : result.budgets)
    root["uncertainty_budgets"].push_back(budgetJson(b));
  root["cuts"] = cutsJson(result.cuts);
  root["pulses"] = OrderedJson::array();
  for (const PulseTiming& t : report.pulses) root["pulses"].push_back(pulseJson<OrderedJson>(t));
  root["frames"] = {{"count", report.spot.frames.size()}, {"lost", report.spot.frames_lost}};
  root["mark_residual_mm"] = rounded(report.kerf.mark_residual_mm);
  root["inputs_digest"] = digests.inputs;
  root["inputs"] = inputsJson(report.inputs);
  root["evidence"] = evidenceJson(report.evidence);
  root["versions"] = OrderedJson::object();
  for (const auto& [name, version] : report.versions) root["versions"][name] = version;
  root["repeat_command"] = report.repeat_command;
  return root.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

}  // namespace kerfbench::report
