// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <nlohmann/json.hpp>

#include "hil/base/digest.h"
#include "hil/head_service/head_report.h"

namespace kerfbench::head_service {
namespace {

using Json = nlohmann::ordered_json;

/// 1 nm, 1 nrad.
Json number(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(value * 1e9) / 1e9 + 0.0;  // + 0.0 turns -0 into 0.
}

Json jsonOf(const SheetErrors& errors) {
  return {{"marks", errors.marks}, {"max_mm", number(errors.max_mm)}, {"rms_mm", number(errors.rms_mm)}};
}

Json jsonOf(const MeasuredSheet& sheet) {
  return {{"found", sheet.marks.size()},
          {"missing", sheet.missing},
          {"false", sheet.false_marks},
          {"remarks", sheet.remarks},
          {"digest", sheet.digest}};
}

Json jsonOf(const HeadIteration& iteration, double limit_mm) {
  const calibrate::VerifiedTable& verified_table = iteration.table;
  const calibrate::CoverBand band = calibrate::coverBand(verified_table.marks);
  const calibrate::CorrectionTableResult& table = iteration.head.table;
  const auto& surface = iteration.head.fit.surface();
  Json verified = Json::array();
  for (const MeasuredSheet& sheet : iteration.verified) verified.push_back(jsonOf(sheet));
  return {
      {"grid", iteration.grid},
      {"marks", jsonOf(iteration.marks)},
      {"before", jsonOf(iteration.before)},
      {"rejected", iteration.head.fit.rejected()},
      {"noise_ratio", number(iteration.head.fit.noiseRatio())},
      {"surface_degree", surface ? Json(surface->basis.degree()) : Json(nullptr)},
      {"table",
       {{"nodes", {table.grid.x_mm().size(), table.grid.y_mm().size()}},
        {"interpolation_error_mm", number(table.interpolation_error_mm)},
        {"largest_correction_mm", number(table.largest_correction_mm)},
        {"largest_sigma_mm", number(table.largest_sigma_mm)}}},
      {"verified", verified},
      {"after", jsonOf(iteration.after)},
      {"largest",
       {{"value_mm", number(verified_table.largest.value_mm)},
        {"U_mm", number(verified_table.largest.U_mm)},
        {"p_W_mm", {number(verified_table.largest.p_W_mm.x()), number(verified_table.largest.p_W_mm.y())}}}},
      {"verdict", inspect::verdictName(iteration.check(limit_mm).verdict)},
      {"within_stated_95", verified_table.covered},
      {"within_stated_95_by_chance", {band.least, band.most}},
      {"disagreeing", verified_table.disagreeing},
      {"over_tolerances", number(verified_table.tolerance_factor)},
      {"over_unmodelled", number(verified_table.surface_factor)},
      {"over_mark_noise", number(verified_table.mark_factor)},
      {"within_95_of_fit_alone", iteration.spread.covered},
      {"over_stated", number(iteration.spread.ratio)},
      {"over_stated_by_chance", number(iteration.spread.most_ratio)}};
}

Json jsonOf(const calibrate::HeadParameterFinding& finding) {
  const calibrate::HeadParameterText text = calibrate::textOf(finding.which);
  return {{"name", text.name},
          {"unit", text.unit},
          {"value", number(finding.value)},
          {"sigma", number(finding.sigma)},
          {"sigma_before", number(finding.prior_sigma)},
          {"held", finding.held},
          {"not_told_from",
           finding.mixed_with ? Json(calibrate::textOf(*finding.mixed_with).name) : Json(nullptr)}};
}

}  // namespace

std::string headJson(const HeadCalibration& result, const HeadPlan& plan, const HeadFacts& facts) {
  Json json{{"version", 1},
            {"kerfbench", facts.version},
            {"machine", facts.machine},
            {"camera", facts.camera},
            {"date", plan.date},
            {"seed", plan.seed},
            {"limit_mm", plan.limit_mm},
            {"unmodelled_share", facts.unmodelled_share},
            {"good", result.good()},
            {"verdict", result.verdictName()},
            {"end", result.endWords(plan)},
            {"best_iteration", result.best + 1}};
  for (const HeadIteration& iteration : result.iterations)
    json["iterations"].push_back(jsonOf(iteration, plan.limit_mm));
  for (const calibrate::HeadParameterFinding& finding :
       result.iterations.at(result.best).head.fit.parameters())
    json["parameters"].push_back(jsonOf(finding));
  json["digest"] = base::sha256(json.dump(-1, ' ', false, decltype(json)::error_handler_t::replace));
  json["command"] = facts.command;
  return json.dump(2, ' ', false, decltype(json)::error_handler_t::replace) + "\n";
}

}  // namespace kerfbench::head_service
