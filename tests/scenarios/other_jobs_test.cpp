// SPDX-License-Identifier: Apache-2.0
// Parameters of the judge that were chosen on a job of the house, on jobs that had no part in the choice.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::Contains;

/// Runs a scenario of these keys, beside what the other one gives.
ProgramRun runOf(const std::string& base, const std::string& keys, const ScratchFolder& scratch,
                 const std::string& options = "") {
  return fastRunOf(scenarioWith(base, "name: other\n" + keys, scratch), scratch, options);
}

void passes(const std::string& base, const std::string& keys, const std::string& check,
            const std::string& options = "") {
  const ScratchFolder scratch;
  const ProgramRun run = runOf(base, keys, scratch, options);
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(checksThat(verdictOf(scratch.path() / "other"), "PASS"), Contains(check)) << run.output;
  std::printf("%s", run.output.c_str());
}

void fails(const std::string& base, const std::string& keys, const std::string& check) {
  const ScratchFolder scratch;
  const ProgramRun run = runOf(base, keys, scratch);
  EXPECT_EQ(run.exit_code, 1) << run.output;
  EXPECT_THAT(checksThat(verdictOf(scratch.path() / "other"), "FAIL"), Contains(check)) << run.output;
}

/// The window of 3 mm and the limit of 1.47 % come from short-lines.dxf.
std::string wave() {
  return fmt::format("dieline: '{}'\n", fixture("dielines/short-lines-wave.dxf").string());
}

TEST(OtherJobsLong, AnotherContourOfShortLinesPassesByLineEnergy) {
  passes("native/short-lines.yaml", wave(), "line_energy", "--seed 11");
  passes("short-lines.yaml", wave(), "line_energy", "--seed 12");
}
TEST(OtherJobsLong, AnotherContourWithConstantPowerFailsByLineEnergy) {
  fails("native/short-lines.yaml", wave() + "planner: {faults: {constant_power: true}}\n", "line_energy");
}
TEST(OtherJobsLong, AnotherContourOfAnOpenLoopFailsByLineEnergy) {
  fails("native/short-lines.yaml", wave() + "planner: {power: {closed_loop: false}}\n", "line_energy");
}

/// The scenario's own order was chosen for the AVR release; tests of GoodReleaseLong run that.
TEST(OtherJobsLong, ThreeLayersPassInTheShortestOrderOnTheNativeRelease) {
  passes("native/carton-three-layers.yaml", "planner: {order: shortest}\n", "spot_seen");
}

/// One cut with a run-up: the gate opens and closes on a beam at full speed, at the edges of the strip.
TEST(OtherJobs, StripWithRunUpsPasses) { passes("native/strip-run-up.yaml", "print: {units: 1}\n", "path"); }

/// The scenario's own 2815 mm/s² make a piece last whole frames, so that each cut is seen alike.
TEST(OtherJobsLong, StripStopAndGoPassesAtOtherAccelerations) {
  for (const int mm_s2 : {2500, 2700})
    passes("native/strip-stop-and-go.yaml",
           fmt::format("print: {{units: 2}}\nplanner: {{acceleration_mm_s2: {}}}\n", mm_s2), "path");
}

}  // namespace
}  // namespace kerfbench::test
