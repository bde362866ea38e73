// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "hil/base/yaml_reader.h"
#include "hil/fold/fold_blank.h"
#include "hil/fold/fold_machine.h"
#include "hil/inspect/space/space_checks.h"
#include "twin/sheet/board_description.h"

namespace kerfbench::fold {

/// A scenario of a five-axis cut over a folded blank, read and checked. docs/reference/fold.md explains every
/// key.
struct FoldScenario {
  std::string name;
  std::filesystem::path path;
  std::uint64_t seed{};
  FoldMachine machine;  ///< With the scenario's errors.
  twin::BoardDescription board;
  FoldBlank blank;
  double print_sigma_mm{};
  std::vector<inspect::ContourPoint> contour;
  inspect::SpaceJob job;
  inspect::SpaceTolerances limits;
  std::string program;       ///< Text of the five-axis program.
  std::string program_name;  ///< For messages.
  std::vector<twin::FiveAxisMove> moves;
  std::vector<std::filesystem::path> inputs;  ///< All files that it depends on.
  std::vector<base::YamlReader::Asked> keys;  ///< Every key that was asked for, the given and the others.
};

/// @throws base::ConfigError or base::InputError with every fault of a file, each with file and line.
FoldScenario readFoldScenario(const std::filesystem::path& path);

}  // namespace kerfbench::fold
