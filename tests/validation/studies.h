// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>

#include "tests/validation/support/section.h"

namespace kerfbench::validation {

/// How much of a study is run: all that the page shows, or what a test has time for.
enum class Effort { kFull, kQuick };

/// What every study is given.
struct Context {
  Effort effort{Effort::kFull};
  std::filesystem::path source_dir;  ///< The repository, for fixtures/.
};

/// One chapter of VALIDATION.md. Its figures come from its own runs, now.
struct Study {
  const char* name;  ///< For --only, e.g. "galvo-step".
  Section (*run)(const Context& context);
  bool clock{false};  ///< Measures time: its part of the page differs from run to run and stands at its end.
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
