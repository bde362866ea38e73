// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <map>
#include <string>
#include <vector>

namespace kerfbench::report {

/// One pin over the span of a moment.
struct PinTrace {
  std::string name;              ///< As signalName() has it.
  bool level{};                  ///< At the begin of the span.
  std::vector<double> toggle_s;  ///< When the level changed, by time.
};

/// What the beam followed over a part of a moment's span, by the frames of the spot camera.
struct FollowedSpan {
  double from_s{}, to_s{};
  int unit{-1};
  int entity{-1};  ///< -1: no line.
  int line{};      ///< Line of the program; 0: not known.
};

/// The pins around the time of a check that did not pass.
struct Moment {
  std::vector<std::string> checks;  ///< Names of the checks whose time this is.
  double time_s{};
  double from_s{}, to_s{};
  std::vector<PinTrace> pins;
  std::vector<FollowedSpan> followed;  ///< Sorted by time.
  std::string page{};  ///< File in the results folder that shows it in motion; empty: there is none.
};

/// What happened in a run that was to be stopped. Times in s on the clock of the pins; NaN: it did not.
struct SafeTimeline {
  std::string cause;  ///< For people: "the guard was opened".
  double cause_s{std::numeric_limits<double>::quiet_NaN()};
  double known_s{};  ///< When the cause can be known at the latest; not before cause_s.
  double laser_due_s{}, axes_due_s{}, word_due_s{};
  double gate_off_s{std::numeric_limits<double>::quiet_NaN()};
  double last_pulse_s{std::numeric_limits<double>::quiet_NaN()};
  double word_s{std::numeric_limits<double>::quiet_NaN()};
  std::string word;  ///< Name of the fault that the controller told.
};

/// Lines of the program by number, as far as a report names them.
using ProgramLines = std::map<int, std::string>;

}  // namespace kerfbench::report
