// SPDX-License-Identifier: Apache-2.0
// What the bench is told of how well its own inspection is known: where that is much, nothing is proven.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

/// U of `path` of one label, with more keys in its scenario, and of its kerf camera.
double uncertaintyOfPath(const std::string& keys, const std::string& camera) {
  const ScratchFolder scratch;
  std::ofstream(scratch.path() / "machine.yaml") << fmt::format(
      "extends: '{}'\ncameras: {{kerf: {{{}}}}}\n", fixture("machines/two-mirror.yaml").string(), camera);
  const ProgramRun run = fastRunOf(
      scenarioWith("native/label-on-belt.yaml",
                   "name: label\nprint: {units: 1}\nmachine: machine.yaml\nselect: {layers: cut}\n" + keys,
                   scratch),
      scratch);
  const auto verdict = verdictOf(scratch.path() / "label");
  for (const auto& check : verdict.at("checks")) {
    if (check.at("name") == "path") return check.at("expanded_uncertainty").get<double>();
  }
  ADD_FAILURE() << run.output;
  return 0.0;
}

// The label's cuts lie within 30 mm of the middle of its marks.
TEST(InspectionSetup, WhatIsNotKnownOfItIsInTheUncertainty) {
  const double usual_mm = uncertaintyOfPath("", "");
  EXPECT_LT(usual_mm, 0.007) << usual_mm;
  const double by_board_mm = uncertaintyOfPath("board: {swelling_ppm: 1000}\n", "");
  EXPECT_GT(by_board_mm, 1.5 * usual_mm) << usual_mm;
  // The same share, of another thing.
  EXPECT_NEAR(uncertaintyOfPath("", "target_scale_ppm: 1000"), by_board_mm, 0.1 * by_board_mm);
}

}  // namespace
}  // namespace kerfbench::test
