// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hil/base/exit_codes.h"
#include "hil/dieline/read.h"

namespace kerfbench::app {

/// A picture of a machine or of a drawing, see showCommand().
struct ShowOptions {
  std::filesystem::path subject;   ///< Machine or drawing; may be empty where the scenario names the machine.
  std::filesystem::path scenario;  ///< Empty: the machine at rest. For a drawing: whose rules it is read by.
  dieline::DrawingArguments drawing;  ///< How a drawing is read that no scenario names.
  std::vector<double> at_s;           ///< Virtual times; none: the middle of the longest cut.
  std::filesystem::path out;          ///< Empty: named after machine or scenario, in the current folder.
  int width_px{1280};
  int height_px{800};                  ///< A drawing's picture is as high as it needs to be.
  std::string view{"overall"};         ///< overall, head, sheet.
  std::filesystem::path film;          ///< A film of the run; empty: a picture.
  std::optional<double> from_s, to_s;  ///< What of the run the film shows; both empty: a cycle.
  double slow{1.0};                    ///< A second of the run takes so many of the film.
  double pictures_each_s{25.0};        ///< Pictures a second of the film.
  int threads{1};                      ///< For a film.
  bool quiet{};
  std::filesystem::path bin_dir;
};

/// Draws what a drawing has the laser do and what lint finds in it, as SVG or PNG by the name of the file; or
/// a machine at rest, or as a run of the scenario has it at given times (by the fast twin). Several times
/// make several files, with the time in the name; or a film of a trace or of a run of the scenario. Returns
/// 0, base::kExitUsage, base::kExitInput, or base::kExitBroken when POV-Ray or FFmpeg is missing or fails.
int showCommand(const ShowOptions& options);

}  // namespace kerfbench::app
