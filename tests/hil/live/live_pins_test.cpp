// SPDX-License-Identifier: Apache-2.0
// Whole live runs: release, pins, the bench's live source, the machine ahead of the clock, and the judge.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <cerrno>
#include <functional>
#include <nlohmann/json.hpp>

#include "hil/app/run_command.h"
#include "hil/judge/run_options.h"
#include "hil/live/real_pins.h"
#include "hil/live/run_on_pins.h"
#include "hil/run/release.h"
#include "hil/source/open.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/live/board_kernel.h"

namespace kerfbench::live {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

const std::filesystem::path kFirmware = KERFBENCH_FIRMWARE;

const BoardKernel::Wiring kWiring{{0, Signal::kGalvoXPul}, {1, Signal::kGalvoXDir}, {2, Signal::kGalvoYPul},
                                  {3, Signal::kGalvoYDir}, {4, Signal::kLaserGate}, {5, Signal::kLaserPwm},
                                  {8, Signal::kEncoderA},  {9, Signal::kEncoderB},  {10, Signal::kPrintMark},
                                  {11, Signal::kInterlock}};

constexpr const char* kOnPins =
    "print: {units: 1}\n"
    "twin: fast\n"
    "firmware:\n"
    "  source: gpio\n"
    "  image: controller-native\n"
    "  uart: /dev/ttyS9\n"
    "  chip: gpiochip0\n"
    "  stamp_err_us: 0.1\n"
    "  lines: {galvo_x_pul: 0, galvo_x_dir: 1, galvo_y_pul: 2, galvo_y_dir: 3, laser_gate: 4, laser_pwm: 5}\n"
    "  outputs: {encoder_a: 8, encoder_b: 9, print_mark: 10, interlock: 11}\n";

class LivePinsTest : public testing::Test {
 protected:
  /// Connects a board with this release on it.
  void plugIn(const std::string& release) {
    source::ChildSourceOptions child;
    child.image = kFirmware / release;
    child.child = release.ends_with(".hex") ? kFirmware.parent_path() / "bin" / "kerfbench-avr" : child.image;
    const SignalMap pins =
        machine_file::readMachineFile(base::fixture("machines/two-mirror.yaml")).machine.signals;
    board = std::make_shared<BoardKernel>(source::openChild(child), pins, kWiring);
  }
  void write(const std::string& more = {}, const std::string& base = kOnPins) {
    scenario = temp.write("label.yaml", "extends: " + base::fixture("scenarios/label-on-belt.yaml").string() +
                                            "\nname: on-pins\n" + base + more);
    options.results_dir = temp.path() / "results";
    options.bin_dir = kFirmware.parent_path() / "bin";
    options.quiet = true;
    options.pictures = false;
  }
  int run() {
    base::Stopwatch stopwatch;
    base::Console console(true);
    const scenario::Case test_case = scenario::readCase(scenario, kFirmware);
    return runOnPins(test_case, {board, &source::ScriptedKernel::listed, board->serial(), nullptr}, options,
                     stopwatch, console);
  }
  nlohmann::json verdict(const std::string& name = "on-pins") const {
    return nlohmann::json::parse(base::contentOf(options.results_dir / name / "latest" / "verdict.json"));
  }
  std::vector<std::string> problems() const { return verdict()["problems"]; }
  /// Expects that a replay of the recording agrees with the live run.
  void expectReplayAgrees(int live_code) {
    const auto recording = options.results_dir / "on-pins" / "latest" / "pins.vcd";
    EXPECT_EQ(app::replayCommand({recording, scenario, {}, {}}, options), live_code);
    EXPECT_EQ(verdict("on-pins-replay")["verdict"], verdict()["verdict"]);
  }
  const base::TempFolder temp;
  std::filesystem::path scenario;
  judge::RunOptions options;
  std::shared_ptr<BoardKernel> board;
};

TEST_F(LivePinsTest, AGoodReleaseOnRealPinsPassesAndSoDoesItsReplayWithTheSameDigest) {
  plugIn("controller-native");
  write();
  board->set_takes_ns = 3'000;
  EXPECT_EQ(run(), 0) << verdict()["problems"];
  expectReplayAgrees(0);
  EXPECT_EQ(verdict("on-pins-replay")["digest"], verdict()["digest"]);
  EXPECT_THAT(verdict()["source"].get<std::string>(), HasSubstr("at worst 3.0 us behind their plan"));
  EXPECT_THAT(board->open_fds, testing::IsEmpty());
  EXPECT_EQ(board->real_time, 0);
}

// The release reads 101 counts of the encoder where 100 were driven.
TEST_F(LivePinsTest, AReleaseThatMisreadsTheDrivenEncoderFails) {
  plugIn("fault-encoder-scale-avr.hex");
  write({}, base::replaced(kOnPins, "controller-native", "fault-encoder-scale-avr.hex"));
  EXPECT_EQ(run(), 1) << verdict()["problems"];
  expectReplayAgrees(1);
  EXPECT_EQ(verdict("on-pins-replay")["digest"], verdict()["digest"]);
}

// The line carries the report 21 ms after the pins are known: a host must not give up before.
TEST_F(LivePinsTest, AReleaseThatStopsByItselfFailsAndSoDoesItsReplayWithTheSameDigest) {
  plugIn("controller-native");
  write("belt: {profile: [{at_s: 3, speed_mm_s: 250}]}\n");
  EXPECT_EQ(run(), 1) << verdict()["problems"];
  EXPECT_THAT(verdict()["summary"].get<std::string>(), HasSubstr("the belt is too fast for this job"));
  expectReplayAgrees(1);
  EXPECT_EQ(verdict("on-pins-replay")["digest"], verdict()["digest"]);
}

// The latency is an FTDI's timer: at 60 mm/s the belt goes on by 96 counts meanwhile.
TEST_F(LivePinsTest, AGoodReleaseBehindASlowAdapterPasses) {
  plugIn("controller-native");
  board->serial_latency_ns = 16'000'000;
  write();
  EXPECT_EQ(run(), 0) << verdict()["problems"];
  expectReplayAgrees(0);
  EXPECT_EQ(verdict("on-pins-replay")["digest"], verdict()["digest"]);
  // The declaration of a quicker line is accepted.
  write("  uart_delay_ms: 0\n");
  EXPECT_EQ(app::replayCommand({options.results_dir / "on-pins" / "latest" / "pins.vcd", scenario, {}, {}},
                               options),
            1);
}

/// Runs that cannot end well: the evidence is INVALID and states why, and a replay of it is INVALID as well.
class SpoiltLivePinsTest : public LivePinsTest {
 protected:
  SpoiltLivePinsTest() {
    plugIn("controller-native");
    write("time_limit_s: 3\n");
  }
  /// Does something after this real time of the run.
  void at(std::uint64_t ms, const std::function<void()>& work) {
    board->before_poll = [ms, work, done = false](std::uint64_t now) mutable {
      if (done || now < source::ScriptedKernel::kStart_ns + ms * 1'000'000U) return;
      done = true;
      work();
    };
  }
  void expectInvalid(const std::string& words) {
    EXPECT_EQ(run(), 3);
    EXPECT_THAT(problems(), Contains(HasSubstr(words)));
    expectReplayAgrees(3);
    EXPECT_THAT(board->open_fds, testing::IsEmpty());
    EXPECT_EQ(board->serial()->lines_open, 0);
  }
  void expectRefused(const std::string& words) {
    try {
      run();
      FAIL() << "it ran";
    } catch (const base::InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr(words));
    }
    EXPECT_FALSE(std::filesystem::exists(options.results_dir / "on-pins"));
    EXPECT_THAT(board->open_fds, testing::IsEmpty());
    EXPECT_EQ(board->serial()->lines_open, 0);
  }
};

TEST_F(SpoiltLivePinsTest, AnOutputLineThatIsTakenIsRefused) {
  board->taken = {{9, "spi0 CS0"}};
  expectRefused("line 9 for encoder_b is taken by 'spi0 CS0'");
}

TEST_F(SpoiltLivePinsTest, ACaptureAloneDrivesNothingAndIsRefused) {
  base::Console console(true);
  try {
    (void)hearPins(scenario::readCase(scenario, kFirmware),
                   {board, &source::ScriptedKernel::listed, board->serial(), nullptr}, console);
    FAIL() << "it listened";
  } catch (const base::InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("firmware.outputs and firmware.uart need the model beside the pins"));
  }
}

TEST_F(SpoiltLivePinsTest, ASerialLineThatIsNotThereIsRefusedWithFileAndLine) {
  board->serial()->open_error = ENOENT;
  expectRefused("label.yaml:8: firmware.uart: /dev/ttyS9: no such serial line");
}

TEST_F(SpoiltLivePinsTest, AChipThatVanishes) {
  at(700, [this] { board->poll_revents = POLLERR | POLLHUP; });
  expectInvalid("the real pins were lost at 0.6");
}

TEST_F(SpoiltLivePinsTest, AnOutputThatFails) {
  at(700, [this] { board->set_error = EIO; });
  expectInvalid("its lines can no longer be driven");
}

TEST_F(SpoiltLivePinsTest, ASerialLineThatHangsUp) {
  at(700, [this] { board->serial()->hung_up = true; });
  expectInvalid("/dev/ttyS9: the other end has hung up");
}

TEST_F(SpoiltLivePinsTest, AModelThatDoesNotKeepUp) {
  at(700, [this] { board->passTime(400'000'000); });
  expectInvalid("does not keep up with the clock");
}

// At 60 mm/s 0.3 ms are 18 um of the sheet.
TEST_F(SpoiltLivePinsTest, EdgesThatArePutOutTooLate) {
  at(700, [this] { board->passTime(300'000); });
  expectInvalid("edges of the machine's sensor were not driven within 166.7 us");
}

TEST_F(SpoiltLivePinsTest, AnEdgeBehindTheWatermark) {
  at(700, [this] {
    const std::uint64_t now = board->now_ns();
    board->toggle(now - 40'000'000, 5);
    board->toggle(now - 39'000'000, 5);
  });
  expectInvalid("later than the kernel's threads may be");
}

TEST_F(SpoiltLivePinsTest, AControllerThatSaysNothing) {
  board->serial()->takes = 0;
  expectInvalid("no edge came: is the controller wired, powered and started?");
}

}  // namespace
}  // namespace kerfbench::live
