// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/scenario_check.h"

#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "firmware_under_test/planner/head/correction.h"
#include "firmware_under_test/planner/job/job.h"
#include "firmware_under_test/planner/program/selection.h"
#include "hil/base/input_error.h"
#include "hil/base/yaml_reader.h"
#include "hil/desk/desk_issue.h"
#include "hil/desk/drawing_json.h"
#include "hil/desk/json_text.h"
#include "hil/desk/scenario_values.h"
#include "hil/desk/yaml_layout.h"
#include "hil/dieline/remarks.h"
#include "hil/machine_file/machine_check.h"
#include "hil/machine_file/machine_file.h"
#include "hil/run/controller_fit.h"
#include "hil/scenario/camera_files.h"
#include "hil/scenario/case.h"
#include "hil/scenario/scenario.h"

namespace kerfbench::desk {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Findings of each kind that an answer has.
constexpr std::size_t kMostFindings = 500;

/// One check of one text; what is found is kept, and what follows from a fault is left out.
class TextCheck {
 public:
  TextCheck(const ScenarioText& scenario, const DeskRequest& request)
      : scenario_(scenario), request_(request) {
    if (!isReadable()) return;
    readValues();
    tryTo([&] { readText(); });
    if (!draft_) return;
    readMachine();
    if (issues_.empty()) tryTo([&] { checkTogether(); });
    tryTo([&] { readDrawing(); });
  }

  [[nodiscard]] std::string answer() && {
    bool fits = draft_.has_value() && !drawing_.is_null() && !machine_.is_null() && !has_bad_finding_;
    for (const DeskIssue& issue : issues_) fits = fits && !issue.is_error;
    json all{{"name", draft_ ? draft_->scenario.name : std::string()},
             {"title", draft_ ? draft_->scenario.title : std::string()},
             {"fits", fits},
             {"issues", jsonOf(issues_, request_)},
             {"values", json(values_.all)},
             {"own", values_.own}};
    all["drawing"] = std::move(drawing_);
    all["machine"] = std::move(machine_);
    all["sheet"] = draft_ ? sheetJson() : json();
    return jsonText(all);
  }

 private:
  /// What an action throws about files of the user's becomes issues.
  template <typename Do>
  bool tryTo(const Do& action) {
    const auto note = [&](const std::exception& error) {
      for (DeskIssue& issue : issuesIn(error.what(), scenario_)) issues_.push_back(std::move(issue));
      return false;
    };
    try {
      action();
      return true;
    } catch (const base::ConfigError& error) {
      return note(error);
    } catch (const dieline::DielineError& error) {
      return note(error);
    } catch (const base::InputError& error) {
      return note(error);
    } catch (const planner::PlanError& error) {
      return note(error);
    }
  }

  [[nodiscard]] std::string nameOf(const fs::path& file) const {
    return request_.name_of ? request_.name_of(file) : file.string();
  }

  /// Whether the text is YAML at all; if not, where it is not.
  bool isReadable() {
    try {
      (void)layoutOf(scenario_.text);
    } catch (const YamlFault& fault) {
      issues_.push_back({.line = fault.line, .column = fault.column, .message = fault.message});
      return false;
    } catch (const base::InputError&) {
      // Not to be edited key by key, but a text that can be read.
    }
    return true;
  }

  void readValues() {
    try {
      values_ = valuesOf(scenario_);
    } catch (const base::InputError& error) {
      // Such a text is a scenario all the same, and of a file that it extends the reader tells.
      issues_.push_back({.is_error = false, .message = error.what()});
    }
  }

  void readText() {
    draft_ = scenario::draftScenario(scenario_.file, scenario_.text,
                                     {request_.bin_dir.parent_path() / "firmware"});
    for (DeskIssue& issue : issuesOf(draft_->faults, scenario_)) issues_.push_back(std::move(issue));
  }

  void readMachine() {
    if (draft_->scenario.machine.empty()) return;
    if (!tryTo([&] { file_ = machine_file::readMachineFile(draft_->scenario.machine); })) return;
    const twin::MachineDescription& machine = file_->machine;
    const auto& told = machine.controller;
    const bool is_gantry = machine.kind == twin::MachineDescription::Kind::kGantry;
    machine_ = {{"file", nameOf(draft_->scenario.machine)},
                {"name", machine.name},
                {"kind", is_gantry                    ? "gantry"
                         : told.focal_length_mm > 0.0 ? "f-theta"
                                                      : "two-mirror"},
                {"field", {{"min_mm", told.field_min_mm}, {"max_mm", told.field_max_mm}}},
                {"full_power_w", told.full_power_w},
                {"tracking_delay_s", told.tracking_delay_s},
                {"feeds", told.feed_step_mm > 0.0}};
  }

  /// Marks and place of the sheet, for a picture of it.
  [[nodiscard]] json sheetJson() const {
    const scenario::Scenario& of = draft_->scenario;
    json marks = json::array();
    for (const RegistrationMark& mark : of.print.marks)
      marks.push_back(
          {{"x_mm", mark.p_SM_mm.x()}, {"y_mm", mark.p_SM_mm.y()}, {"diameter_mm", mark.diameter_mm}});
    const bool is_at_rest = !of.sheetMoves() && !of.belt_by_controller && of.web_start_x_mm.has_value();
    return {{"marks", std::move(marks)},
            {"pitch_mm", of.print.pitch_mm},
            {"units", of.print.units},
            {"moves", of.sheetMoves()},
            {"start_x_mm", is_at_rest ? json(*of.web_start_x_mm) : json()}};
  }

  /// What scenario and machine ask of each other.
  void checkTogether() {
    scenario::Case both;
    both.scenario = draft_->scenario;
    both.machine = file_->machine;
    both.spread = file_->spread;
    scenario::refuseUnwired(both);
    run::refuseUnfitController(both, request_.bin_dir);
    machine_file::refuseUnfit(*file_, scenario::webOf(both));
    both.spot_camera = file_->spot_camera;
    both.kerf_camera = file_->kerf_camera;
    // A run says so as well, but after it has cut, and as INVALID.
    for (const std::string& problem : scenario::readCalibrations(both).problems)
      issues_.push_back({.is_error = false, .key = "machine", .message = problem});
  }

  void readDrawing() {
    const scenario::Scenario& of = draft_->scenario;
    if (of.dieline.empty()) return;
    dieline::DrawingOptions options = of.drawing;
    options.progress = request_.progress;
    dieline::Dieline drawing = dieline::readDieline(of.dieline, options);
    const dieline::Dieline whole = scenario::needsWholeDrawing(of) ? drawing : dieline::Dieline{};
    const bool is_selected = tryTo([&] { planner::select(drawing, of.selection); });
    if (!is_selected) issues_.back().key = "select";
    const dieline::LintReport lint =
        dieline::lintDieline(whole.entities.empty() ? drawing : whole, kMostFindings, request_.progress);
    for (const dieline::LintFinding& finding : lint.findings)
      has_bad_finding_ = has_bad_finding_ || (finding.is_error && !dieline::isAccepted(finding, of.accepted));
    for (const dieline::Remark& remark : dieline::remarksOf(drawing)) {
      if (!remark.is_warning) continue;
      issues_.push_back(
          {.file = of.dieline, .line = remark.line, .is_error = false, .message = remark.message});
    }
    drawing_ = drawingJson(drawing, lint, of.accepted);
    drawing_["file"] = nameOf(of.dieline);
  }

  const ScenarioText& scenario_;
  const DeskRequest& request_;
  std::vector<DeskIssue> issues_;
  ScenarioValues values_;
  std::optional<scenario::ScenarioDraft> draft_;
  std::optional<machine_file::MachineFile> file_;
  json drawing_, machine_;
  bool has_bad_finding_{};
};

}  // namespace

std::string checkJson(const ScenarioText& scenario, const DeskRequest& request) {
  return TextCheck(scenario, request).answer();
}

}  // namespace kerfbench::desk
