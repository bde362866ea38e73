// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "hil/dieline/read.h"
#include "hil/scenario/scenario.h"

namespace kerfbench::app {

/// How drawings are read that no scenario names, as typed on a command line.
struct DrawingChoice {
  dieline::DrawingArguments arguments;
  std::filesystem::path scenario;     ///< Whose rules drawings are read by; empty: none.
  std::vector<std::string> accepted;  ///< Names of faults that are accepted where they touch no cut.
  bool witness{};                     ///< A second reader reads drawings as well, those of scenarios too.
  /// True if nothing was told of how a drawing is read.
  [[nodiscard]] bool empty() const { return scenario.empty() && arguments.empty() && accepted.empty(); }
};

/// How one drawing is read and what is accepted of it.
struct DrawingRules {
  dieline::DrawingOptions options;
  std::set<dieline::LintFinding::Kind> accepted;
  bool witness_required{};  ///< As the scenario has it.
};

/// The rules of the scenario, or those of the command line. @throws dieline::DielineError if both are given
/// or an option is out of its range, base::ConfigError if the scenario cannot be read.
DrawingRules drawingRules(const DrawingChoice& choice, const scenario::ImagePath& images);

}  // namespace kerfbench::app
