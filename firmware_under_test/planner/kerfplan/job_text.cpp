// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/kerfplan/job_text.h"

#include <algorithm>
#include <set>
#include <sstream>

#include "firmware_under_test/planner/kerfplan/input_text.h"
#include "firmware_under_test/planner/order/kerf.h"
#include "firmware_under_test/planner/program/plan.h"
#include "firmware_under_test/planner/program/selection.h"
#include "hil/base/console.h"
#include "hil/base/terminal.h"

namespace kerfbench::planner {
namespace {

dieline::Dieline readInput(const KerfplanOptions& options) {
  base::Console console(false);
  dieline::DrawingOptions drawing = dieline::drawingOptionsFrom(options.drawing);
  drawing.progress = base::progressOn(console);
  dieline::Dieline dieline = dieline::readDieline(options.input, drawing);
  console.endProgress();
  for (const std::string& note : dieline.notes) base::toTerminal(stderr, "note: " + note + "\n");
  if (dieline.entities.empty()) throw PlanError(options.input + ": no entities");
  return dieline;
}

/// G-code of the file that was named, or of the scenario.
std::string gcodeTextOf(const KerfplanOptions& options) {
  return options.input.empty() ? options.planned->gcode.value_or("") : inputText(options.input);
}

}  // namespace

bool namesGcode(const std::string& input) {
  if (input == kStandardInput) return true;
  const std::string tail = input.substr(std::min(input.size(), input.find_last_of('.')));
  return std::set<std::string>{".nc", ".ngc", ".gcode", ".tap", ".txt"}.count(CLI::detail::to_lower(tail)) >
         0;
}

bool KerfplanOptions::hasGcode() const {
  return input.empty() ? planned && planned->gcode.has_value() : namesGcode(input);
}

std::string nameOf(const KerfplanOptions& options) {
  if (options.planned && !options.planned->title.empty()) return options.planned->title;
  return options.input.substr(options.input.find_last_of('/') + 1);
}

dieline::Dieline chosenOf(const KerfplanOptions& options) {
  dieline::Dieline dieline =
      options.planned && options.planned->dieline ? *options.planned->dieline : readInput(options);
  select(dieline, selectionFrom(options.entities, options.layers, options.processes));
  return dieline;
}

std::string gcodeOf(const KerfplanOptions& options) {
  const bool compensates = options.job.kerf_radius_mm > 0.0;
  if (options.hasGcode()) {
    if (!options.drawing.empty())
      throw PlanError(options.input + ": --unit, --scale, --turn, --shift and --layer are for drawings");
    if (compensates && options.scenario.empty())
      throw PlanError(options.input + ": G-code is the beam's path, --kerf-radius is for drawings");
    return select(gcodeTextOf(options), selectionFrom(options.entities, options.layers, options.processes));
  }
  const dieline::Dieline dieline = chosenOf(options);
  std::string gcode = makeGcode(dieline, options.machine, options.job, options.faults);
  if (compensates) {
    for (const std::string& note : compensate(dieline, options.job).notes)
      base::toTerminal(stderr, note + "\n");
  }
  return gcode;
}

std::string withFile(const KerfplanOptions& options, const std::string& sentences) {
  if (options.input.empty() || !options.hasGcode()) return sentences;
  const std::string name = options.input == kStandardInput ? "standard input" : options.input;
  std::string named;
  std::istringstream stream(sentences);
  for (std::string line; std::getline(stream, line);) {
    if (!named.empty()) named += '\n';
    named += line.starts_with("G-code") ? name + ": " + line : line;
  }
  return named;
}

}  // namespace kerfbench::planner
