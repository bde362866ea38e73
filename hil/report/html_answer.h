// SPDX-License-Identifier: Apache-2.0
#pragma once

// The parts of the report that answer first. Private to hil/report. All return HTML, empty where there is
// nothing to show, unless they say otherwise.

#include <string>
#include <string_view>

#include "hil/report/run_report.h"

namespace kerfbench::report {

/// What is wrong in one sentence, a text: of a FAIL its headline, else the sentence of the verdict.
std::string headlineSentence(const RunReport& report);
/// How much, where, when, why.
std::string headlineList(const RunReport& report);
std::string nextStepsList(const RunReport& report);
std::string problemsList(const RunReport& report);

inline constexpr std::string_view kFailuresTitle = "What did not pass";
/// Checks that did not pass, each with what it brings along, its place, its picture and its pins.
std::string failuresSection(const RunReport& report);
/// All checks with their numbers; those that pass are folded, but not on paper.
std::string checksSection(const RunReport& report);

/// The pins around a moment; `index` of RunReport::moments.
std::string waveformFigure(const RunReport& report, std::size_t index);
/// Deviation and stillness over time, with speed, entity and line of the program.
std::string motionSection(const RunReport& report);
/// What happened when in a run that was to be stopped, against what was allowed.
std::string safeTimelineFigure(const RunReport& report);
/// A page to print and to sign.
std::string recordSection(const RunReport& report, const Digests& digests);

/// Lines of the program that were under way, as a list of them; `lines` by number.
std::string programList(const RunReport& report, const std::vector<int>& lines);

}  // namespace kerfbench::report
