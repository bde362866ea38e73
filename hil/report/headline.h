// SPDX-License-Identifier: Apache-2.0
#pragma once

// The answer of a report in a few words. Private to hil/report and its tests.

#include <string>
#include <vector>

#include "hil/report/run_report.h"

namespace kerfbench::report {

/// Texts without a full stop; empty where it is not known.
struct Headline {
  std::string check;     ///< Name of the check that tells the most; empty: none.
  std::string what;      ///< "The cut lies off the dieline"
  std::string how_much;  ///< "0.0750 mm, where 0.0500 mm are allowed"
  std::string where;     ///< "unit 1, E1 at x 60.00, y 20.00 mm"
  std::string when;      ///< "1.2345 s, when the beam passed that place, to 0.5 ms"
  /// The likely cause, a sentence with its full stop; empty also where it leaves most of the deviation
  /// unexplained.
  std::string cause;
};

/// Headline of the first group of failures, or of checks that decided the verdict; empty for a PASS.
Headline headlineOf(const RunReport& report);

std::string howMuchOf(const inspect::Check& check);
std::string whereOf(const inspect::Check& check);
std::string whenOf(const inspect::Whereabouts& where);

/// What to do after a verdict that is neither PASS nor FAIL, in sentences, the most useful first.
std::vector<std::string> nextSteps(const RunReport& report);

}  // namespace kerfbench::report
