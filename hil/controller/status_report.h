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
  Tick heard{};                           ///< When its last byte was there.
};

/// What the words of a line-ok firmware say of its place.
struct StatusWords {
  std::optional<StatusReport> last;  ///< The last whole report that has a machine's place.
  std::optional<Tick> first_ok;      ///< When it first answered a line.
};
/// Lines of more than 512 bytes are passed over.
StatusWords statusWords(const source::PinRecording& recording);

/// An axis of the head that a report is held against.
struct ReportedAxis {
  Signal pul{};
  double step_mm{};  ///< One step, by the machine's data sheet; > 0.
};

/// Holds a report against the pulses of x and y since the controller woke at its place 0: a place agrees with
/// the steps if it is that place, right to its last digit; else it is told in whole steps. Places are mm, or
/// with four digits behind the point inches, as Grbl 1.1 prints them. An axis that is not wired is left out.
inspect::ControllerAccount compareWithStatus(const StatusReport& report, const PulseCounter& pins,
                                             const std::array<ReportedAxis, 2>& axes);

}  // namespace kerfbench::controller
