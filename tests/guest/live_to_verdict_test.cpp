// SPDX-License-Identifier: Apache-2.0
// A live run on the kernel's pins, and before a camera of the kernel's, to a verdict. In the guest a release
// is a board on a simulated chip and the bench runs live before it (live_test.cpp). The pictures of the
// recording by the twin's spot camera are rendered here and, in the guest again, come from a loopback device
// (filmed_test.cpp). The verdict is given here: in the guest's emulated processor twin and cameras take far
// longer than the run itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "tests/guest/film.h"
#include "tests/guest/filmed_pins.h"
#include "tests/guest/host.h"
#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::guest {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

const fs::path kShared = KERFBENCH_GUEST_SHARED;  // Folders "live" and "filmed" of the two guests.
const fs::path kFilms = KERFBENCH_GUEST_FILMS;

fs::path scenario(const char* name) { return test::fixture(std::string("scenarios/pins/") + name + ".yaml"); }

fs::path pinsOf(const std::string& release) { return kShared / "live" / (release + ".vcd"); }

class LiveToVerdict : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    skipWithoutQemu();
    ASSERT_TRUE(runGuest(KERFBENCH_GUEST_LIVE));
    fs::remove_all(kFilms);
    for (const char* release : {"good", "bad"})
      writeFilm(kFilms / release, filmOf(scenario("label-live-camera"), pinsOf(release)));
    ASSERT_TRUE(runGuest(KERFBENCH_GUEST_FILMED));
  }
  static void TearDownTestSuite() {
    // The films have half a gigabyte.
    fs::remove_all(kFilms);
    for (const char* release : {"good", "bad"}) fs::remove_all(kShared / "filmed" / release);
  }

  const test::ScratchFolder results;
};

test::ProgramRun replay(const std::string& release, const char* name, const std::string& more,
                        const fs::path& results) {
  return test::kerfbench(fmt::format("replay '{}' --scenario '{}' {} --no-pictures --results-dir '{}'",
                                     pinsOf(release).string(), scenario(name).string(), more,
                                     results.string()));
}

std::string framesOf(const std::string& release) {
  return fmt::format("--frames '{}'", (kShared / "filmed" / release).string());
}

TEST_F(LiveToVerdict, AGoodReleasePasses) {
  const test::ProgramRun done = replay("good", "label-live", "", results.path());
  EXPECT_EQ(done.exit_code, 0) << done.output;
}

TEST_F(LiveToVerdict, AKnownBadReleaseFailsForItsFault) {
  const test::ProgramRun done = replay("bad", "label-live", "", results.path());
  EXPECT_EQ(done.exit_code, 1) << done.output;
  EXPECT_THAT(test::checksThat(test::verdictOf(results.path() / "label-live-replay"), "FAIL"),
              AllOf(Contains("path"), Contains("account")));
}

TEST_F(LiveToVerdict, AGoodReleaseBeforeACameraOfTheKernelsPasses) {
  const test::ProgramRun done = replay("good", "label-live-camera", framesOf("good"), results.path());
  EXPECT_EQ(done.exit_code, 0) << done.output;
  EXPECT_THAT(done.output, HasSubstr("PASS       stillness_x"));
}

TEST_F(LiveToVerdict, AKnownBadReleaseBeforeACameraOfTheKernelsFails) {
  const test::ProgramRun done = replay("bad", "label-live-camera", framesOf("bad"), results.path());
  EXPECT_EQ(done.exit_code, 1) << done.output;
  EXPECT_THAT(test::checksThat(test::verdictOf(results.path() / "label-live-camera-replay"), "FAIL"),
              Contains("spot_path"));
}

}  // namespace
}  // namespace kerfbench::guest
