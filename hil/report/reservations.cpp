// SPDX-License-Identifier: Apache-2.0
// What a verdict must not be read without.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/report/limits.h"
#include "hil/report/run_report.h"

namespace kerfbench::report {
namespace {

using inspect::Tolerances;

struct Limit {
  const char* key;
  const char* unit;
  double (*value)(const Tolerances&);
  double scale{1.0};
};
constexpr std::array kLimits{
    Limit{"path_mm", "mm", [](const Tolerances& t) { return t.path_mm; }},
    Limit{"stillness_mm", "mm", [](const Tolerances& t) { return t.stillness_mm; }},
    Limit{"uncut_mm", "mm", [](const Tolerances& t) { return t.uncut_mm; }},
    Limit{"uncut_share", "", [](const Tolerances& t) { return t.uncut_share; }},
    Limit{"cut_through_mm", "mm", [](const Tolerances& t) { return t.cut_through_mm; }},
    Limit{"kerf_width_mm", "mm", [](const Tolerances& t) { return t.kerf_width_mm; }},
    Limit{"perforation.limit_mm", "mm", [](const Tolerances& t) { return t.perforation.limit_mm; }},
    Limit{"ordered_width.limit_mm", "mm", [](const Tolerances& t) { return t.ordered_width.limit_mm; }},
    Limit{"stray_mm", "mm", [](const Tolerances& t) { return t.stray_mm; }},
    Limit{"gate_lag_ms", "ms", [](const Tolerances& t) { return t.gate_lag_s; }, 1e3},
    Limit{"line_energy_share", "", [](const Tolerances& t) { return t.line_energy_share; }}};

std::string wideLimits(const Tolerances& limits) {
  std::string text;
  for (const NamedLimit& limit : namedLimits(limits)) {
    if (!(limit.value > limit.usual)) continue;
    text += fmt::format("{}{} {:g} (default {:g})", text.empty() ? "" : ", ", limit.key, limit.value,
                        limit.usual);
  }
  return text.empty() ? text : "limits wider than the defaults: " + text;
}

std::string unjudged(const inspect::InspectionResult& result) {
  std::string text;
  for (const inspect::Unjudged& check : result.unjudged)
    if (check.applies) text += (text.empty() ? "" : ", ") + check.name;
  return text.empty() ? text : "not judged: " + text;
}

std::string leftOut(const dieline::Dieline& dieline) {
  const auto ignored = std::ranges::count_if(
      dieline.entities, [](const dieline::Entity& e) { return e.process == dieline::Process::kIgnore; });
  if (ignored == 0) return {};
  return fmt::format("{} of {} entities of the drawing are neither cut nor judged", ignored,
                     dieline.entities.size());
}

std::string shortLegs(const inspect::InspectionResult& result) {
  const auto corners = std::ranges::count_if(result.joints, [](const inspect::JointResult& j) {
    return j.short_leg && j.kind == inspect::JointResult::Kind::kCorner;
  });
  return corners == 0 ? "" : fmt::format("{} corners have a leg too short to be read", corners);
}

}  // namespace

std::vector<NamedLimit> namedLimits(const Tolerances& limits) {
  const Tolerances defaults;
  std::vector<NamedLimit> all;
  for (const Limit& limit : kLimits)
    all.push_back(
        {limit.key, limit.unit, limit.scale * limit.value(limits), limit.scale * limit.value(defaults)});
  return all;
}

std::vector<Reservation> reservationsOf(const RunReport& report) {
  std::vector<Reservation> all;
  const auto add = [&](const char* kind, std::string text) {
    if (!text.empty()) all.push_back({kind, std::move(text)});
  };
  add("wide_limit", wideLimits(report.limits));
  add("not_judged", unjudged(report.result));
  add("part_not_judged", leftOut(*report.dieline));
  add("part_not_judged", shortLegs(report.result));
  for (const std::string& note : report.dieline->notes) add("part_not_judged", "drawing: " + note);
  add("model_pictures", report.model_pictures
                            ? "the pins are real, but the pictures are of the model: no real cut was seen"
                            : "");
  add("unsealed_recording", report.unsealed ? "the recording has no sum of its own, so nothing shows that it "
                                              "is whole"
                                            : "");
  add("calibration_age", report.calibration_max_age_days > inspect::kCalibrationMaxAge_days
                             ? fmt::format("calibrations may be {} days old (default {})",
                                           report.calibration_max_age_days, inspect::kCalibrationMaxAge_days)
                             : "");
  add("calibration_undated",
      report.calibrations_undated ? "the scenario has no date, so no calibration can be too old" : "");
  return all;
}

std::string reservationsLine(const RunReport& report) {
  std::string line;
  for (const Reservation& reservation : reservationsOf(report))
    line += (line.empty() ? "" : "; ") + reservation.text;
  return line;
}

}  // namespace kerfbench::report
