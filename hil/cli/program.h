// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>

#include "hil/base/exit_codes.h"

namespace kerfbench::cli {

/// A command and what the help says of it.
struct CommandText {
  const char* name;
  const char* help;
};

inline constexpr const char* kInstrumentProgram = "kerfbench-instrument";

inline constexpr CommandText kCalibrate{"calibrate",
                                        "Calibrate a camera from pictures of a target, a scan head by marks"};
inline constexpr CommandText kGauge{
    "gauge",
    "Prove the measuring instrument: artefacts with known deviation are cut on the model's sheet, looked "
    "at by\n"
    "the machine's cameras and judged as in a run; what was measured is compared with what is true.\n"
    "docs/explanation/what-it-is-worth.md says how to read the result. Exit code 0: every claim holds or "
    "needs more cases; 1: "
    "one\n"
    "does not hold."};

inline constexpr const char* kWindowProgram = "kerfbench-window";

inline constexpr CommandText kServe{
    "serve",
    "The window: prepare a job, start it, watch the machine, look at results, in a browser on this computer. "
    "The\n"
    "address that it prints lets one browser in, once; docs/how-to/window.md."};
inline constexpr CommandText kView{
    "view",
    "The window with a trace opened: machine, pins, frames, plots and text at one "
    "moment"};

/// A command of kerfbench whose code is in another program.
struct HandedOver {
  CommandText text;
  const char* program;
};
/// In the order of the help.
inline constexpr std::array kHandedOver{HandedOver{kServe, kWindowProgram}, HandedOver{kView, kWindowProgram},
                                        HandedOver{kCalibrate, kInstrumentProgram},
                                        HandedOver{kGauge, kInstrumentProgram}};

/// The folder of the program that runs: its children are there, and the programs built with it.
std::filesystem::path binDir();

/// The folder for results unless the user names one: "results" in the current folder; where nothing can be
/// written there (a run in /usr/share), "kerfbench/results" in $XDG_STATE_HOME, which is ~/.local/state
/// unless set.
std::filesystem::path usualResults();

/// What main() of a program does: the work, whose exit code it returns. If the bench itself breaks (any
/// exception) that is told on standard error: base::kExitBroken. A name that is too long, or a loop of links,
/// is the user's: base::kExitInput.
int guardedMain(const std::function<int()>& work);

}  // namespace kerfbench::cli
