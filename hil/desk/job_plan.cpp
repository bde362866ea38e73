// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/job_plan.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/order/hand_order.h"
#include "firmware_under_test/planner/order/kerf.h"
#include "firmware_under_test/planner/program/check.h"
#include "firmware_under_test/planner/program/plan.h"
#include "firmware_under_test/planner/program/unit_motion.h"
#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/base/yaml_reader.h"
#include "hil/desk/desk_issue.h"
#include "hil/desk/gcode_departure.h"
#include "hil/desk/job_case.h"
#include "hil/desk/json_text.h"
#include "hil/desk/run_doubts.h"

namespace kerfbench::desk {
namespace {

using nlohmann::json;
using planner::UnitMotion;
using planner::UnitPeriod;

/// Rounds to the 1e-9 mm that a place is told to.
double told_mm(double value_mm) { return std::round(value_mm * 1e9) / 1e9 + 0.0; }

/// The line that a sentence of the planner names, "G-code line 12"; 0: none.
int gcodeLineIn(std::string_view sentence) {
  constexpr std::string_view kWords = "G-code line ";
  const std::size_t at = sentence.find(kWords);
  int line = 0;
  if (at == std::string_view::npos) return 0;
  const char* const begin = sentence.data() + at + kWords.size();
  return std::from_chars(begin, sentence.data() + sentence.size(), line).ec == std::errc() ? line : 0;
}

json issueOf(const std::string& sentence, bool is_error) {
  const int line = gcodeLineIn(sentence);
  return {{"line", line},
          {"message", sentence},
          {"severity", is_error ? "error" : "warning"},
          {"source", line > 0 || sentence.starts_with("G-code") ? "gcode" : "job"}};
}

/// Values of pictures as runs: [[value, how many] …].
class Runs {
 public:
  void add(int value) {
    if (list_.empty() || list_.back().first != value) list_.emplace_back(value, 0);
    ++list_.back().second;
  }
  [[nodiscard]] json finished() const { return list_; }

 private:
  std::vector<std::pair<int, int>> list_;
};

json previewOf(const UnitMotion& motion, const planner::MachineParameters& machine) {
  const std::size_t stride = motion.periods.size() / kMostPeriodsShown + 1;
  json x = json::array(), y = json::array(), power = json::array(), gate = json::array(),
       speed = json::array();
  Runs lines, entities;
  Eigen::Vector2d before_mm = motion.start.planned_S_mm;
  double way_mm = 0.0;
  const auto add = [&](const UnitPeriod& period, double speed_mm_s) {
    x.push_back(told_mm(period.p_S_mm.x()));
    y.push_back(told_mm(period.p_S_mm.y()));
    power.push_back(period.power.value_or(0));
    gate.push_back(period.power ? 1 : 0);
    speed.push_back(std::round(speed_mm_s * 1e3) / 1e3);
    lines.add(period.line);
    entities.add(period.entity);
  };
  add(motion.start, 0.0);
  for (std::size_t i = 0; i < motion.periods.size(); ++i) {
    const UnitPeriod& period = motion.periods[i];
    way_mm += (period.planned_S_mm - before_mm).norm();
    before_mm = period.planned_S_mm;
    if ((i + 1) % stride != 0 && i + 1 != motion.periods.size()) continue;
    add(period, way_mm / (static_cast<double>(stride) * motion.period_s));
    way_mm = 0.0;
  }
  return {{"period_s", motion.period_s * static_cast<double>(stride)},
          {"stride", stride},
          {"catch_up", static_cast<std::size_t>(motion.catch_up) / stride},
          {"x_mm", std::move(x)},
          {"y_mm", std::move(y)},
          {"power", std::move(power)},
          {"gate", std::move(gate)},
          {"speed_mm_s", std::move(speed)},
          {"line", lines.finished()},
          {"entity", entities.finished()},
          {"field",
           {{"min_mm", machine.field_min_mm},
            {"max_mm", machine.field_max_mm},
            {"ref_x_mm", motion.x_ref_mm},
            {"belt_mm_s", motion.belt_mm_s}}}};
}

/// Stretches of a G-code that belong to one entity, in their order, and the entities as they are cut.
struct EntityLines {
  json stretches = json::array();
  std::vector<int> order;
};

EntityLines entityLinesOf(const std::string& gcode) {
  EntityLines result;
  std::set<int> seen;
  int last = -1;
  for (const planner::Segment& segment : planner::readGcode(gcode)) {
    if (segment.entity >= 0 && segment.entity == last) {
      result.stretches.back()["line_last"] = segment.line;
    } else if (segment.entity >= 0) {
      result.stretches.push_back(
          {{"entity", segment.entity}, {"line_first", segment.line}, {"line_last", segment.line}});
    }
    last = segment.entity;
    if (segment.entity >= 0 && !segment.jump && segment.z > 0.0 && seen.insert(segment.entity).second)
      result.order.push_back(segment.entity);
  }
  return result;
}

/// One plan of one text.
class TextPlan {
 public:
  TextPlan(const ScenarioText& scenario, const std::optional<std::string>& gcode,
           const DeskRequest& request) {
    const JobCase found = jobCaseOf(scenario, gcode.has_value(), request);
    for (const DeskIssue& issue : found.issues) addIssue(issue, request);
    if (!found.test_case) return;
    const scenario::Case& test_case = *found.test_case;
    try {
      machine_ = scenario::targetedMachine(test_case);
      job_ = scenario::plannerJob(test_case);
      faults_ = test_case.scenario.planner_faults;
      gcode_ = gcode ? *gcode : gcodeOf(test_case);
      plan(test_case, gcode || !test_case.scenario.job_gcode.empty());
    } catch (const planner::PlanError& error) {
      addSentences(error.what());
    }
  }

  [[nodiscard]] std::string answer() && {
    bool fits = !facts_.is_null();
    for (const json& issue : issues_) fits = fits && issue["severity"] != "error";
    return jsonText({{"fits", fits},
                     {"issues", std::move(issues_)},
                     {"gcode", gcode_},
                     {"facts", std::move(facts_)},
                     {"preview", std::move(preview_)},
                     {"entity_lines", std::move(lines_.stretches)},
                     {"order", lines_.order}});
  }

 private:
  void addIssue(const DeskIssue& issue, const DeskRequest& request) {
    json value = jsonOf(std::vector<DeskIssue>{issue}, request).front();
    value["source"] = "job";
    issues_.push_back(std::move(value));
  }
  void addSentences(std::string_view text) {
    for (std::size_t from = 0; from < text.size();) {
      const std::size_t to = std::min(text.find('\n', from), text.size());
      if (to > from) issues_.push_back(issueOf(std::string(text.substr(from, to - from)), true));
      from = to + 1;
    }
  }

  std::string gcodeOf(const scenario::Case& test_case) const {
    const std::filesystem::path& edited = test_case.scenario.job_gcode;
    if (edited.empty()) return planner::makeGcode(*test_case.dieline, machine_, job_, faults_);
    const auto text = base::fileContent(edited);
    if (!text) throw planner::PlanError("cannot read " + edited.string());
    return *text;
  }

  /// What a G-code by hand cuts away from the drawing, or leaves of it. A run would tell it as well, by its
  /// cuts.
  void compare(const scenario::Case& test_case) {
    constexpr std::size_t kMostTold = 100;
    GcodeComparison found;
    try {
      planner::JobParameters drawn = job_;
      drawn.order = planner::JobParameters::Order::kDrawn;
      found = comparedWithPlan(planner::unitOf(planner::readGcode(gcode_)),
                               planner::readGcode(planner::makeGcode(*test_case.dieline, machine_, drawn)),
                               test_case.scenario.limits.path_mm);
    } catch (const planner::PlanError&) {
      return;  // Either of them is no path, which the check tells.
    }
    std::size_t told = 0;
    const auto tell = [&](json issue, const std::string& message) {
      if (++told > kMostTold) return;
      issue.update({{"message", message}, {"severity", "warning"}, {"source", "gcode"}});
      issues_.push_back(std::move(issue));
    };
    for (const GcodeDeparture& line : found.departures) {
      tell(
          {{"line", line.line}, {"where_mm", {told_mm(line.p_S_mm.x()), told_mm(line.p_S_mm.y())}}},
          fmt::format("G-code line {}: its cut leaves the drawing by {}, at x {:.2f}, y {:.2f} mm", line.line,
                      line.off_mm < kFarthestLooked_mm ? fmt::format("{:.2f} mm", line.off_mm)
                                                       : fmt::format("{:g} mm or more", kFarthestLooked_mm),
                      line.p_S_mm.x(), line.p_S_mm.y()));
    }
    for (const UncutPiece& piece : found.uncut) {
      tell({{"line", 0}, {"entities", {piece.entity}}},
           fmt::format("E{}: {:.1f} mm of it are cut by no line of the G-code", piece.entity,
                       piece.length_mm));
    }
    if (told <= kMostTold) return;
    issues_.push_back(
        issueOf(fmt::format("{} more places of the G-code are not as drawn", told - kMostTold), false));
  }

  void plan(const scenario::Case& test_case, bool is_by_hand) {
    const planner::CheckResult checked = planner::checkJob(gcode_, machine_, job_, faults_);
    for (const std::string& error : checked.errors) issues_.push_back(issueOf(error, true));
    for (const std::string& warning : checked.warnings) issues_.push_back(issueOf(warning, false));
    try {
      lines_ = entityLinesOf(gcode_);
    } catch (const planner::PlanError&) {
      return;  // The check has told what is wrong with the text.
    }
    if (is_by_hand) compare(test_case);
    for (const std::string& doubt : planner::orderDoubts(*test_case.dieline, lines_.order))
      issues_.push_back(issueOf(doubt, false));
    if (job_.kerf_radius_mm > 0.0)
      for (const std::string& note : planner::compensate(*test_case.dieline, job_).notes)
        issues_.push_back(issueOf(note, false));
    if (!checked.solution) return;
    const planner::Plan plan = planner::planFromChecked(checked, gcode_, machine_, job_, faults_);
    const planner::Axes axes(machine_, faults_);
    const UnitMotion motion = planner::unitMotion(plan.program, 0, *checked.solution, machine_, job_, axes);
    for (const std::string& doubt : runDoubts(test_case, machine_, job_, motion, axes))
      issues_.push_back(issueOf(doubt, false));
    preview_ = previewOf(motion, machine_);
    facts_ = {{"unit_time_s", plan.unit_time_s},
              {"cycle_time_s", plan.cycle_time_s},
              {"max_belt_speed_mm_s", plan.max_belt_speed_mm_s},
              {"cut_length_mm", rounded_mm(plan.cut_length_mm)},
              {"jump_length_mm", rounded_mm(plan.jump_length_mm)},
              {"units", job_.units},
              {"periods", motion.periods.size()},
              {"operations", plan.program.ops.size()},
              {"full_power_w", machine_.full_power_w},
              {"controller", planner::describe(machine_.target)}};
  }

  planner::MachineParameters machine_;
  planner::JobParameters job_;
  planner::PlannerFaults faults_;
  std::string gcode_;
  json issues_ = json::array();
  json facts_, preview_;
  EntityLines lines_;
};

}  // namespace

std::string planJson(const ScenarioText& scenario, const std::optional<std::string>& gcode,
                     const DeskRequest& request) {
  return TextPlan(scenario, gcode, request).answer();
}

}  // namespace kerfbench::desk
