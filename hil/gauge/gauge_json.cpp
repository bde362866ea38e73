// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <nlohmann/json.hpp>

#include "hil/gauge/gauge_report.h"

namespace kerfbench::gauge {
namespace {

using Json = nlohmann::ordered_json;

/// Six digits behind the point: 1 nm for lengths. null where there is no number.
Json number(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(value * 1e6) / 1e6 + 0.0;  // + 0.0 turns -0 into 0.
}
Json numbers(const std::vector<double>& values) {
  Json array = Json::array();
  for (const double v : values) array.push_back(number(v));
  return array;
}

Json jsonOf(const std::map<inspect::Verdict, std::size_t>& verdicts) {
  Json object = Json::object();
  for (const inspect::Verdict v : {inspect::Verdict::kPass, inspect::Verdict::kNotProven,
                                   inspect::Verdict::kFail, inspect::Verdict::kInvalid}) {
    const auto at = verdicts.find(v);
    object[std::string(inspect::verdictName(v))] = at == verdicts.end() ? 0 : at->second;
  }
  return object;
}

Json jsonOf(const Coverage& c) {
  return {{"quantity", c.quantity},
          {"cases", c.cases},
          {"hits", c.hits},
          {"missing", c.missing},
          {"share_low", number(c.share.low)},
          {"share_high", number(c.share.high)},
          {"bias_mm", number(c.error_mm.mean)},
          {"sigma_mm", number(c.error_mm.sigma)},
          {"U_median_mm", number(c.U_median_mm)},
          {"U_95_mm", number(c.U_95_mm)},
          {"U_most_mm", number(c.U_most_mm)},
          {"z_mean", number(c.z_mean)},
          {"z_rms", number(c.z_sigma)},
          {"worst_cases", c.worst}};
}

Json jsonOf(const std::optional<TypeOne>& t, const std::vector<double>& errors) {
  if (!t) return nullptr;
  return {{"bias_mm", number(t->error.mean)},
          {"sigma_mm", number(t->error.sigma)},
          {"cg", number(t->cg)},
          {"cgk", number(t->cgk)},
          {"errors_mm", numbers(errors)}};
}

Json jsonOf(const std::optional<Grr>& g) {
  if (!g) return nullptr;
  return {{"parts", kGrrParts},
          {"placements", kGrrPlacements},
          {"repeats", kGrrRepeats},
          {"repeatability_mm", number(g->repeatability)},
          {"reproducibility_mm", number(g->reproducibility)},
          {"grr_mm", number(g->grr)},
          {"part_mm", number(g->part)},
          {"percent_of_tolerance", number(g->percent_of_tolerance)},
          {"percent_of_study", number(g->percent_of_study)},
          {"ndc", number(g->ndc)}};
}

Json jsonOf(const std::optional<Linearity>& l) {
  if (!l) return nullptr;
  return {{"offset_mm", number(l->offset)},
          {"slope", number(l->slope)},
          {"slope_sigma", number(l->slope_sigma)},
          {"scatter_mm", number(l->scatter)}};
}

Json jsonOf(const BudgetCheck& b) {
  return {{"cases", b.cases},
          {"median_ratio", number(b.median_ratio)},
          {"share_within_10_percent", number(b.within_10_percent)},
          {"p95_departure", number(b.p95_departure)},
          {"observed_over_stated", number(b.observed_ratio)}};
}

Json jsonOf(const std::vector<GaugePoint>& points, bool kinds) {
  Json array = Json::array();
  for (const GaugePoint& p : points) {
    Json point{{"case", p.name}};
    if (kinds) point["fault"] = faultName(p.kind);
    point["verdict"] = inspect::verdictName(p.verdict);
    point["true_mm"] = number(p.truth_mm);
    point["measured_mm"] = number(p.value_mm);
    point["U_mm"] = number(p.U_mm);
    array.push_back(std::move(point));
  }
  return array;
}

Json jsonOf(const GaugeSection& s) {
  Json section{{"imperfections", s.preset}};
  for (const Coverage& c : s.coverage) section["coverage"].push_back(jsonOf(c));
  for (const KindResult& k : s.kinds) {
    section["faults"].push_back({{"fault", faultName(k.kind)},
                                 {"bad", jsonOf(k.bad)},
                                 {"good", jsonOf(k.good)},
                                 {"detectable_mm", number(k.detectable_mm)},
                                 {"detectable_from_cases", k.detectable_from}});
  }
  section["wrong_verdicts"] = s.wrong;
  section["type1_as_it_lies"] = jsonOf(s.repeat, s.repeat_mm);
  section["type1_laid_anew"] = jsonOf(s.relay, s.relay_mm);
  section["type1_drift"] = jsonOf(s.drift_repeat, s.drift_repeat_mm);
  section["grr"] = jsonOf(s.grr);
  section["linearity"] = jsonOf(s.linearity);
  section["drift_linearity"] = jsonOf(s.drift_linearity);
  section["budget"] = jsonOf(s.budget);
  section["drift_budget"] = jsonOf(s.drift_budget);
  section["field"] = Json::array();
  for (const FieldCell& c : s.field) {
    section["field"].push_back({{"x_mm", number(c.p_V_mm.x())},
                                {"y_mm", number(c.p_V_mm.y())},
                                {"bias_x_mm", number(c.bias_mm.x())},
                                {"bias_y_mm", number(c.bias_mm.y())},
                                {"sigma_mm", number(c.sigma_mm)},
                                {"readings", c.readings}});
  }
  section["worst_deviation"] = jsonOf(s.worst, true);
  section["joint_faults"] = jsonOf(s.joints, true);
  section["largest_drift"] = jsonOf(s.drift, false);
  return section;
}

const char* stateName(Claim::State state) {
  return state == Claim::State::kHolds ? "holds" : state == Claim::State::kFails ? "fails" : "open";
}

}  // namespace

std::string gaugeJson(const GaugeResult& result, const GaugeOptions& options, const GaugeFacts& facts) {
  Json json{{"version", 1},
            {"kerfbench", facts.version},
            {"machine", facts.machine},
            {"kerf_camera", facts.kerf_camera},
            {"spot_camera", facts.spot_camera},
            {"command", facts.command},
            {"seed", options.seed},
            {"tolerance_mm", kTolerance_mm},
            {"kerf_cases", result.kerf_cases},
            {"still_cases", result.still_cases},
            {"holds", result.holds()}};
  json["claims"] = Json::array();
  for (const Claim& c : result.claims) {
    json["claims"].push_back({{"imperfections", c.preset},
                              {"claim", c.what},
                              {"measured", c.measured},
                              {"limit", c.limit},
                              {"state", stateName(c.state)}});
  }
  json["sections"] = Json::array();
  for (const GaugeSection& s : result.sections) json["sections"].push_back(jsonOf(s));
  return json.dump(1, ' ', false, decltype(json)::error_handler_t::replace) + "\n";
}

}  // namespace kerfbench::gauge
