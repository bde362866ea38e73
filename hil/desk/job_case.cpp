// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/job_case.h"

#include <algorithm>
#include <utility>

#include "firmware_under_test/planner/job/job.h"
#include "hil/base/input_error.h"
#include "hil/base/yaml_reader.h"
#include "hil/dieline/read.h"
#include "hil/scenario/unplanned.h"

namespace kerfbench::desk {
namespace {

constexpr std::string_view kGcodeKey = "planner.gcode";

JobCase caseFrom(const ScenarioText& scenario, bool has_gcode, const DeskRequest& request) {
  JobCase result;
  scenario::ScenarioDraft draft =
      scenario::draftScenario(scenario.file, scenario.text, {request.bin_dir.parent_path() / "firmware"});
  if (has_gcode) {
    std::erase_if(draft.faults, [](const auto& fault) { return fault.key == kGcodeKey; });
    draft.scenario.job_gcode = scenario.file;  // There is a text, whatever its file: no order is asked for.
  }
  result.issues = issuesOf(draft.faults, scenario);
  if (!result.issues.empty()) return result;
  if (const auto why = scenario::whyNothingIsPlanned(draft.scenario)) {
    const TextPlace place = placeOfKey(scenario.text, "firmware.dialog");
    result.issues.push_back(
        {.line = place.line, .column = place.column, .key = "firmware.dialog", .message = *why});
    return result;
  }
  result.test_case = scenario::caseOf(std::move(draft.scenario), request.progress);
  return result;
}

}  // namespace

JobCase jobCaseOf(const ScenarioText& scenario, bool has_gcode, const DeskRequest& request) {
  const auto refused = [&](const std::exception& error) {
    return JobCase{std::nullopt, issuesIn(error.what(), scenario)};
  };
  try {
    return caseFrom(scenario, has_gcode, request);
  } catch (const base::ConfigError& error) {
    return refused(error);
  } catch (const dieline::DielineError& error) {
    return refused(error);
  } catch (const base::InputError& error) {
    return refused(error);
  } catch (const planner::PlanError& error) {
    return refused(error);
  }
}

}  // namespace kerfbench::desk
