// SPDX-License-Identifier: Apache-2.0
// From the edges of a gpiochip to a verdict: the native release's pins through a scripted kernel.
#include "hil/app/real_pins.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <memory>

#include "hil/app/release.h"
#include "tests/scenarios/released_pins.h"
#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

namespace fs = std::filesystem;
using hil::CaptureCommandOptions;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kFirmware =
    "{source: gpio, chip: gpiochip0, stamp_err_us: 1, lines: {galvo_x_pul: 0, galvo_x_dir: 1, "
    "galvo_y_pul: 2, galvo_y_dir: 3, laser_gate: 4, laser_pwm: 5}}";

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
  static hil::RealPins pins(std::shared_ptr<hil::GpioSystem> kernel) {
    return {.gpio = std::move(kernel), .chips = [] {
              hil::GpioChipInfo chip{"/dev/gpiochip0", "gpiochip0", "script", {}};
              for (std::uint32_t i = 0; i < hil::ScriptedKernel::kLines; ++i)
                chip.lines.push_back({i, "", "", false, false, false});
              return hil::GpioChipList{{chip}, {}};
            }};
  }
  hil::CommonOptions options() const {
    hil::CommonOptions options;
    options.results_dir = results_.path();
    options.bin_dir = fs::path(KERFBENCH_BINARY_DIR) / "bin";
    options.quiet = true;
    options.pictures = false;
    options.twin = "fast";
    return options;
  }
  int run(const ReleasedPins& release, const std::shared_ptr<hil::GpioSystem>& kernel) const {
    hil::Stopwatch stopwatch;
    hil::Console console(true);
    hil::Case the_case = hil::readCase(release.scenario(kFirmware), {});
    the_case.scenario.fidelity = twin::Fidelity::kFast;
    return runOnPins(the_case, pins(kernel), options(), stopwatch, console);
  }
  CaptureCommandOptions captureOptions(const ReleasedPins& release) const {
    return {.scenario = release.scenario(kFirmware),
            .out = results_.path() / "heard",
            .time_limit_s = {},
            .quiet = true,
            .bin_dir = options().bin_dir};
  }
  /// What capture recorded, judged. The exit code.
  int replay(const ReleasedPins& release) const {
    return hil::replayCommand(results_.path() / "heard" / "pins.vcd", release.scenario(kFirmware), options());
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
  EXPECT_EQ(textOf(results_.path() / "heard" / "pins.vcd"),
            textOf(results_.path() / "good-pins" / "pins.vcd"));
}

TEST_F(PinsToVerdict, ABadReleaseFails) {
  EXPECT_EQ(run(*bad_, bad_->kernel()), 1);
  EXPECT_THAT(checksThat(verdict("bad-pins"), "FAIL"), Contains("path"));
}

// What was spoiled when it was heard cannot be made clean by way of a file.
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
  // Nor by the recording of the replay.
  EXPECT_EQ(textOf(results_.path() / "good-pins-replay" / "pins.vcd"),
            textOf(results_.path() / "good-pins" / "pins.vcd"));
}

TEST_F(PinsToVerdict, ACaptureHoldsTheRecordingAndItsScenarioAndNoMore) {
  const CaptureCommandOptions options = captureOptions(*good_);
  EXPECT_EQ(captureOnPins(pins(good_->kernel()), options), 0);
  EXPECT_EQ(textOf(options.out / "scenario.yaml"), textOf(options.scenario));
  EXPECT_EQ(std::distance(fs::directory_iterator(options.out), {}), 2);
  // A second one takes its place.
  EXPECT_EQ(captureOnPins(pins(good_->kernel()), options), 0);
}

TEST_F(PinsToVerdict, ACaptureNeverReplacesAFolderThatIsNoneOfIts) {
  CaptureCommandOptions options = captureOptions(*good_);
  fs::create_directories(options.out);
  std::ofstream(options.out / "thesis.tex") << "years";
  const auto kernel = good_->kernel();
  EXPECT_THROW(captureOnPins(pins(kernel), options), hil::InputFault);
  EXPECT_EQ(textOf(options.out / "thesis.tex"), "years");
  EXPECT_EQ(kernel->request.num_lines, 0U) << "refused before anybody starts a job";
  options.out /= "thesis.tex";
  EXPECT_THROW(captureOnPins(pins(kernel), options), hil::InputFault);
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
  const auto run = kerfbench(
      fmt::format("capture '{}' -o '{}/x'", good_->scenario(kFirmware).string(), results_.path().string()));
  EXPECT_EQ(run.exit_code, 65) << run.output;
  EXPECT_THAT(run.output, HasSubstr("good.yaml:"));
  EXPECT_EQ(std::distance(fs::directory_iterator(results_.path()), {}), 0);
}

}  // namespace
}  // namespace kerfbench::test
