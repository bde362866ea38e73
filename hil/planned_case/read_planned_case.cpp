// SPDX-License-Identifier: Apache-2.0
#include "hil/planned_case/read_planned_case.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "firmware_under_test/planner/job/job.h"
#include "hil/base/console.h"
#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/base/terminal.h"
#include "hil/base/yaml_reader.h"
#include "hil/dieline/geometry.h"
#include "hil/machine_file/machine_file.h"
#include "hil/scenario/case.h"
#include "hil/scenario/unplanned.h"

namespace kerfbench::planned_case {
namespace {

namespace fs = std::filesystem;

fs::path absolute(const std::string& file) { return fs::absolute(file).lexically_normal(); }

planner::PlannedCase ofMachine(const std::string& file, planner::JobParameters job) {
  scenario::Case machine_alone;
  machine_alone.machine = machine_file::readMachine(absolute(file));
  job.jump_radius_mm = machine_alone.machine.controller.jump_radius_mm;
  return {.machine = scenario::plannerMachine(machine_alone), .job = std::move(job)};
}

/// The scenario with what the command line has in place of it.
scenario::Scenario scenarioOf(const planner::CaseFiles& files, const fs::path& bin_dir) {
  scenario::Scenario scenario = scenario::readScenario(
      absolute(files.scenario), {.firmware_dir = bin_dir.parent_path() / "firmware",
                                 .image = files.image.empty() ? fs::path() : absolute(files.image)});
  if (const auto why = scenario::whyNothingIsPlanned(scenario))
    throw planner::PlanError(fmt::format("{}: firmware.dialog: {}", files.scenario, *why));
  if (!files.machine.empty()) scenario.machine = absolute(files.machine);
  if (!files.drawing.empty()) {
    scenario.dieline = absolute(files.drawing);
    scenario.job_gcode.clear();
  }
  return scenario;
}

planner::PlannedCase ofScenario(const planner::CaseFiles& files, const fs::path& bin_dir) {
  base::Console console(false);
  const scenario::Case whole = scenario::caseOf(scenarioOf(files, bin_dir), base::progressOn(console));
  console.endProgress();
  for (const std::string& note : whole.dieline->notes) base::toTerminal(stderr, "note: " + note + "\n");
  const scenario::Scenario& read = whole.scenario;
  planner::PlannedCase result{.machine = scenario::targetedMachine(whole),
                              .job = scenario::plannerJob(whole),
                              .faults = read.planner_faults,
                              .title = read.title.empty() ? read.name : read.title};
  if (files.has_gcode) return result;
  if (read.job_gcode.empty()) {
    result.dieline = whole.dieline;
    return result;
  }
  result.gcode = base::fileContent(read.job_gcode);
  if (!result.gcode) throw planner::PlanError("cannot read " + read.job_gcode.string());
  return result;
}

}  // namespace

planner::PlannedCase readPlannedCase(const planner::CaseFiles& files, const planner::JobParameters& job,
                                     const fs::path& bin_dir) {
  try {
    return files.scenario.empty() ? ofMachine(files.machine, job) : ofScenario(files, bin_dir);
  } catch (const base::ConfigError& error) {
    throw planner::PlanError(error.what());
  } catch (const base::InputError& error) {
    throw planner::PlanError(error.what());
  }
}

}  // namespace kerfbench::planned_case
