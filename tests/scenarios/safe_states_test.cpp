// SPDX-License-Identifier: Apache-2.0
// Provoked faults that end in a safe state, and releases that ignore them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::Contains;

ProgramRun runHere(const std::string& scenario, const ScratchFolder& scratch) {
  return kerfbench(fmt::format("run '{}' --no-pictures --twin fast --results-dir '{}'",
                               fixture("scenarios/" + scenario).string(), scratch.path().string()));
}

std::string subjectOf(const nlohmann::json& verdict, const std::string& check) {
  for (const auto& one : verdict.at("checks")) {
    if (one.at("name") == check) return one.at("subject");
  }
  return "no such check";
}

/// Runs fixtures/scenarios/safe/FILE.yaml, and expects the fault that the controller reports.
void reaches(const std::string& file, const std::string& report) {
  const ScratchFolder scratch;
  const auto run = runHere(fmt::format("safe/{}.yaml", file), scratch);
  EXPECT_EQ(run.exit_code, 0) << run.output;
  std::string name = file;
  if (const auto slash = name.find('/'); slash != std::string::npos)
    name = name.substr(slash + 1) + "-" + name.substr(0, slash);
  const auto verdict = verdictOf(scratch.path() / ("safe-" + name));
  const auto good = checksThat(verdict, "PASS");
  EXPECT_THAT(good, testing::IsSupersetOf({"safe_state", "safe_stop", "safe_report", "pulse_timing"}));
  EXPECT_EQ(subjectOf(verdict, "safe_report"), report);
}

void failsBySafeState(const std::string& name) {
  const ScratchFolder scratch;
  const auto run = runHere("faults/" + name + ".yaml", scratch);
  EXPECT_EQ(run.exit_code, 1) << run.output;
  EXPECT_THAT(checksThat(verdictOf(scratch.path() / ("fault-" + name)), "FAIL"), Contains("safe_state"));
}

TEST(SafeState, IsReachedAfterInterlock) { reaches("interlock", "interlock"); }
TEST(SafeState, IsReachedAfterLimit) { reaches("limit", "limit"); }
TEST(SafeState, IsReachedAfterEncoderLost) { reaches("encoder-lost", "encoder"); }
TEST(SafeStateLong, IsReachedAfterEncoderWireB) { reaches("encoder-wire-b", "encoder"); }
TEST(SafeState, IsReachedAfterHostSilent) { reaches("host-silent", "silent"); }
TEST(SafeState, IsReachedAfterLineNoise) { reaches("line-noise", "uart"); }
TEST(SafeState, IsReachedAfterQueueDry) { reaches("queue-dry", "dry"); }
TEST(SafeState, IsReachedAfterBeltTooFast) { reaches("belt-too-fast", "belt-fast"); }
TEST(SafeState, IsReachedAfterField) { reaches("field", "field"); }
TEST(SafeState, IsReachedAfterPrintMarks) { reaches("print-marks", "marks"); }
TEST(SafeState, IsReachedAfterLogWaits) { reaches("log-waits", "late"); }
TEST(SafeState, IsReachedAfterMainStuck) { reaches("main-stuck", "watchdog"); }
TEST(SafeStateLong, IsReachedAfterNativeInterlock) { reaches("native/interlock", "interlock"); }
TEST(SafeStateLong, IsReachedAfterNativeEncoderLost) { reaches("native/encoder-lost", "encoder"); }
TEST(SafeStateLong, IsReachedAfterNativeMainStuck) { reaches("native/main-stuck", "watchdog"); }

TEST(CarelessRelease, ThatIgnoresTheInterlockFails) { failsBySafeState("interlock-ignored"); }
TEST(CarelessRelease, ThatTrustsTheEncoderFails) { failsBySafeState("encoder-trusted"); }

}  // namespace
}  // namespace kerfbench::test
