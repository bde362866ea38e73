// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "hil/app/scenario.h"
#include "hil/base/yaml_reader.h"

// The sections of a scenario file, each read by itself; what is wrong goes to the reader.
namespace kerfbench::hil {

/// The file that `key` names, beside the scenario (the one that the key stands in) or in `second_base`. Empty
/// where there is none.
std::filesystem::path fileOf(YamlReader& reader, std::string_view key,
                             const std::filesystem::path& second_base = {});

LayerProfile readLayers(YamlReader& file);
planner::Selection readSelection(YamlReader select);
twin::BoardDescription readBoard(YamlReader board);
PrintLayout readPrint(YamlReader print);
void readBelt(YamlReader belt, Scenario& scenario);
FirmwareChoice readFirmware(YamlReader firmware, const ImagePath& images);
/// Takes from `scenario` what is read already: belt, firmware, print.
planner::JobParameters readJob(YamlReader planner, const Scenario& scenario);
planner::PlannerFaults readPlannerFaults(YamlReader faults);

}  // namespace kerfbench::hil
