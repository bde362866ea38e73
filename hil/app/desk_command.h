// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kerfbench::app {

/// What the window's job page does, as commands. Each returns 0, or base::kExitInput where the user's files
/// are at fault.

struct PlanOptions {
  std::filesystem::path scenario;
  std::filesystem::path gcode;        ///< Planned instead of the scenario's own; empty: none.
  std::filesystem::path gcode_out;    ///< File for the G-code of one unit; empty: none is written.
  std::filesystem::path preview_out;  ///< File for the page that plays the program; empty: none.
  std::filesystem::path program_out;  ///< File for the controller's program; empty: none.
  bool as_json{};
  std::filesystem::path bin_dir;
};
/// Plans the job of a scenario as a run does.
int planCommand(const PlanOptions& options);

struct NewOptions {
  std::filesystem::path drawing, machine, out;
  std::filesystem::path bin_dir;
};
/// Writes a first scenario for a drawing; the file must not be there.
int newCommand(const NewOptions& options);

struct EditOptions {
  std::filesystem::path scenario;
  std::vector<std::string> set;     ///< "belt.speed_mm_s=60", the value as in YAML.
  std::vector<std::string> remove;  ///< "belt.lead_s".
};
/// Sets and removes keys of a scenario, and keeps all else of the file.
int editCommand(const EditOptions& options);

/// A line of JSON for each scenario: what is wrong with it, its drawing and its values.
int checkCommand(const std::vector<std::filesystem::path>& scenarios, const std::filesystem::path& bin_dir);

}  // namespace kerfbench::app
