// SPDX-License-Identifier: Apache-2.0
// Test in the guest: a release as a controller board on a simulated chip, and the bench live before it. The
// bench reads the board's pins, drives its encoder, print mark and interlock from the model, and talks to it
// on its terminal. live_to_verdict_test.cpp judges the results.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "hil/live/live_pins.h"
#include "hil/run/dialogs.h"
#include "hil/source/vcd.h"
#include "tests/guest/sim_chip.h"
#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::guest {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

const fs::path kBinaries = KERFBENCH_BINARY_DIR;

/// A release as a board, in a process of its own.
class BoardProcess {
 public:
  BoardProcess(const fs::path& image, const fs::path& chip_in_sysfs, const std::string& tty) {
    // The board has the bench's own priority: below the kernel's interrupt threads, or they would merge
    // edges.
    const std::string command = fmt::format(
        "'{}' --machine '{}' --image '{}' --chip '{}' --tty '{}' --priority 49 --step-us 150 --delay-us 400 "
        "--seconds 9 --line galvo_x_pul=0 galvo_x_dir=1 galvo_y_pul=2 galvo_y_dir=3 laser_gate=4 encoder_a=5 "
        "encoder_b=6 print_mark=7 interlock=8",
        (kBinaries / "bin/kerfbench-board").string(),
        test::fixture("machines/two-mirror-gated-camera.yaml").string(), image.string(),
        chip_in_sysfs.string(), tty);
    pipe_ = ::popen(command.c_str(), "r");
    EXPECT_EQ(line(), "ready\n");
  }
  ~BoardProcess() {
    if (pipe_ != nullptr) ::pclose(pipe_);
  }
  BoardProcess(const BoardProcess&) = delete;
  BoardProcess& operator=(const BoardProcess&) = delete;
  /// Report of the board's timing, when its time is over.
  std::string finish() {
    const std::string pace = line();
    EXPECT_EQ(::pclose(pipe_), 0);
    pipe_ = nullptr;
    return pace;
  }

 private:
  std::string line() {
    std::array<char, 300> text{};
    const bool came = pipe_ != nullptr && std::fgets(text.data(), text.size(), pipe_) != nullptr;
    return came ? text.data() : "";
  }
  std::FILE* pipe_{};
};

/// Number of edges in the busiest second.
int busiestSecond(const source::PinRecording& recording) {
  std::deque<const PinEvent*> second;
  int edges = 0;
  int most = 0;
  for (const PinEvent& event : recording.outputs) {
    second.push_back(&event);
    edges += std::popcount(event.changed);
    for (; recording.rate.seconds(event.tick - second.front()->tick) > 1.0; second.pop_front())
      edges -= std::popcount(second.front()->changed);
    most = std::max(most, edges);
  }
  return most;
}

/// Runs the bench; the recording goes to a file of this name for the host.
void runLiveBefore(const std::string& image, const std::string& name) {
  SimChip chip("kerfbench-live",
               {"X_PUL", "X_DIR", "Y_PUL", "Y_DIR", "GATE", "ENC_A", "ENC_B", "MARK", "DOOR"});
  const scenario::Case test_case =
      scenario::readCase(test::fixture("scenarios/pins/label-live.yaml"), kBinaries / "firmware");
  const twin::SampledMachine sampled = scenario::sampledMachine(test_case);
  const run::PreparedJob job = run::prepareJob(test_case);
  BoardProcess board(kBinaries / "firmware" / image, chip.sysfs(), test_case.scenario.firmware.gpio.uart);
  base::Console console(false);
  const live::LivePins live =
      live::runLive(test_case, sampled, live::realPins(kBinaries / "bin"), job, console);
  const std::string pace = board.finish();
  const int busiest = busiestSecond(live.captured.recording);
  fmt::print("{}: {} edges in the busiest second; the board: {}", name, busiest, pace);
  EXPECT_THAT(live.captured.recording.problems, IsEmpty());
  EXPECT_GE(busiest, 10'000);
  EXPECT_THAT(pace, HasSubstr(fmt::format("{} strokes", live.captured.edges)));
  source::writeVcd(fs::path("/run/shared") / name, live.captured.recording, test_case.machine.signals);
}

TEST(Live, AGoodReleaseIsHeardAndDrivenToItsEnd) { runLiveBefore("controller-native", "good.vcd"); }

TEST(Live, AKnownBadReleaseIsHeardAndDrivenToItsEnd) {
  runLiveBefore("fault-encoder-scale-native", "bad.vcd");
}

}  // namespace
}  // namespace kerfbench::guest
