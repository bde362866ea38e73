// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hil/base/digest.h"
#include "hil/dieline/geometry.h"
#include "hil/report/html_text.h"
#include "hil/report/run_report.h"

namespace kerfbench::report {
namespace {

using Json = nlohmann::json;                 // Keys sorted: canonical.
using OrderedJson = nlohmann::ordered_json;  // Keys as a reader likes them.

/// 1 nm for lengths in mm, 1e-6 for the rest; null where there is no number.
Json rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(value * 1e6) / 1e6 + 0.0;  // + 0.0 turns -0 into 0.
}

Json roundedAll(const std::vector<double>& values) {
  Json array = Json::array();
  for (const double v : values) array.push_back(rounded(v));
  return array;
}

template <typename T, typename Key>
std::vector<const T*> sortedBy(const std::vector<T>& items, Key key) {
  std::vector<const T*> pointers;
  for (const T& item : items) pointers.push_back(&item);
  std::stable_sort(pointers.begin(), pointers.end(),
                   [&](const T* a, const T* b) { return key(*a) < key(*b); });
  return pointers;
}

template <typename J>
J checkJson(const inspect::Check& c) {
  J j;
  j["name"] = c.name;
  j["verdict"] = inspect::verdictName(c.verdict);
  j["value"] = rounded(c.value);
  j["unit"] = c.unit;
  j["limit"] = rounded(c.limit);
  j["limit_is"] = c.upper ? "upper" : "lower";
  j["guard"] = rounded(c.guard);
  j["expanded_uncertainty"] = rounded(c.u);
  j["chance_beyond_limit"] = rounded(c.chance_beyond);
  j["subject"] = c.subject;
  return j;
}

template <typename J>
J unjudgedJson(const inspect::Unjudged& u) {
  J j;
  j["name"] = u.name;
  j["title"] = u.title;
  j["applies"] = u.applies;
  j["reason"] = u.reason;
  return j;
}

template <typename J>
J entityJson(const inspect::EntityResult& e) {
  J j;
  j["unit"] = e.unit;
  j["entity"] = e.entity;
  j["worst_mm"] = rounded(e.worst_mm);
  j["worst_U_mm"] = rounded(e.worst_U_mm);
  j["worst_u"] = rounded(e.worst_u);
  j["rms_mm"] = rounded(e.rms_mm);
  j["rms_U_mm"] = rounded(e.rms_U_mm);
  j["coverage"] = rounded(e.coverage);
  j["uncut_mm"] = rounded(e.uncut_mm);
  j["width_mm"] = rounded(e.width_mm);
  j["width_U_mm"] = rounded(e.width_U_mm);
  j["circularity_mm"] = rounded(e.circularity_mm);
  j["circularity_U_mm"] = rounded(e.circularity_U_mm);
  j["passes"] = rounded(e.passes);
  return j;
}

template <typename J>
J cutJson(const inspect::CutResult& c) {
  J j;
  j["unit"] = c.unit;
  j["entity"] = c.entity;
  j["start_s"] = rounded(c.start_s);
  j["end_s"] = rounded(c.end_s);
  j["frames"] = c.frames;
  j["drift_mm"] = rounded(c.drift_mm);
  j["drift_sigma_mm"] = rounded(c.drift_sigma_mm);
  j["slope_mm_s"] = rounded(c.slope_mm_s);
  j["slope_sigma_mm_s"] = rounded(c.slope_sigma_mm_s);
  j["offset_mm"] = rounded(c.offset_mm);
  j["offset_sigma_mm"] = rounded(c.offset_sigma_mm);
  j["excursion_mm"] = rounded(c.excursion_mm);
  j["excursion_U_mm"] = rounded(c.excursion_U_mm);
  j["peak_mm"] = rounded(c.peak_mm);
  j["peak_U_mm"] = rounded(c.peak_U_mm);
  j["rms_mm"] = rounded(c.rms_mm);
  j["rms_U_mm"] = rounded(c.rms_U_mm);
  j["top_speed_mm_s"] = rounded(c.top_speed_mm_s);
  j["top_speed_U_mm_s"] = rounded(c.top_speed_U_mm_s);
  return j;
}

template <typename J>
J quantityJson(const inspect::Quantity& q) {
  J j;
  j["value"] = rounded(q.value);
  j["U"] = rounded(q.U);
  return j;
}

template <typename J>
J jointJson(const inspect::JointResult& r) {
  J j = quantityJson<J>(r.mm);
  j["kind"] = inspect::jointName(r.kind);
  j["unit"] = r.unit;
  j["entity"] = r.entity;
  j["entity_out"] = r.entity_out;
  j["at_start"] = r.at_start;
  j["x_mm"] = rounded(r.p_S_mm.x());
  j["y_mm"] = rounded(r.p_S_mm.y());
  return j;
}

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

template <typename J>
J pulseJson(const PulseTiming& t) {
  J j;
  j["axis"] = t.axis;
  j["driver"] = t.profile.name;
  j["pulses"] = t.pulses;
  j["setup_violations"] = t.setup_violations;
  j["hold_violations"] = t.hold_violations;
  j["width_violations"] = t.width_violations;
  j["space_violations"] = t.space_violations;
  j["min_setup_us"] = rounded(1e6 * t.min_setup_s);
  j["min_hold_us"] = rounded(1e6 * t.min_hold_s);
  j["min_width_us"] = rounded(1e6 * t.min_width_s);
  j["min_space_us"] = rounded(1e6 * t.min_space_s);
  j["first_violation_s"] = rounded(t.first_violation_s);
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

Json kerfJson(const vision::EntityKerf& kerf) {
  Json calipers = Json::array();
  for (const vision::Caliper& c : kerf.calipers) {
    calipers.push_back({rounded(c.station_mm), c.found, rounded(c.offset_mm), rounded(c.width_mm),
                        rounded(c.brightness), c.near_joint});
  }
  return {{"unit", kerf.unit}, {"entity", kerf.entity}, {"calipers", std::move(calipers)}};
}

}  // namespace

std::string digestOf(const RunReport& report) {
  const inspect::InspectionResult& result = report.result;
  Json root;
  root["verdict"] = inspect::verdictName(result.verdict);
  // Problems may name files, so only their number counts.
  root["problems"] = result.problems.size();
  for (const inspect::Check* c : sortedBy(result.checks, [](const inspect::Check& x) { return x.name; })) {
    root["checks"].push_back(checkJson<Json>(*c));
  }
  for (const inspect::Unjudged* u :
       sortedBy(result.unjudged, [](const inspect::Unjudged& x) { return x.name; }))
    root["not_judged"].push_back({u->name, u->applies});
  for (const inspect::EntityResult* e : sortedBy(
           result.entities, [](const inspect::EntityResult& x) { return std::pair(x.unit, x.entity); })) {
    root["entities"].push_back(entityJson<Json>(*e));
  }
  for (const inspect::CutResult* c : sortedBy(result.cuts, [](const inspect::CutResult& x) {
         return std::tuple(x.start_s, x.unit, x.entity);
       })) {
    Json cut = cutJson<Json>(*c);
    cut["time_s"] = roundedAll(c->time_s);
    cut["residual_mm"] = roundedAll(c->residual_mm);
    root["cuts"].push_back(std::move(cut));
  }
  for (const vision::EntityKerf* k : sortedBy(
           report.kerf.entities, [](const vision::EntityKerf& x) { return std::pair(x.unit, x.entity); })) {
    root["kerf"].push_back(kerfJson(*k));
  }
  for (const vision::StrayCut* s : sortedBy(report.kerf.strays, [](const vision::StrayCut& x) {
         return std::tuple(x.unit, x.p_S_mm.x(), x.p_S_mm.y(), x.extent_mm);
       })) {
    root["strays"].push_back(
        {s->unit, rounded(s->p_S_mm.x()), rounded(s->p_S_mm.y()), rounded(s->extent_mm)});
  }
  for (const PulseTiming* t : sortedBy(report.pulses, [](const PulseTiming& x) { return x.axis; })) {
    Json pulse = pulseJson<Json>(*t);
    pulse["setup_histogram"] = t->setup_histogram;
    root["pulses"].push_back(std::move(pulse));
  }
  return base::sha256(root.dump());
}

std::string verdictJson(const RunReport& report) {
  const inspect::InspectionResult& result = report.result;
  OrderedJson root;
  root["schema_version"] = 1;
  root["verdict"] = inspect::verdictName(result.verdict);
  root["exit_code"] = inspect::exitCode(result.verdict);
  root["summary"] = verdictSentence(report);
  root["digest"] = digestOf(report);
  root["scenario"] = report.scenario;
  root["machine"] = report.machine;
  root["firmware"] = report.firmware;
  root["source"] = report.source_id;
  root["seed"] = report.seed;
  root["model"] = modelJson(report.model);
  root["virtual_s"] = rounded(report.virtual_s);
  root["problems"] = result.problems;
  root["checks"] = OrderedJson::array();
  for (const inspect::Check& c : result.checks) {
    auto j = checkJson<OrderedJson>(c);
    j["title"] = c.title;
    j["explanation"] = c.explanation;
    root["checks"].push_back(std::move(j));
  }
  root["not_judged"] = OrderedJson::array();
  for (const inspect::Unjudged& u : result.unjudged)
    root["not_judged"].push_back(unjudgedJson<OrderedJson>(u));
  root["reservations"] = OrderedJson::array();
  for (const Reservation& r : reservationsOf(report))
    root["reservations"].push_back({{"kind", r.kind}, {"text", r.text}});
  root["entities"] = OrderedJson::array();
  for (const inspect::EntityResult& e : result.entities) {
    auto j = entityJson<OrderedJson>(e);
    const auto index = static_cast<std::size_t>(e.entity);
    if (index < report.dieline->entities.size()) {
      j["process"] = dieline::processName(report.dieline->entities[index].process);
      j["layer"] = report.dieline->entities[index].layer;
      j["origin"] = report.dieline->entities[index].origin;
    }
    root["entities"].push_back(std::move(j));
  }
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
  const auto judged = std::count_if(result.cuts.begin(), result.cuts.end(),
                                    [](const inspect::CutResult& c) { return std::isfinite(c.drift_mm); });
  root["cuts"] = {{"count", result.cuts.size()}, {"judged", judged}, {"list", OrderedJson::array()}};
  for (const inspect::CutResult& c : result.cuts) root["cuts"]["list"].push_back(cutJson<OrderedJson>(c));
  root["pulses"] = OrderedJson::array();
  for (const PulseTiming& t : report.pulses) root["pulses"].push_back(pulseJson<OrderedJson>(t));
  root["frames"] = {{"count", report.spot.frames.size()}, {"lost", report.spot.frames_lost}};
  root["mark_residual_mm"] = rounded(report.kerf.mark_residual_mm);
  root["versions"] = OrderedJson::object();
  for (const auto& [name, version] : report.versions) root["versions"][name] = version;
  root["repeat_command"] = report.repeat_command;
  return root.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

}  // namespace kerfbench::report
