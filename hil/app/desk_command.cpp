// SPDX-License-Identifier: Apache-2.0
#include "hil/app/desk_command.h"

#include <cstdio>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "firmware_under_test/planner/job/job.h"
#include "firmware_under_test/planner/preview/preview.h"
#include "firmware_under_test/planner/program/plan.h"
#include "firmware_under_test/planner/program/program.h"
#include "hil/base/atomic_file.h"
#include "hil/base/console.h"
#include "hil/base/exit_codes.h"
#include "hil/base/input_error.h"
#include "hil/base/terminal.h"
#include "hil/base/yaml_reader.h"
#include "hil/cli/for_option.h"
#include "hil/cli/standard_input.h"
#include "hil/desk/first_scenario.h"
#include "hil/desk/job_plan.h"
#include "hil/desk/scenario_check.h"
#include "hil/desk/scenario_edit.h"
#include "hil/dieline/read.h"
#include "hil/scenario/case.h"

namespace kerfbench::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string textOfFile(const fs::path& file) { return cli::textOfInput(file); }

/// A scenario's text with the path by which it is known: standard input lies in the current folder.
desk::ScenarioText scenarioText(const fs::path& file) {
  const fs::path name = cli::isStandardInput(file) ? cli::kStandardInputName : file;
  return {textOfFile(file), fs::absolute(name).lexically_normal()};
}

void printLine(std::FILE* out, const std::string& line) { base::toTerminal(out, line + "\n"); }

void printJson(const std::string& line) {
  base::toTerminalAsItIs(stdout, base::jsonForTerminal(line) + "\n");
}

/// Runs an action; faults of the user's files go to standard error.
template <typename Do>
int guarded(const Do& action) {
  const auto refuse = [](const std::exception& error) {
    printLine(stderr, error.what());
    return base::kExitInput;
  };
  try {
    return action();
  } catch (const base::ConfigError& error) {
    return refuse(error);
  } catch (const base::InputError& error) {
    return refuse(error);
  } catch (const dieline::DielineError& error) {
    return refuse(error);
  } catch (const planner::PlanError& error) {
    return refuse(error);
  }
}

desk::DeskRequest requestOn(base::Console& console, const fs::path& bin_dir) {
  return {.bin_dir = bin_dir, .progress = base::progressOn(console)};
}

void printIssues(const json& issues, const fs::path& scenario) {
  for (const json& issue : issues) {
    const std::string file = issue.value("file", "");
    const int line = issue.value("line", 0);
    const bool is_gcode = issue.value("source", "") == "gcode";
    std::string place = is_gcode ? "" : (file.empty() ? scenario.string() : file);
    if (!is_gcode && line > 0) place += fmt::format(":{}", line);
    const std::string key = issue.value("key", "");
    printLine(stderr, fmt::format("{}{}{}{}{}", place, place.empty() ? "" : ": ",
                                  issue["severity"] == "warning" ? "warning: " : "",
                                  key.empty() ? "" : key + ": ", issue["message"].get<std::string>()));
  }
}

/// What has to be known before a new scenario is run: what was left out of the drawing, its unit, and why the
/// job does not fit as it is.
void tellOfNew(const NewOptions& options, const std::string& text) {
  base::Console console(true);
  const desk::ScenarioText scenario{text, fs::absolute(options.out).lexically_normal()};
  const json check = json::parse(desk::checkJson(scenario, requestOn(console, options.bin_dir)));
  printIssues(check["issues"], options.out);
  const json findings = check["drawing"].is_object() ? check["drawing"]["findings"] : json::array();
  for (const json& finding : findings) {
    printLine(stderr,
              fmt::format("{}: {}: {}", options.drawing.string(), finding["severity"].get<std::string>(),
                          finding["message"].get<std::string>()));
  }
  if (!check["fits"]) return;
  const json plan = json::parse(desk::planJson(scenario, std::nullopt, requestOn(console, options.bin_dir)));
  printIssues(plan["issues"], options.out);
}

void writeFor(const char* option, const fs::path& file, const std::string& text) {
  cli::forOption(option, [&] { base::writeFileAtomically(file, text); });
}

/// Writes the page that plays the program, and the program itself, of a scenario that fits.
void writePlanned(const PlanOptions& options, const desk::ScenarioText& scenario, const std::string& gcode) {
  if (options.preview_out.empty() && options.program_out.empty()) return;
  const scenario::Case whole = scenario::caseOf(
      scenario::draftScenario(scenario.file, scenario.text, {options.bin_dir.parent_path() / "firmware"})
          .scenario);
  const planner::MachineParameters machine = scenario::targetedMachine(whole);
  const planner::JobParameters job = scenario::plannerJob(whole);
  const planner::PlannerFaults& faults = whole.scenario.planner_faults;
  const std::string& title = whole.scenario.title.empty() ? whole.scenario.name : whole.scenario.title;
  if (!options.preview_out.empty())
    writeFor("--preview", options.preview_out, planner::previewHtml(title, gcode, machine, job, faults));
  if (!options.program_out.empty())
    writeFor("--program", options.program_out,
             planner::programText(planner::planFromGcode(gcode, machine, job, faults).program));
}

/// A value as it stands behind "key: " in YAML.
nlohmann::ordered_json yamlValue(const std::string& words) {
  if (!base::isYamlValue(words)) throw base::InputError(fmt::format("'{}' is no value of YAML", words));
  return desk::valueIn(fmt::format("key: {}\n", words), "key");
}

desk::KeyEdit settingFrom(const std::string& words) {
  const std::size_t at = words.find('=');
  if (at == std::string::npos)
    throw base::InputError(fmt::format("'{}': expected KEY=VALUE, as belt.speed_mm_s=60", words));
  return {desk::keyPathFrom(words.substr(0, at)), yamlValue(words.substr(at + 1))};
}

/// The text with its keys changed; what is wrong with it is said with the file's name.
std::string editedFile(const fs::path& file, const std::string& text,
                       const std::vector<desk::KeyEdit>& edits) {
  try {
    return desk::edited(text, edits);
  } catch (const base::InputError& error) {
    throw base::InputError(fmt::format("{}: {}", file.string(), error.what()));
  }
}

}  // namespace

int planCommand(const PlanOptions& options) {
  return guarded([&] {
    base::Console console(options.as_json);
    if (cli::isStandardInput(options.scenario) && cli::isStandardInput(options.gcode))
      throw base::InputError("SCENARIO and --with cannot both be standard input");
    const desk::ScenarioText scenario = scenarioText(options.scenario);
    std::optional<std::string> gcode;
    if (!options.gcode.empty()) gcode = textOfFile(options.gcode);
    const std::string answer = desk::planJson(scenario, gcode, requestOn(console, options.bin_dir));
    console.endProgress();
    const json plan = json::parse(answer);
    const std::string name =
        cli::isStandardInput(options.scenario) ? cli::kStandardInputName : options.scenario;
    if (options.as_json) printJson(answer);
    if (!options.as_json) printIssues(plan["issues"], name);
    if (!options.gcode_out.empty()) writeFor("--gcode", options.gcode_out, plan["gcode"].get<std::string>());
    if (!plan["fits"]) return base::kExitInput;
    writePlanned(options, scenario, plan["gcode"]);
    if (options.as_json) return 0;
    const json& facts = plan["facts"];
    printLine(stdout,
              fmt::format("{}: fits: a unit takes {:.4f} s, {:.1f} mm of marks and {:.1f} mm of jumps; {} "
                          "periods, {} operations for {} unit{}\ncontroller: {}",
                          name, facts["unit_time_s"].get<double>(), facts["cut_length_mm"].get<double>(),
                          facts["jump_length_mm"].get<double>(), facts["periods"].get<std::size_t>(),
                          facts["operations"].get<std::size_t>(), facts["units"].get<int>(),
                          facts["units"] == 1 ? "" : "s", facts["controller"].get<std::string>()));
    return 0;
  });
}

int newCommand(const NewOptions& options) {
  return guarded([&] {
    std::error_code error;
    if (fs::exists(options.out, error)) throw base::InputError(options.out.string() + " is there already");
    base::Console console(false);
    const std::string text = desk::firstScenario(
        {fs::absolute(options.drawing), fs::absolute(options.machine), fs::absolute(options.out)},
        requestOn(console, options.bin_dir));
    console.endProgress();
    writeFor("--out", options.out, text);
    printLine(stdout, options.out.string());
    tellOfNew(options, text);
    return 0;
  });
}

int editCommand(const EditOptions& options) {
  return guarded([&] {
    std::vector<desk::KeyEdit> edits;
    for (const std::string& words : options.set) edits.push_back(settingFrom(words));
    for (const std::string& key : options.remove) edits.push_back({desk::keyPathFrom(key), nullptr});
    const std::string text = textOfFile(options.scenario);
    const std::string changed = editedFile(options.scenario, text, edits);
    if (changed != text) base::writeFileAtomically(options.scenario, changed);
    return 0;
  });
}

int checkCommand(const std::vector<fs::path>& scenarios, const fs::path& bin_dir) {
  return guarded([&] {
    int code = 0;
    base::Console console(true);
    for (const fs::path& file : scenarios) {
      const std::string answer = desk::checkJson(scenarioText(file), requestOn(console, bin_dir));
      printJson(answer);
      if (!json::parse(answer)["fits"]) code = base::kExitInput;
    }
    return code;
  });
}

}  // namespace kerfbench::app
