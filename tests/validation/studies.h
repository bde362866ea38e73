// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>

#include "tests/validation/support/section.h"

namespace kerfbench::validation {

/// Amount of a study that is run: all that the page shows, or as much as a test has time for.
enum class Effort { kFull, kQuick };

/// Arguments of every study.
struct Context {
  Effort effort{Effort::kFull};
  std::filesystem::path source_dir;  ///< The repository, for fixtures/.
};

/// One chapter of VALIDATION.md. Its figures come from its own runs, now.
struct Study {
  const char* name;  ///< Name for --only, e.g. "galvo-step".
  Section (*run)(const Context& context);
  /// True if the study measures time: its part of the page differs from run to run and stands at its end.
  bool clock{false};
};

/// All studies in the page's order: the one table to add to.
std::span<const Study> studies();

Section galvoStep(const Context& context);
Section eightJoints(const Context& context);
Section pulseTrains(const Context& context);
Section pullOut(const Context& context);
Section energy(const Context& context);
Section scanFormula(const Context& context);
Section kerfDepth(const Context& context);
Section beltFriction(const Context& context);
Section fastMode(const Context& context);
Section jumpHook(const Context& context);
Section mirrorStepper(const Context& context);
Section stripCutting(const Context& context);
Section stripReturn(const Context& context);

}  // namespace kerfbench::validation
