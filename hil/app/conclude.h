// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hil/app/case.h"
#include "hil/app/commands.h"
#include "hil/app/console.h"
#include "hil/app/controller_words.h"
#include "hil/app/lockstep.h"
#include "hil/app/machine_film.h"
#include "hil/app/stopwatch.h"
#include "hil/inspect/safe_state.h"

namespace kerfbench::hil {

/// From a run (live or replayed) to the verdict: looks, measures, judges, writes the results folder, tells
/// the user.
struct Conclusion {
  std::string folder_name;  ///< Below the results folder.
  std::string firmware;     ///< For people.
  std::string source_id;
  std::string firmware_sha256;
  std::string
      firmware_version;  ///< As the image says of itself; empty if it is not the reference controller's.
  const twin::DrawnMachine* drawn{};  ///< The machine that ran; not null.
  const MachineFilm* film{};          ///< For the report's pictures; not null.
  std::string gcode;                  ///< Written to the results folder unless empty.
  ControllerWords words;
  std::filesystem::path spot_frames;            ///< Recording of a real spot camera; empty: none.
  bool moves_frames{};                          ///< It goes into the results folder.
  std::optional<SafeStateEvidence> safe_state;  ///< Of a run that was to be stopped, but for twin's pins.
};
/// Returns the exit code of the verdict.
int conclude(const Case& the_case, twin::Twin& twin, const LockstepResult& run, const Conclusion& conclusion,
             const CommonOptions& options, Stopwatch& stopwatch, Console& console);

}  // namespace kerfbench::hil
