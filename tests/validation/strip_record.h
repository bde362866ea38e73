// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "tests/validation/strip_controller.h"
#include "tests/validation/strip_line.h"

namespace kerfbench::validation {

/// Result of the n-th piece of a run, and the worst of all pieces up to it.
struct StripFigure {
  StripJob::Regime regime{};
  int pieces{};
  double cut_s{};
  double worst_mm{};  ///< Largest CutPiece::worst_mm.
  double unlit_mm{};  ///< Largest CutPiece::unlit_mm.
  long peak_kib{};    ///< Memory of the program until then.
};

/// Machine of fixtures/machines/strip-gantry.yaml with a feed drive for stop-and-go: 15 Hz, a gear of 10 to
/// the roller.
twin::MachineDescription stripMachine(const std::filesystem::path& source_dir);

/// Cuts up to the largest of `pieces` (ascending) and returns a figure for each; `each` gets it at once.
std::vector<StripFigure> cutPieces(const twin::MachineDescription& machine, const StripJob& job,
                                   twin::Fidelity fidelity, const std::vector<int>& pieces,
                                   const std::function<void(const StripFigure&)>& each = {});

/// Reads a file of figures, one a line, that `kerfbench-strip --pieces N --write FILE` makes.
/// @throws std::runtime_error for a file that cannot be read or is not of this kind.
std::vector<StripFigure> readFigures(const std::filesystem::path& path);
void writeFigures(const std::filesystem::path& path, const std::vector<StripFigure>& figures);

const char* nameOf(StripJob::Regime regime);

}  // namespace kerfbench::validation
