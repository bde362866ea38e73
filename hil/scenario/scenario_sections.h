// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "hil/base/yaml_reader.h"
#include "hil/scenario/scenario.h"

// The sections of a scenario file, each read by itself; what is wrong goes to the reader.
namespace kerfbench::scenario {

/// File that `key` names, next to the scenario (the one that the key stands in) or in `second_base`. Empty
/// where there is none.
std::filesystem::path fileOf(base::YamlReader& reader, std::string_view key,
                             const std::filesystem::path& second_base = {});

/// Keys dieline and layers.
void readDrawing(base::YamlReader& file, Scenario& s);
planner::Selection readSelection(base::YamlReader select);
twin::BoardDescription readBoard(base::YamlReader& board);
PrintLayout readPrint(base::YamlReader& print);
void readBelt(base::YamlReader belt, Scenario& scenario);
FirmwareChoice readFirmware(base::YamlReader firmware, const ImagePath& images);
/// Takes from `scenario` what is read already: belt, firmware, print.
planner::JobParameters readJob(base::YamlReader planner, const Scenario& scenario);
planner::PlannerFaults readPlannerFaults(base::YamlReader faults);

}  // namespace kerfbench::scenario
