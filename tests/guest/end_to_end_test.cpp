// SPDX-License-Identifier: Apache-2.0
// Pins of real runs through the kernel's GPIO to a verdict. The releases run here and leave their pins; in
// the guest those are played on a simulated chip and recorded from it (record_test.cpp); twin and verdict run
// here again, on the recording, and once in the guest, where it takes minutes: both must have one digest.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include <fmt/format.h>

#include "hil/base/atomic_file.h"
#include "tests/guest/filmed_pins.h"
#include "tests/guest/host.h"
#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::guest {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

const fs::path kRuns = KERFBENCH_GUEST_RUNS;
const fs::path kFixtures = test::fixture("scenarios/pins");
const fs::path kShared = kRuns.parent_path() / "record";

class EndToEnd : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    skipWithoutQemu();
    fs::remove_all(kRuns);
    fs::create_directories(kRuns);
    run(kFixtures / "plate.yaml", 0);
    run(kFixtures / "plate-gate-late.yaml", 1);
    run(part("plate"), 0);
    writeFilm(kRuns / "film", filmOf(part("plate-camera"), kRuns / "plate-part" / "latest" / "pins.vcd"));
    ASSERT_TRUE(runGuest(KERFBENCH_GUEST_RECORD));
  }
  /// Runs a release whose pins the guest plays.
  static void run(const fs::path& scenario, int exit_code) {
    const test::ProgramRun done = test::kerfbench(fmt::format(
        "run '{}' --twin fast --no-pictures --results-dir '{}'", scenario.string(), kRuns.string()));
    ASSERT_EQ(done.exit_code, exit_code) << done.output;
  }
  /// Scenario with the triangle alone: the guest's processor cuts it on the twin and judges it in a minute.
  static fs::path part(const std::string& scenario) {
    fs::path file = kRuns / (scenario + ".yaml");
    base::writeFileAtomically(file, fmt::format("extends: {}\nname: {}-part\nselect: {{entities: 4-6}}\n",
                                                (kFixtures / (scenario + ".yaml")).string(), scenario));
    return file;
  }
  static test::ProgramRun replay(const std::string& recording, const std::string& results,
                                 const fs::path& scenario = kFixtures / "plate-on-pins.yaml") {
    return test::kerfbench(
        fmt::format("replay '{}' --scenario '{}' --twin fast --no-pictures --results-dir '{}'",
                    (kShared / recording).string(), scenario.string(), (kRuns / results).string()));
  }
};

TEST_F(EndToEnd, AGoodReleaseOnTheKernelsPinsPasses) {
  const test::ProgramRun done = replay("good.vcd", "good");
  EXPECT_EQ(done.exit_code, 0) << done.output;
  // The kernel's stamps are declared 10 us off, and the verdict takes account of it.
  EXPECT_THAT(done.output, AllOf(HasSubstr("PASS       pulse_timing"), HasSubstr("PASS       gate_lag")));
}

TEST_F(EndToEnd, AKnownBadReleaseOnTheKernelsPinsFailsForItsFault) {
  const test::ProgramRun done = replay("bad.vcd", "bad");
  EXPECT_EQ(done.exit_code, 1) << done.output;
  EXPECT_THAT(test::checksThat(test::verdictOf(kRuns / "bad" / "plate-on-pins-replay"), "FAIL"),
              Contains("gate_lag"));
}

TEST_F(EndToEnd, AReplayOfARunInTheGuestHasItsDigest) {
  const nlohmann::json live = test::verdictOf(kShared / "plate-camera-part");
  EXPECT_EQ(live.at("verdict"), "PASS");
  const test::ProgramRun done =
      replay("plate-camera-part/latest/pins.vcd", "live", kRuns / "plate-camera.yaml");
  EXPECT_EQ(done.exit_code, 0) << done.output;
  EXPECT_EQ(test::verdictOf(kRuns / "live" / "plate-camera-part-replay").at("digest"), live.at("digest"));
}

}  // namespace
}  // namespace kerfbench::guest
