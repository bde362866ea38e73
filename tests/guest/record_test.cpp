// SPDX-License-Identifier: Apache-2.0
// Test in the guest: the program lists the chip and reports what is wrong, and the pins of recorded releases,
// played on its lines, are recorded as a live run would. end_to_end_test.cpp made the recordings, and judges
// the results.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <thread>

#include <fmt/format.h>

#include "hil/base/atomic_file.h"
#include "hil/judge/results_folder.h"
#include "hil/live/pin_capture.h"
#include "hil/scenario/case.h"
#include "hil/source/gpio/chips.h"
#include "hil/source/vcd.h"
#include "tests/guest/film.h"
#include "tests/guest/held_line.h"
#include "tests/guest/loop_camera.h"
#include "tests/guest/player.h"
#include "tests/guest/sim_chip.h"
#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::guest {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

const fs::path kScenario = test::fixture("scenarios/pins/plate-on-pins.yaml");

/// Strokes of a controller on the lines of `wires`.
std::vector<Stroke> strokesOf(const source::PinRecording& recording,
                              const std::vector<source::GpioWire>& wires, const SignalMap& map) {
  std::vector<Stroke> strokes;
  for (const PinEvent& event : recording.outputs) {
    for (const source::GpioWire& wire : wires) {
      const PinId pin = *map.pin(wire.signal);
      if (pin.port != event.port || (event.changed >> pin.bit & 1U) == 0) continue;
      const double at_s = recording.rate.seconds(event.tick);
      strokes.push_back(
          {static_cast<std::uint64_t>(1e9 * at_s), wire.offset, (event.level >> pin.bit & 1U) != 0});
    }
  }
  return strokes;
}

class RecordTest : public testing::Test {
 protected:
  [[nodiscard]] std::vector<Stroke> strokesOfRun(const std::string& run) const {
    return strokesOf(source::readVcd(fs::path(KERFBENCH_GUEST_RUNS) / run / "latest" / "pins.vcd", map),
                     scenario::captureOptions(test_case.scenario.firmware.gpio, source::listChips()).wires,
                     map);
  }
  /// Plays the pins of a run on the host and records them from the chip, to a file of this name for the host.
  void record(const std::string& run, const std::string& name) {
    const std::vector<Stroke> strokes = strokesOfRun(run);
    ASSERT_FALSE(strokes.empty());
    Player player(chip, strokes);
    base::Console console(false);
    const source::PinCapture captured =
        live::captureCase(test_case, source::linuxGpioSystem(), source::listChips(), console);
    const Played played = player.join();
    fmt::print("{}: {} edges in {:.3f} s, at worst {:.0f} µs late\n", name, strokes.size(),
               1e-9 * static_cast<double>(played.end_ns - played.begin_ns),
               1e-3 * static_cast<double>(played.worst_late_ns));
    EXPECT_THAT(captured.recording.problems, IsEmpty());
    EXPECT_EQ(captured.edges, strokes.size());
    const fs::path file = fs::path("/run/shared") / name;
    source::writeVcd(file, captured.recording, map);
    // The pins equal those of the live run's model to the tick: a replay cannot have another digest.
    const source::PinRecording read = source::readVcd(file, map);
    EXPECT_EQ(read.rate, captured.recording.rate);
    EXPECT_EQ(read.stamp_err_ticks, captured.recording.stamp_err_ticks);
    EXPECT_EQ(read.end, captured.recording.end);
    EXPECT_EQ(read.outputs, captured.recording.outputs);
  }
  const scenario::Case test_case = scenario::readCase(kScenario, fs::path(KERFBENCH_BINARY_DIR) / "firmware");
  const SignalMap& map = test_case.machine.signals;
  SimChip chip{"kerfbench-pins", {"X_PUL", "X_DIR", "Y_PUL", "Y_DIR", "GATE", ""}};
};

TEST_F(RecordTest, DoctorListsTheChipAsItIs) {
  const test::ProgramRun run = test::kerfbench("doctor --json");
  EXPECT_EQ(run.exit_code, 0) << run.output;
  const auto told = nlohmann::json::parse(run.output);
  const auto& chips = told.at("gpio").at("chips");
  const auto found =
      std::ranges::find_if(chips, [&](const auto& one) { return one.at("label") == chip.label(); });
  ASSERT_NE(found, chips.end()) << run.output;
  EXPECT_EQ(found->at("path"), chip.device().string());
  std::vector<std::string> names;
  for (const auto& line : found->at("lines")) names.push_back(line.at("name"));
  EXPECT_EQ(names, chip.lineNames());
  for (const auto& finding : told.at("findings")) {
    const std::string text = finding.at("text");
    // The loopbacks have no writer here, and so no format.
    if (text.starts_with("/dev/video")) {
      EXPECT_THAT(text, HasSubstr("gives pictures in no format that can be read"));
    } else {
      EXPECT_NE(finding.at("grade"), "trouble") << text;
    }
  }
}

TEST_F(RecordTest, ALineThatSomebodyElseHasIsToldByDoctorAndByRun) {
  const HeldLine held(chip.device(), 4, "status LED");
  const test::ProgramRun doctor = test::kerfbench(fmt::format("doctor '{}'", kScenario.string()));
  EXPECT_EQ(doctor.exit_code, 1);
  EXPECT_THAT(doctor.output, HasSubstr("line 4 for laser_gate is taken by 'status LED'"));
  EXPECT_THAT(doctor.output, HasSubstr("line 0 for galvo_x_pul is free"));
  const test::ProgramRun run =
      test::kerfbench(fmt::format("run '{}' --results-dir /tmp/results", kScenario.string()));
  EXPECT_EQ(run.exit_code, 65) << run.output;
  EXPECT_THAT(run.output, HasSubstr("line 4 for laser_gate is taken by 'status LED'"));
  EXPECT_FALSE(fs::exists("/tmp/results/plate-on-pins"));
}

TEST_F(RecordTest, ThePinsOfAGoodReleaseAreRecorded) { record("pins-plate", "good.vcd"); }

TEST_F(RecordTest, ThePinsOfAKnownBadReleaseAreRecorded) { record("pins-plate-gate-late", "bad.vcd"); }

// On many network drives /run/shared cannot exchange two names.
TEST_F(RecordTest, ResultsReplaceOlderOnesOnADriveThatCannotExchangeNames) {
  for (const std::string round : {"first", "second"}) {
    judge::ResultsFolder folder("/run/shared/results", "label");
    base::writeFileAtomically(folder.staging() / round, round);
    folder.commit();
  }
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator("/run/shared/results"))
    files.push_back(fs::relative(entry.path(), "/run/shared/results").string());
  EXPECT_THAT(files, testing::UnorderedElementsAre("label", "label/second", "label/kerfbench-results.txt"));
}

/// A camera in a thread of its own: the film's first picture until it begins, its last when it is over.
class Projector {
 public:
  Projector(LoopWriter& camera, const Film& film)
      : camera_(camera), film_(film), thread_([this](const std::stop_token& stop) { project(stop); }) {}
  void begin(std::uint64_t at_ns) { begin_ns_ = at_ns; }

 private:
  void project(const std::stop_token& stop) {
    setRealTime(0, 40);
    const std::uint64_t period_ns = film_.at_ns[1] - film_.at_ns[0];
    std::size_t next = 0;
    for (std::uint64_t at_ns = now_ns(); !stop.stop_requested(); at_ns += period_ns) {
      if (begin_ns_ != 0 && next + 1 < film_.at_ns.size()) at_ns = begin_ns_ + film_.at_ns[++next];
      sleepUntil_ns(at_ns);
      camera_.write(film_.picture(next));
    }
  }

  LoopWriter& camera_;
  const Film& film_;
  std::atomic<std::uint64_t> begin_ns_{};
  std::jthread thread_;
};

// Readers of pins and frames, twin and verdict run in one process before the kernel, as in a user's run; the
// host replays it.
TEST_F(RecordTest, ARunBeforePinsAndACameraGoesToItsVerdictHere) {
  const fs::path scenario = fs::path(KERFBENCH_GUEST_RUNS) / "plate-camera.yaml";
  const Film film = readFilm(fs::path(KERFBENCH_GUEST_RUNS) / "film");
  LoopWriter camera("/dev/video20", film.width_px, film.height_px, 260);
  Projector projector(camera, film);
  PlayerOptions options;
  options.real_time_priority = 45;  // A pulse waits for no picture.
  options.before = [&] { projector.begin(now_ns()); };
  Player player(chip, strokesOfRun("plate-part"), options);
  const test::ProgramRun run = test::kerfbench(
      fmt::format("run '{}' --twin fast --no-pictures --results-dir /run/shared", scenario.string()));
  player.join();
  EXPECT_EQ(run.exit_code, 0) << run.output;
}

}  // namespace
}  // namespace kerfbench::guest
