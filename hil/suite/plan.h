// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hil/base/yaml_reader.h"

namespace kerfbench::suite {

/// What a run must come to for the suite to be good.
struct Expectation {
  std::string verdict{"PASS"};  ///< "PASS", "FAIL", "NOT PROVEN", "INVALID".
  /// Checks that must have that verdict, at least one where it is FAIL: a defect must be found by the check
  /// that is there for it.
  std::vector<std::string> by{};

  [[nodiscard]] bool isPass() const { return verdict == "PASS"; }
};
/// "PASS", "FAIL by gate_lag, laser_gate".
std::string describe(const Expectation& expectation);

/// Options of a run that take the place of what its scenario says.
struct RunChoices {
  std::optional<std::uint64_t> seed;
  std::optional<std::string> imperfections;  ///< Name of a preset.
  std::optional<std::string> twin;           ///< Name of a fidelity.
  std::optional<double> time_limit_s;
  /// Keys of the scenario's section `checks`, those of its sections with dots between, and values as written.
  std::map<std::string, std::string> limits;
};

/// One run of a suite, checked: its scenario can be read, and its release fits the controller.
struct PlannedRun {
  /// Unique in the plan; letters, digits, '-', '_' and '.'. Also that of its folder, where '.' is '_'.
  std::string name;
  std::string place;                ///< "plan.yaml:12", of its entry.
  std::string title;                ///< The scenario's; free text.
  std::filesystem::path scenario;   ///< Absolute.
  std::string scenario_as_written;  ///< Relative to the folder of the plan.
  std::vector<std::string> tags;    ///< Free text; sorted, each once.
  RunChoices choices;
  Expectation expect;
  bool takes_release{};         ///< `image` is that of the release under test, where one was given.
  std::filesystem::path image;  ///< Takes the place of the scenario's; absolute; empty: the scenario's own.
  std::string unfit;            ///< Why `image` cannot be that of its controller; empty: it can.
  bool on_real_pins{};          ///< Hardware that no other run may use at the same time.
  /// Text of a scenario that extends `scenario` by the limits; empty where there are none.
  std::string limited_scenario;
  /// Every file on which the run depends -> its SHA-256: scenario, machine, drawing, image, emulator ….
  std::map<std::filesystem::path, std::string> files;

  [[nodiscard]] std::string folderName() const;
};

/// A release test, checked as a whole.
struct Plan {
  std::filesystem::path path;  ///< Absolute.
  std::string text;            ///< The file as it is.
  std::string name;            ///< Names the folder of its results.
  std::string title;
  std::size_t stop_after{};  ///< No run is started after so many that were not as expected; 0: all are run.
  std::vector<base::YamlReader::Asked> keys;  ///< Asked for: docs/reference/suite.md is held against them.
  std::vector<PlannedRun> runs;  ///< In the order of the file; files of a pattern by name, then by seed.
};

/// What a plan is read with.
struct PlanSurroundings {
  std::filesystem::path bin_dir;  ///< Where kerfbench and its children are; images are in ../firmware.
  std::filesystem::path image;    ///< The release under test; empty: those that scenarios and plan name.
};

/// Reads a plan and all scenarios that it names with what these name, and has the images that take the place
/// of others loaded by their emulators (see refuseUnfit()).
/// @throws base::ConfigError with everything that is wrong, each with file and line.
Plan readPlan(const std::filesystem::path& path, const PlanSurroundings& surroundings);

/// The name of a plan, of which nothing else is checked.
/// @throws base::ConfigError with file and line.
std::string nameOfPlan(const std::filesystem::path& path);

/// Part of a plan that is run. What is empty leaves nothing out.
struct Selection {
  std::vector<std::string> tags;      ///< A run must have one of these tags.
  std::vector<std::string> patterns;  ///< The name of a run must match one of these patterns (glob(7)).
  /// The name of a run must be one of these; nullopt: any will do.
  std::optional<std::vector<std::string>> names{};
};

/// Leaves in the plan what is selected. Returns how many runs were left out.
/// @throws base::InputError where nothing is left, or where a tag, a pattern or a name is that of no run.
std::size_t select(Plan& plan, const Selection& selection);

/// @throws base::ConfigError with all runs whose image does not fit their controller, and with how to leave
/// them out.
void refuseUnfit(const Plan& plan);

}  // namespace kerfbench::suite
