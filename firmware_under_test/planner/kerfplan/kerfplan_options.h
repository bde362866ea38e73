// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "firmware_under_test/planner/job/job.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_loop.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_own_job.h"
#include "firmware_under_test/planner/kerfplan/kerfplan_power.h"
#include "firmware_under_test/planner/kerfplan/planned_case.h"
#include "hil/dieline/read.h"

namespace kerfbench::planner {

/// What the commands that plan a job are told.
struct KerfplanOptions {
  std::string input;                   ///< Drawing or G-code; empty: that of the scenario.
  std::string scenario;                ///< Scenario file; empty: none.
  std::string machine_file;            ///< Machine file; empty: none, or that of the scenario.
  std::optional<PlannedCase> planned;  ///< What these files say, once they are read.
  std::string output;
  std::string entities, layers, processes;  ///< Selections as typed; empty: all.
  dieline::DrawingArguments drawing;
  std::string correction;  ///< File of the table.
  std::string image;       ///< Release image of the controller; empty: the AVR release, or the scenario's.
  PowerOptions power;
  OwnJobOptions own_job;
  LoopCase loop;  ///< Tube and meter, for power-loop.
  MachineParameters machine{.head = MachineParameters::Head::kTwoMirror,
                            .throw_mm = 500.0,
                            .mirror_spacing_mm = 15.0,
                            .mirror_step_rad = 12.5e-6,
                            .gantry_step_mm = 0.0125,
                            .field_min_mm = {-80.0, -80.0},
                            .field_max_mm = {80.0, 80.0},
                            .tracking_delay_s = 0.19e-3,
                            .encoder_count_mm = 0.01,
                            .print_mark_sensor_x_mm = -150.0,
                            .feed_step_mm = 0.0,
                            .full_power_w = 200.0};
  JobParameters job{.cut_energy_j_per_mm = 0.3, .given_by = GivenBy::kCommandLine};
  PlannerFaults faults{};  ///< Defects of the planner that a scenario asks for.

  /// True if files were named whose values are the options' defaults, and were not read yet.
  [[nodiscard]] bool waitForFiles() const { return !planned && !(scenario.empty() && machine_file.empty()); }
  /// True where the text that is planned is G-code, and no drawing.
  [[nodiscard]] bool hasGcode() const;
};

/// Options of the machine and of the job that is planned on it, with --scenario and --machine.
void addMachineOptions(CLI::App& app, KerfplanOptions& options);
void addJobOptions(CLI::App& app, JobParameters& job);

}  // namespace kerfbench::planner
