// SPDX-License-Identifier: Apache-2.0
// The reference controller's release for an 8051 in its emulator, and five of the known mistakes in it.
#include "tests/scenarios/other_processor.h"

namespace kerfbench::test {
namespace {

class Mcs51Release : public OtherProcessor {
 protected:
  Mcs51Release() : OtherProcessor("mcs51", "kerfbench-mcs51") {}
};
using Mcs51ReleaseLong = Mcs51Release;

TEST_F(Mcs51Release, OneLabelPasses) {
  const ProgramRun one = runOneUnit("mcs51/label-on-belt");
  EXPECT_EQ(one.exit_code, 0) << one.output;
}
TEST_F(Mcs51Release, OneLabelFromItsOwnMemoryPasses) {
  const ProgramRun one = runOneUnit("mcs51/own-job-on-belt");
  EXPECT_EQ(one.exit_code, 0) << one.output;
  EXPECT_THAT(one.output, testing::HasSubstr("started by its button at 0.1 s"));
  EXPECT_THAT(one.output, testing::HasSubstr("PASS       belt"));
}
// At this instant the main loop is busy, and an interrupt that only hands the guard on is too late.
TEST_F(Mcs51Release, AnOpenGuardDarkensTheLaserInTime) {
  const ProgramRun one = runOneUnit("safe/interlock-mcs51");
  EXPECT_EQ(one.exit_code, 0) << one.output;
  EXPECT_THAT(one.output, testing::HasSubstr("PASS       safe_state"));
}
TEST_F(Mcs51Release, DirLateFailsByPulseTiming) {
  expectFailure(runOneUnit("faults/dir-late-mcs51"), "dir-late", "pulse_timing");
}
TEST_F(Mcs51ReleaseLong, LabelPasses) {
  const ProgramRun whole = run("mcs51/label-on-belt");
  EXPECT_EQ(whole.exit_code, 0) << whole.output;
}
TEST_F(Mcs51ReleaseLong, LabelsFromItsOwnMemoryPass) {
  const ProgramRun whole = run("mcs51/own-job-on-belt");
  EXPECT_EQ(whole.exit_code, 0) << whole.output;
}
TEST_F(Mcs51ReleaseLong, EncoderScaleFailsByPath) {
  expectFailure(run("faults/encoder-scale-mcs51"), "encoder-scale", "path");
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
TEST_F(Mcs51ReleaseLong, InterlockIgnoredFailsBySafeState) {
  expectFailure(run("faults/interlock-ignored-mcs51"), "interlock-ignored", "safe_state");
}

}  // namespace
}  // namespace kerfbench::test
