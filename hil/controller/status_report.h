// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

#include "hil/controller/pulse_counter.h"
#include "hil/inspect/verdict/controller_account.h"
#include "hil/source/vcd.h"

namespace kerfbench::controller {

/// Place that firmware of Grbl's kind reports when it is asked by `?`: "<Idle|MPos:10.000,-4.000,0.000|…>".
struct StatusReport {
  std::string state;                      ///< "Idle", "Run", …
  std::array<double, 2> machine_place{};  ///< X and Y in the machine's coordinates, in the firmware's unit.
  double resolution{};                    ///< Value of the last digit.
};

/// The last whole report that has a machine's place among the words of a recording; nullopt if none has.
std::optional<StatusReport> lastStatus(const source::PinRecording& recording);

/// An axis of the head that a report is held against.
struct ReportedAxis {
  Signal pul{};
  double step_mm{};  ///< One step, by the machine's data sheet; > 0.
};

/// Holds a report against the pulses of x and y: a place in mm, or in inches, agrees with the steps counted
/// from power-on if it is that place rounded to its last digit; else it is told in whole steps. An axis that
/// is not wired is left out.
inspect::ControllerAccount compareWithStatus(const StatusReport& report, const PulseCounter& pins,
                                             const std::array<ReportedAxis, 2>& axes);

}  // namespace kerfbench::controller
