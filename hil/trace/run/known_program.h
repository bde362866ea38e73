// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace kerfbench::trace {

/// How the program of a run is known.
enum class ProgramOrigin {
  kSent,      ///< The bench has sent it to the controller.
  kRecorded,  ///< Found beside the recording of the pins, where the run that was recorded has put it.
  kPlanned,   ///< Planned anew from the scenario: what the controller was sent, nobody has kept.
};

/// The program that a run is shown with, for people; nothing judges by it.
struct KnownProgram {
  std::string gcode{};  ///< The program of one unit; empty: not known.
  ProgramOrigin from{ProgramOrigin::kSent};
  std::optional<double> period_s{};  ///< Period of the controller's program.
};

}  // namespace kerfbench::trace
