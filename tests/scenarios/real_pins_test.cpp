// SPDX-License-Identifier: Apache-2.0
// Edges of a gpiochip to a verdict: the native release's pins through a scripted kernel.
#include "hil/live/real_pins.h"
#include "hil/app/run_command.h"
#include "hil/base/exit_codes.h"
#include "hil/judge/results_list.h"
#include "hil/live/capture_on_pins.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <limits>
#include <memory>
#include <stdexcept>

#include "hil/camera/tile_folder.h"
#include "hil/live/run_on_pins.h"
#include "hil/run/cut_on_twin.h"
#include "hil/run/release.h"
#include "hil/source/analyser/sr_file.h"
#include "tests/hil/source/analyser/scripted_analyser.h"
#include "tests/scenarios/released_pins.h"
#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

namespace fs = std::filesystem;
using live::CaptureOptions;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kFirmware =
    "{source: gpio, chip: gpiochip0, stamp_err_us: 1, lines: {galvo_x_pul: 0, galvo_x_dir: 1, "
    "galvo_y_pul: 2, galvo_y_dir: 3, laser_gate: 4, laser_pwm: 5}}";

constexpr const char* kAnalyser =
    "{source: analyser, driver: fx2lafw, samplerate_hz: 24000000, lines: {galvo_x_pul: D0, galvo_x_dir: D1, "
    "galvo_y_pul: D2, galvo_y_dir: D3, laser_gate: D4, laser_pwm: D5}}";

class PinsToVerdict : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = std::make_unique<ScratchFolder>();
    good_ = std::make_unique<ReleasedPins>(scratch_->path(), "good", "{}");
    bad_ = std::make_unique<ReleasedPins>(scratch_->path(), "bad", "{faults: {no_pincushion: true}}");
  }
  static void TearDownTestSuite() {
    good_.reset();
    bad_.reset();
    scratch_.reset();
  }
  static live::RealPins pins(std::shared_ptr<source::GpioSystem> kernel) {
    return {.gpio = std::move(kernel),
            .chips = &source::ScriptedKernel::listed,
            .serial = nullptr,
            .analysers = nullptr};
  }
  static live::RealPins analyser(const ReleasedPins& release) {
    auto script = std::make_shared<source::ScriptedAnalyser>();
    script->runs = release.sampled(24'000'000);
    return {.gpio = nullptr, .chips = {}, .serial = nullptr, .analysers = std::move(script)};
  }
  static std::string replacedIn(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
  }
  judge::RunOptions options() const {
    judge::RunOptions options;
    options.results_dir = results_.path();
    options.bin_dir = fs::path(KERFBENCH_BINARY_DIR) / "bin";
    options.quiet = true;
    options.pictures = false;
    options.twin = "fast";
    return options;
  }
  int runOn(const live::RealPins& real, const fs::path& scenario) const {
    base::Stopwatch stopwatch;
    base::Console console(true);
    scenario::Case test_case = scenario::readCase(scenario, fs::path());
    test_case.scenario.fidelity = twin::Fidelity::kFast;
    return runOnPins(test_case, real, options(), stopwatch, console);
  }
  int run(const ReleasedPins& release, const std::shared_ptr<source::GpioSystem>& kernel) const {
    return runOn(pins(kernel), release.scenario(kFirmware));
  }
  CaptureOptions captureOptions(const ReleasedPins& release, const char* firmware = kFirmware) const {
    return {.scenario = release.scenario(firmware),
            .out = results_.path() / "heard",
            .time_limit_s = {},
            .session = false,
            .quiet = true,
            .bin_dir = options().bin_dir};
  }
  /// Judges the recording of capture; returns the exit code.
  int replay(const ReleasedPins& release, const char* firmware = kFirmware) const {
    return app::replayCommand({results_.path() / "heard" / "pins.vcd", release.scenario(firmware), {}, {}},
                              options());
  }
  /// Whether two files are equal. EXPECT_EQ would need all memory to describe how long texts differ.
  static bool same(const fs::path& a, const fs::path& b) {
    return !textOf(a).empty() && textOf(a) == textOf(b);
  }
  /// Scenario of a release with its kerf pictures in a folder, for `firmware`.
  fs::path photographed(const ReleasedPins& release, const char* firmware) const {
    fs::create_directories(photographs());
    const fs::path scenario = release.scenario(firmware);
    std::ofstream(scenario, std::ios::app)
        << fmt::format("cameras: {{kerf: {{source: tiles, folder: '{}'}}}}\n", photographs().string());
    return scenario;
  }
  fs::path photographs() const { return results_.path() / "photographs"; }
  /// Makes the pictures of the sheet that this release cuts.
  void photograph(const ReleasedPins& release) const {
    scenario::Case test_case =
        scenario::readCase(release.scenario("{source: native, image: controller-native}"),
                           fs::path(KERFBENCH_BINARY_DIR) / "firmware");
    test_case.scenario.fidelity = twin::Fidelity::kFast;
    run::CutSheet cut = run::cutOnTwin(test_case, options().bin_dir, [](double, const std::string&) {});
    camera::TwinTileSource tiles =
        run::kerfTiles(test_case, test_case.machine, cut.machine->sheet(), {.threads = 2});
    fs::remove_all(photographs());
    camera::writeTiles(tiles, photographs());
  }
  nlohmann::json verdict(const std::string& name) const { return verdictOf(results_.path() / name); }

  static inline std::unique_ptr<ScratchFolder> scratch_;
  static inline std::unique_ptr<ReleasedPins> good_, bad_;
  const ScratchFolder results_;
};

TEST_F(PinsToVerdict, AGoodReleasePassesAndItsCaptureReplayedHasTheSameDigest) {
  EXPECT_EQ(run(*good_, good_->kernel()), 0);
  const auto live = verdict("good-pins");
  EXPECT_EQ(live.at("verdict"), "PASS");
  EXPECT_EQ(captureOnPins(pins(good_->kernel()), captureOptions(*good_)), 0);
  EXPECT_EQ(replay(*good_), 0);
  EXPECT_EQ(verdict("good-pins-replay").at("digest"), live.at("digest"));
  EXPECT_TRUE(
      same(results_.path() / "heard" / "pins.vcd", results_.path() / "good-pins" / "latest" / "pins.vcd"));
}

TEST_F(PinsToVerdict, ABadReleaseFails) {
  EXPECT_EQ(run(*bad_, bad_->kernel()), 1);
  EXPECT_THAT(checksThat(verdict("bad-pins"), "FAIL"), Contains("path"));
}

// The pictures show an earlier sheet, which may have been a good one.
TEST_F(PinsToVerdict, KerfPicturesFromBeforeTheCutAreRefusedBeforeAnythingIsOpened) {
  const auto kernel = good_->kernel();
  const auto scenario = photographed(*good_, kFirmware);
  try {
    (void)runOn(pins(kernel), scenario);
    FAIL() << "it cut";
  } catch (const base::InputError& fault) {
    EXPECT_THAT(fault.what(),
                AllOf(HasSubstr("good.yaml:6: cameras.kerf.folder: pictures that are there before"),
                      HasSubstr("replay PINS.vcd --scenario " + scenario.string())));
  }
  EXPECT_EQ(kernel->request.num_lines, 0U);
  const auto emulated =
      kerfbench(fmt::format("run '{}' -q --results-dir '{}'",
                            photographed(*good_, "{source: native}").string(), results_.path().string()));
  EXPECT_EQ(emulated.exit_code, 65);
  EXPECT_THAT(emulated.output, HasSubstr("good.yaml:6: cameras.kerf.folder: pictures that are there before"));
  EXPECT_FALSE(fs::exists(results_.path() / "good-pins"));
}

TEST_F(PinsToVerdict, KerfPicturesThatWereTakenOfTheSheetAreJudgedInAReplayThatTellsWhichTheyWere) {
  EXPECT_EQ(captureOnPins(pins(good_->kernel()), captureOptions(*good_)), 0);
  const auto judged = [&] {
    return app::replayCommand(
        {results_.path() / "heard" / "pins.vcd", photographed(*good_, kFirmware), {}, {}}, options());
  };
  photograph(*good_);
  EXPECT_EQ(judged(), 0) << verdict("good-pins-replay").at("problems");
  const std::string versions = verdict("good-pins-replay").at("versions").dump();
  const fs::path sums = results_.path() / "sums";
  ASSERT_EQ(std::system(fmt::format("cd '{}' && sha256sum tiles.yaml tile-*.png | sha256sum >'{}'",
                                    photographs().string(), sums.string())
                            .c_str()),
            0);
  EXPECT_THAT(versions, HasSubstr("sha256 of their sums " + textOf(sums).substr(0, 64)));
  // The pins are good, and the sheet belongs to others.
  photograph(*bad_);
  EXPECT_EQ(judged(), 1);
  EXPECT_NE(verdict("good-pins-replay").at("versions").dump(), versions);
}

// The sheet is cut, even if the judge fails.
TEST_F(PinsToVerdict, ARunThatCannotBeConcludedKeepsItsRecordingForAReplay) {
  const auto brokenRun = [&] {
    base::Stopwatch stopwatch;
    base::Console console(true);
    scenario::Case test_case = scenario::readCase(good_->scenario(kFirmware), fs::path());
    test_case.scenario.fidelity = twin::Fidelity::kFast;
    // The break comes while the pins are read: the judge comes later.
    const auto kernel = good_->kernel();
    kernel->before_poll = [&test_case, levels = kernel->before_poll](std::uint64_t now) {
      levels(now);
      test_case.machine.glow_gray_per_w = std::numeric_limits<double>::quiet_NaN();
    };
    testing::internal::CaptureStdout();
    EXPECT_THROW((void)runOnPins(test_case, pins(kernel), options(), stopwatch, console),
                 std::invalid_argument);
    return testing::internal::GetCapturedStdout();
  };
  const fs::path kept = results_.path() / "good-pins-capture";
  EXPECT_THAT(brokenRun(), AllOf(HasSubstr("what was recorded is kept in " + kept.string()),
                                 HasSubstr("./bench replay " + (kept / "pins.vcd").string())));
  EXPECT_FALSE(fs::exists(results_.path() / "good-pins"));
  EXPECT_EQ(textOf(kept / "scenario.yaml"), textOf(good_->scenario(kFirmware)));
  EXPECT_EQ(app::replayCommand({kept / "pins.vcd", good_->scenario(kFirmware), {}, {}}, options()), 0);
  // Later evidence does not replace earlier evidence.
  EXPECT_THAT(brokenRun(), HasSubstr(kept.string() + "-2"));
  EXPECT_TRUE(same(kept / "pins.vcd", results_.path() / "good-pins-capture-2" / "pins.vcd"));
}

// Evidence that was spoiled when read cannot become clean through a file.
TEST_F(PinsToVerdict, AnEdgeThatIsMissingMakesRunAndCaptureAndReplayInvalid) {
  constexpr std::uint32_t kMerged = 5000;
  EXPECT_EQ(run(*good_, good_->kernel(kMerged)), 3);
  const auto live = verdict("good-pins");
  EXPECT_EQ(live.at("verdict"), "INVALID");
  EXPECT_THAT(live.at("problems").get<std::vector<std::string>>(),
              Contains(HasSubstr("1 edge lost in the kernel before they were read")));
  EXPECT_EQ(captureOnPins(pins(good_->kernel(kMerged)), captureOptions(*good_)), 3);
  EXPECT_EQ(replay(*good_), 3);
  const auto replayed = verdict("good-pins-replay");
  EXPECT_EQ(replayed.at("problems"), live.at("problems"));
  EXPECT_EQ(replayed.at("digest"), live.at("digest"));
  // The recording of the replay cannot make it clean either.
  EXPECT_TRUE(same(results_.path() / "good-pins-replay" / "latest" / "pins.vcd",
                   results_.path() / "good-pins" / "latest" / "pins.vcd"));
}

TEST_F(PinsToVerdict, ACaptureHoldsTheRecordingAndItsScenarioAndNoMore) {
  const CaptureOptions options = captureOptions(*good_);
  EXPECT_EQ(captureOnPins(pins(good_->kernel()), options), 0);
  EXPECT_EQ(textOf(options.out / "scenario.yaml"), textOf(options.scenario));
  EXPECT_TRUE(fs::exists(options.out / judge::kResultsList));
  EXPECT_EQ(std::distance(fs::directory_iterator(options.out), {}), 3);
  // A second recording takes its place.
  EXPECT_EQ(captureOnPins(pins(good_->kernel()), options), 0);
}

TEST_F(PinsToVerdict, ACaptureNeverReplacesAFolderThatIsNoneOfIts) {
  CaptureOptions options = captureOptions(*good_);
  fs::create_directories(options.out);
  std::ofstream(options.out / "thesis.tex") << "years";
  const auto kernel = good_->kernel();
  EXPECT_THROW(captureOnPins(pins(kernel), options), base::InputError);
  EXPECT_EQ(textOf(options.out / "thesis.tex"), "years");
  EXPECT_EQ(kernel->request.num_lines, 0U) << "refused before anybody starts a job";
  options.out /= "thesis.tex";
  EXPECT_THROW(captureOnPins(pins(kernel), options), base::InputError);
}

TEST_F(PinsToVerdict, ByAnAnalyserAGoodReleasePassesAndItsCaptureReplayedHasTheSameDigest) {
  const live::RealPins real = analyser(*good_);
  EXPECT_EQ(runOn(real, good_->scenario(kAnalyser)), 0);
  const auto live = verdict("good-pins");
  EXPECT_EQ(live.at("verdict"), "PASS");
  EXPECT_EQ(captureOnPins(real, captureOptions(*good_, kAnalyser)), 0);
  EXPECT_EQ(replay(*good_, kAnalyser), 0);
  EXPECT_EQ(verdict("good-pins-replay").at("digest"), live.at("digest"));
}

TEST_F(PinsToVerdict, ByAnAnalyserABadReleaseFails) {
  EXPECT_EQ(runOn(analyser(*bad_), bad_->scenario(kAnalyser)), 1);
}

TEST_F(PinsToVerdict, AnAnalyserThatStopsByItselfMakesRunAndCaptureAndReplayInvalid) {
  live::RealPins real = analyser(*good_);
  // All edges are there, but that is unknown.
  std::dynamic_pointer_cast<source::ScriptedAnalyser>(real.analysers)->runs.pop_back();
  EXPECT_EQ(runOn(real, good_->scenario(kAnalyser)), 3);
  const auto live = verdict("good-pins");
  EXPECT_THAT(live.at("problems").get<std::vector<std::string>>(),
              Contains(HasSubstr("the analyser stopped by itself")));
  EXPECT_EQ(captureOnPins(real, captureOptions(*good_, kAnalyser)), 3);
  EXPECT_EQ(replay(*good_, kAnalyser), 3);
  EXPECT_EQ(verdict("good-pins-replay").at("digest"), live.at("digest"));
}

// The program runs libsigrok's demo driver as a user does: its pattern is no job.
TEST_F(PinsToVerdict, TheDemoAnalyserEndsInvalidAndIsHeardEdgeByEdge) {
  const std::string firmware = replacedIn(replacedIn(kAnalyser, "fx2lafw", "demo"), "samplerate_hz: 24000000",
                                          "samplerate_hz: 4000000, settings: {pattern: incremental}");
  const auto scenario = good_->scenario(firmware);
  const auto run =
      kerfbench(fmt::format("run '{}' --twin fast --no-pictures --time-limit 0.02 --results-dir '{}'",
                            scenario.string(), results_.path().string()));
  EXPECT_EQ(run.exit_code, 3) << run.output;
  EXPECT_THAT(run.output, HasSubstr("listening to 6 channels by demo at 4000000 Hz"));
  const auto live = verdict("good-pins");
  EXPECT_EQ(live.at("verdict"), "INVALID");
  EXPECT_THAT(live.at("problems").get<std::vector<std::string>>(),
              Contains(HasSubstr("the time limit of 0.02 s was reached, and the pins were not quiet")));
  const auto capture = kerfbench(fmt::format("capture '{}' --time-limit 0.02 -o '{}/heard'",
                                             scenario.string(), results_.path().string()));
  EXPECT_EQ(capture.exit_code, 3) << capture.output;
  // The samples are 80 000 numbers that count up: bit i changes with each 2^i th.
  for (const char* heard : {"galvo_x_pul         79999 edges", "galvo_x_dir         39999 edges",
                            "galvo_y_pul         19999 edges", "galvo_y_dir          9999 edges",
                            "laser_gate           4999 edges", "laser_pwm            2499 edges"})
    EXPECT_THAT(capture.output, HasSubstr(heard));
  const auto replay =
      kerfbench(fmt::format("replay '{0}/heard/pins.vcd' --scenario '{1}' --twin fast --no-pictures "
                            "--time-limit 0.02 --results-dir '{0}'",
                            results_.path().string(), scenario.string()));
  EXPECT_EQ(replay.exit_code, 3) << replay.output;
  EXPECT_EQ(verdict("good-pins-replay").at("digest"), live.at("digest"));
}

TEST_F(PinsToVerdict, ACaptureBesideARealCameraSaysThatItHoldsNoFrames) {
  const auto scenario = good_->scenario(replacedIn(kAnalyser, "fx2lafw", "demo"));
  const auto heard = [&] {
    return kerfbench(fmt::format("capture '{}' --time-limit 0.02 -o '{}/heard'", scenario.string(),
                                 results_.path().string()))
        .output;
  };
  EXPECT_THAT(heard(), AllOf(HasSubstr("judge it: "), Not(HasSubstr("--frames"))));
  std::ofstream(scenario, std::ios::app)
      << "cameras: {spot: {source: v4l2, device: /dev/video7, format: GREY, exposure_us: 200, "
         "frames_per_s: 400}, kerf: {source: twin}}\n";
  EXPECT_THAT(heard(), AllOf(HasSubstr("the spot camera is real and not recorded here"),
                             HasSubstr(scenario.string() + " --frames FOLDER")));
}

// The session that sigrok-cli makes of a recording is the same evidence, at the rate of its ticks and at a
// lower one.
TEST_F(PinsToVerdict, ASessionBySigrokIsJudgedAsTheRecordingIs) {
  if (std::system("command -v sigrok-cli >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "sigrok-cli is not installed";
  const auto judged = [&](const ReleasedPins& release, const std::string& name, int every) {
    const fs::path vcd = scratch_->path() / (name + "-pins") / "latest" / "pins.vcd";
    const fs::path session = results_.path() / (name + ".sr");
    const std::string convert =
        fmt::format("sigrok-cli -I vcd:downsample={} -i '{}' -O srzip -o '{}' >/dev/null 2>&1", every,
                    vcd.string(), session.string());
    EXPECT_EQ(std::system(convert.c_str()), 0);
    const int code = app::replayCommand({session, release.scenario("{source: native}"), {}, {}}, options());
    EXPECT_EQ(source::readSr(session, release.map(), {}).outputs.size(), release.recording().outputs.size());
    return code;
  };
  EXPECT_EQ(judged(*good_, "good", 625), 0);
  EXPECT_EQ(judged(*good_, "good", 1250), 0);
  EXPECT_EQ(judged(*bad_, "bad", 625), 1);
}

TEST_F(PinsToVerdict, ASessionThatIsTooCoarseForThePulsesIsInvalid) {
  source::PinRecording coarse;
  coarse.rate = {1, 100'000};
  coarse.outputs = {{1000, 0, 1, 1, 0}, {1001, 0, 1, 0, 0}};
  coarse.end = 20'000;
  source::writeSr(results_.path() / "coarse.sr", coarse, good_->map());
  EXPECT_EQ(app::replayCommand({results_.path() / "coarse.sr", good_->scenario("{source: native}"), {}, {}},
                               options()),
            3);
  EXPECT_THAT(verdict("good-pins-replay").at("problems").get<std::vector<std::string>>(),
              Contains(HasSubstr("100000 Hz is too low for galvo_x_pul: its drive (galvo-pul-dir) takes "
                                 "pulses of 2.5 us, and 4 samples "
                                 "of each need at least 1600000 Hz")));
}

TEST_F(PinsToVerdict, AnAnalysersCaptureIsASessionTooThatIsJudgedAlike) {
  const live::RealPins real = analyser(*good_);
  CaptureOptions capture = captureOptions(*good_, kAnalyser);
  capture.session = true;
  EXPECT_EQ(captureOnPins(real, capture), 0);
  EXPECT_EQ(replay(*good_, kAnalyser), 0);
  const auto by_vcd = verdict("good-pins-replay");
  EXPECT_EQ(app::replayCommand({capture.out / "pins.sr", good_->scenario(kAnalyser), {}, {}}, options()), 0);
  EXPECT_EQ(verdict("good-pins-replay").at("digest"), by_vcd.at("digest"));
  capture.scenario = good_->scenario(kFirmware);
  EXPECT_THROW(captureOnPins(pins(good_->kernel()), capture), base::InputError);
}

TEST_F(PinsToVerdict, ASessionThatCannotBeReadIsAnErrorInWords) {
  std::ofstream(results_.path() / "cut.sr") << "PK";
  const auto run =
      kerfbench(fmt::format("replay '{0}/cut.sr' --scenario '{1}' --results-dir '{0}'",
                            results_.path().string(), good_->scenario("{source: native}").string()));
  EXPECT_EQ(run.exit_code, 65);
  EXPECT_THAT(run.output, HasSubstr("cut.sr: no readable zip archive"));
}

TEST_F(PinsToVerdict, OnlyRealPinsAreCaptured) {
  const auto scenario = good_->scenario("{source: native}");
  const auto run =
      kerfbench(fmt::format("capture '{}' -o '{}/x'", scenario.string(), results_.path().string()));
  EXPECT_EQ(run.exit_code, 65);
  EXPECT_THAT(run.output, HasSubstr("firmware.source: nothing to capture"));
  EXPECT_FALSE(fs::exists(results_.path() / "x"));
}

TEST_F(PinsToVerdict, PinsThatCannotBeHadLeaveNoFolder) {
  const auto scenario = good_->scenario(replacedIn(kFirmware, "gpiochip0", "no-such-chip"));
  const auto run =
      kerfbench(fmt::format("capture '{}' -o '{}/x'", scenario.string(), results_.path().string()));
  EXPECT_EQ(run.exit_code, 65) << run.output;
  EXPECT_THAT(run.output, AllOf(HasSubstr("good.yaml:"), HasSubstr("no-such-chip")));
  EXPECT_EQ(std::distance(fs::directory_iterator(results_.path()), {}), 0);
}

}  // namespace
}  // namespace kerfbench::test
