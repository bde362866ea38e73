// SPDX-License-Identifier: Apache-2.0
// The reference controller's release for an 8051 in its emulator, and four of the known mistakes in it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::Contains;

class Mcs51Release : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(std::filesystem::path(KERFBENCH_BINARY_DIR) /
                                 "firmware/controller-mcs51.hex"))
      GTEST_SKIP() << "the release was not built: sdcc is missing";
  }
  ProgramRun run(const std::string& scenario) const {
    return fastRunOf(fixture("scenarios/" + scenario + ".yaml"), scratch_);
  }
  ProgramRun runOneUnit(const std::string& scenario) const {
    return fastRunOf(scenarioWith(scenario + ".yaml", "print: {units: 1}\n", scratch_), scratch_);
  }
  void expectFailure(const ProgramRun& run, const std::string& name, const std::string& check) const {
    EXPECT_EQ(run.exit_code, 1) << run.output;
    EXPECT_THAT(checksThat(verdictOf(scratch_.path() / ("fault-" + name + "-mcs51")), "FAIL"),
                Contains(check))
        << run.output;
  }
  ScratchFolder scratch_;
};
using Mcs51ReleaseLong = Mcs51Release;

TEST_F(Mcs51Release, OneLabelPasses) {
  const ProgramRun one = runOneUnit("mcs51/label-on-belt");
  EXPECT_EQ(one.exit_code, 0) << one.output;
}
TEST_F(Mcs51Release, DirLateFailsByPulseTiming) {
  expectFailure(runOneUnit("faults/dir-late-mcs51"), "dir-late", "pulse_timing");
}
TEST_F(Mcs51ReleaseLong, LabelPasses) {
  const ProgramRun whole = run("mcs51/label-on-belt");
  EXPECT_EQ(whole.exit_code, 0) << whole.output;
}
// The belt that is counted 1 % wrong is faster than the job allows, and the controller stops by itself.
TEST_F(Mcs51ReleaseLong, EncoderScaleFailsByFinish) {
  expectFailure(run("faults/encoder-scale-mcs51"), "encoder-scale", "finish");
}
TEST_F(Mcs51ReleaseLong, DirLateFailsByPulseTiming) {
  expectFailure(run("faults/dir-late-mcs51"), "dir-late", "pulse_timing");
}
TEST_F(Mcs51ReleaseLong, GateLateFailsByGateLag) {
  expectFailure(run("faults/gate-late-mcs51"), "gate-late", "gate_lag");
}
TEST_F(Mcs51ReleaseLong, PulsesLostFailsByPath) {
  expectFailure(run("faults/pulses-lost-mcs51"), "pulses-lost", "path");
}

}  // namespace
}  // namespace kerfbench::test
