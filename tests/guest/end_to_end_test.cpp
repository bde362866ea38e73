// SPDX-License-Identifier: Apache-2.0
// Pins of real runs through the kernel's GPIO to a verdict. The releases run here and leave their pins; in
// the guest those are played on a simulated chip and recorded from it (record_test.cpp); twin and verdict run
// here again, on what was recorded: in the guest's emulated processor they would take minutes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include <fmt/format.h>

#include "tests/guest/host.h"
#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::guest {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

const fs::path kRuns = KERFBENCH_GUEST_RUNS;
const fs::path kShared = kRuns.parent_path() / "record";

class EndToEnd : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    skipWithoutQemu();
    fs::remove_all(kRuns);
    run("plate", 0);
    run("plate-gate-late", 1);
    ASSERT_TRUE(runGuest(KERFBENCH_GUEST_RECORD));
  }
  /// A release whose pins the guest plays.
  static void run(const std::string& scenario, int exit_code) {
    const test::ProgramRun done = test::kerfbench(
        fmt::format("run '{}' --twin fast --no-pictures --results-dir '{}'",
                    test::fixture("scenarios/pins/" + scenario + ".yaml").string(), kRuns.string()));
    ASSERT_EQ(done.exit_code, exit_code) << done.output;
  }
  static test::ProgramRun replay(const std::string& recording, const std::string& results) {
    return test::kerfbench(
        fmt::format("replay '{}' --scenario '{}' --twin fast --no-pictures --results-dir '{}'",
                    (kShared / recording).string(),
                    test::fixture("scenarios/pins/plate-on-pins.yaml").string(), (kRuns / results).string()));
  }
};

TEST_F(EndToEnd, AGoodReleaseOnTheKernelsPinsPasses) {
  const test::ProgramRun done = replay("good.vcd", "good");
  EXPECT_EQ(done.exit_code, 0) << done.output;
  // Stamps of the kernel are declared 10 us off, and the verdict knows it.
  EXPECT_THAT(done.output, AllOf(HasSubstr("PASS       pulse_timing"), HasSubstr("PASS       gate_lag")));
}

TEST_F(EndToEnd, AKnownBadReleaseOnTheKernelsPinsFailsForItsFault) {
  const test::ProgramRun done = replay("bad.vcd", "bad");
  EXPECT_EQ(done.exit_code, 1) << done.output;
  EXPECT_THAT(test::checksThat(test::verdictOf(kRuns / "bad" / "plate-on-pins-replay"), "FAIL"),
              Contains("gate_lag"));
}

}  // namespace
}  // namespace kerfbench::guest
