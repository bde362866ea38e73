// SPDX-License-Identifier: Apache-2.0
// Test in the guest: pictures by the twin's spot camera go into a loopback device as a camera's, and are
// recorded from it as a run records its real camera. live_to_verdict_test.cpp made the films.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <thread>

#include <fmt/format.h>

#include "hil/live/spot_recorder.h"
#include "tests/guest/film.h"
#include "tests/guest/loop_camera.h"
#include "tests/guest/player.h"
#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::guest {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kRate_hz = 260;  // Rate of the machine file.

void recordFilm(const std::string& name) {
  const scenario::Case test_case = scenario::readCase(test::fixture("scenarios/pins/label-live-camera.yaml"),
                                                      KERFBENCH_BINARY_DIR "/firmware");
  const Film film = readFilm(fs::path(KERFBENCH_GUEST_FILMS) / name);
  const fs::path folder = fs::path("/tmp") / name;
  {
    LoopWriter camera(test_case.scenario.cameras.spot.device, film.width_px, film.height_px, kRate_hz);
    live::SpotRecorder recorder(test_case, camera::kernelVideoCalls(), folder);
    std::thread([&] {
      setRealTime(0, 40);
      camera.play(film);
    }).join();
    // A reader is a frame behind; a longer absence would be reported.
    sleepUntil_ns(now_ns() + 50'000'000);
    EXPECT_EQ(recorder.finish(), "");
    fmt::print("{}: {} pictures, {} recorded\n", name, film.at_ns.size(), recorder.frames());
    // The first pictures come while the bench's own code is still read from the host's disk.
    EXPECT_GE(recorder.frames() + kRate_hz / 5, film.at_ns.size());
  }
  fs::copy(folder, fs::path("/run/shared") / name, fs::copy_options::recursive);
  fs::remove_all(folder);
}

TEST(Filmed, TheGoodReleasesCut) { recordFilm("good"); }

TEST(Filmed, TheKnownBadReleasesCut) { recordFilm("bad"); }

}  // namespace
}  // namespace kerfbench::guest
