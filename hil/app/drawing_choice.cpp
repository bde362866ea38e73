// SPDX-License-Identifier: Apache-2.0
#include "hil/app/drawing_choice.h"

#include <fmt/format.h>

namespace kerfbench::app {

DrawingRules drawingRules(const DrawingChoice& choice, const scenario::ImagePath& images) {
  DrawingRules rules;
  if (!choice.scenario.empty()) {
    if (!choice.arguments.empty())
      throw dieline::DielineError(
          "--scenario says how a drawing is read: leave out --unit, --scale, --turn, "
          "--shift and --layer");
    const scenario::Scenario of = scenario::readScenario(choice.scenario, images);
    rules = {of.drawing, of.accepted, of.witness_required};
  } else {
    rules.options = dieline::drawingOptionsFrom(choice.arguments);
  }
  for (const std::string& name : choice.accepted) {
    const auto kind = dieline::lintKindFromName(name);
    if (!kind)
      throw dieline::DielineError(
          fmt::format("--accept {} is none of duplicate, overlap, gap, zero-length", name));
    rules.accepted.insert(*kind);
  }
  return rules;
}

}  // namespace kerfbench::app
