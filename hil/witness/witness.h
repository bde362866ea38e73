// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"
#include "hil/witness/bounded_run.h"

namespace kerfbench::witness {

/// The program that reads a drawing a second time.
struct WitnessProgram {
  /// Debian's, whatever python3 comes first in PATH: its packages are those that messages name.
  std::filesystem::path python{"/usr/bin/python3"};
  std::filesystem::path script;  ///< second_reader.py
  RunLimits limits{};
};
/// The script that lies beside the programs of a build. `bin_dir`: folder of the programs.
WitnessProgram witnessBeside(const std::filesystem::path& bin_dir);

/// What a second reader says of our reading.
struct Testimony {
  enum class Kind {
    kAgrees,
    kParts,    ///< The readings part, or the second reader cannot read this drawing.
    kMissing,  ///< A package is not installed, or the script is not there.
    kBroken,   ///< The second reader broke, hung or printed what is no reading.
  };
  Kind kind{Kind::kBroken};
  std::vector<std::string> sentences;  ///< At least one, each without the path of the drawing.
};

/// True for formats that somebody else's library reads: DXF, SVG and PDF, but not CF2.
bool hasWitness(const std::filesystem::path& drawing);

/// Has the drawing read a second time and compares length and box of each layer and process to 1 um (see
/// Tolerance). `dieline` was read from its path by `options`, and may be part of a selection.
/// @throws std::system_error if the kernel gives no process.
Testimony testimonyOf(const dieline::Dieline& dieline, const dieline::DrawingOptions& options,
                      const WitnessProgram& program);

/// Exit code of a command that asked: 0, base::kExitInput where readings part, base::kExitBroken where there
/// was no second reading.
int exitCodeOf(Testimony::Kind kind);

}  // namespace kerfbench::witness
