// SPDX-License-Identifier: Apache-2.0
// Control programs compiled by SDCC, in the emulator of the 8051.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/source/emulator/image_file.h"
#include "hil/source/emulator/intel_hex.h"
#include "hil/source/mcs51_child/chip.h"
#include "small_job.h"

namespace kerfbench::planner {
namespace {

using emulator::PinEvent;
using mcs51_child::Chip;
using mcs51_child::Tick;
using test::Shown;

constexpr double kClock_hz = 24e6;
constexpr Tick kPress = 24'000;

/// Input of a run: pin of port 3, level, clock.
struct Input {
  Tick tick{};
  unsigned bit{};
  bool level{};
};

class OwnJobOnChip : public testing::Test {
 protected:
  void SetUp() override {
    if (std::string(KERFBENCH_SDCC).find("NOTFOUND") != std::string::npos ||
        std::string(KERFBENCH_SDCC).empty())
      GTEST_SKIP() << "sdcc is not installed";
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("own_job_") + std::to_string(::getpid()) + "_" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// Compiles the program as its comment says; its code, with what it takes of the memory in `used`.
  std::vector<std::uint8_t> build(const OwnJob& job) {
    std::ofstream(folder_ / "job.c") << job.source;
    const std::string command = std::string("cd '") + folder_.string() +
                                "' && '" KERFBENCH_SDCC "' -mmcs51 --std-c11 --Werror --code-size " +
                                std::to_string(job.account.code_bytes) + " job.c";
    EXPECT_EQ(std::system(command.c_str()), 0);
    std::vector<std::uint8_t> code(job.account.code_bytes, 0xFF);
    used_ = 0;
    const std::string image = (folder_ / "job.ihx").string();
    emulator::readIntelHex(
        emulator::imageContent(image), image,
        [&](std::uint64_t address, std::span<const std::uint8_t> bytes, const std::string&) {
          used_ = std::max(used_, std::size_t(address) + bytes.size());
          std::ranges::copy(bytes, code.begin() + static_cast<std::ptrdiff_t>(address));
        });
    return code;
  }

  /// Presses the button, sends the marks, and runs an instruction at a time until the job is done. Events of
  /// all ports; `longest_` is the longest time from the begin of a tick to where the next is waited for.
  std::vector<PinEvent> run(const std::vector<std::uint8_t>& code, const std::string& mcu,
                            std::vector<Input> inputs, Tick until) {
    Chip chip(mcs51_child::partCalled(mcu), code, 1U << 22U);
    chip.settle();
    for (const unsigned bit : {2U, 3U}) chip.drive(3, bit, false, chip.now());
    chip.drive(3, 4, true, chip.now());
    std::ranges::sort(inputs, {}, &Input::tick);
    const auto clr_tf0 = std::search(code.rbegin(), code.rend(), kTickBegins.rbegin(), kTickBegins.rend());
    const std::uint32_t begins =
        static_cast<std::uint32_t>(code.rend() - clr_tf0) - std::uint32_t{kTickBegins.size()};
    const std::uint32_t waits = begins - 3U;  // JNB TF0,$ before it.
    Tick began = 0;
    for (std::size_t next = 0; chip.now() < until && chip.fault().empty();) {
      while (next < inputs.size() && inputs[next].tick <= chip.now()) {
        chip.drive(3, inputs[next].bit, inputs[next].level, chip.now());
        ++next;
      }
      if (chip.cpu().pc() == begins) began = chip.now();
      if (chip.cpu().pc() == waits && began > 0) {
        longest_ = std::max(longest_, chip.now() - began);
        began = 0;
      }
      chip.execute(chip.now() + 1);
      while (chip.settle()) {
      }
    }
    EXPECT_EQ(chip.fault(), "");
    return chip.ports().take(mcs51_child::kNever);
  }

  /// The button, and a mark of 1 ms for each unit: the first of them at `first`.
  static std::vector<Input> inputsFor(Tick first, int marks = 3) {
    std::vector<Input> inputs{{kPress, 2, true}, {kPress + 24'000, 2, false}};
    const auto between = static_cast<Tick>(
        std::llround(test::smallJob().pitch_mm / test::smallJob().belt_speed_mm_s * kClock_hz));
    for (int i = 0; i < marks; ++i) {
      const Tick at = first + between * static_cast<Tick>(i);
      inputs.push_back({at, 3, true});
      inputs.push_back({at + 24'000, 3, false});
    }
    return inputs;
  }

  // CLR TF0; JNB P3.4.
  static constexpr std::array<std::uint8_t, 4> kTickBegins{0xC2, 0x8D, 0x30, 0xB4};
  std::filesystem::path folder_;
  std::size_t used_{};
  Tick longest_{};
};

/// PUL and DIR of an axis, state for state, from (1,1).
struct Levels {
  Tick tick{};
  bool pul{true}, dir{true};
};
std::vector<Levels> levelsOf(const std::vector<PinEvent>& events, unsigned axis) {
  std::vector<Levels> all{{}};
  for (const PinEvent& event : events) {
    if (event.port != 1) continue;
    const Levels now{event.tick, (event.level >> (2 * axis) & 1) != 0,
                     (event.level >> (2 * axis + 1) & 1) != 0};
    if (now.pul != all.back().pul || now.dir != all.back().dir) all.push_back(now);
  }
  return all;
}

/// Clock of each falling edge of PUL, and which way it steps.
struct Step {
  Tick tick{};
  int way{};
};
std::vector<Step> stepsOf(const std::vector<Levels>& levels) {
  std::vector<Step> steps;
  for (std::size_t i = 1; i < levels.size(); ++i) {
    if (levels[i - 1].pul && !levels[i].pul) steps.push_back({levels[i].tick, levels[i].dir ? -1 : 1});
  }
  return steps;
}

/// Place of an axis before a clock; each call later than the one before.
class Counter {
 public:
  explicit Counter(std::vector<Step> steps) : steps_(std::move(steps)) {}
  int before(double tick) {
    while (next_ < steps_.size() && static_cast<double>(steps_[next_].tick) < tick)
      at_ += steps_[next_++].way;
    return at_;
  }

 private:
  std::vector<Step> steps_;
  std::size_t next_{};
  int at_{};
};

double seconds(Tick from, Tick to) { return static_cast<double>(to - from) / kClock_hz; }

/// DIR changes while PUL rests, between pulses, and a pulse comes next; all times are as promised.
void expectFigure5(const std::vector<Levels>& levels, const Target& target) {
  ASSERT_GT(levels.size(), 500U);
  for (std::size_t i = 1; i < levels.size(); ++i) {
    const Levels& before = levels[i - 1];
    const Levels& now = levels[i];
    const double long_s = seconds(before.tick, now.tick);
    if (now.dir != before.dir) {
      ASSERT_TRUE(now.pul && before.pul) << i;
      ASSERT_LT(i + 1, levels.size());
      ASSERT_TRUE(!levels[i + 1].pul && levels[i + 1].dir == now.dir) << i;
      EXPECT_GE(seconds(now.tick, levels[i + 1].tick), target.setup_s) << i;
      if (i > 1) EXPECT_GE(seconds(levels[i - 2].tick, now.tick), target.hold_s) << i;
    } else if (now.pul) {
      EXPECT_GE(long_s, target.width_s) << i;
    } else if (i > 1) {
      EXPECT_GE(long_s, target.space_s) << i;
    }
  }
}

constexpr Tick kFirstMark = 9'600'000;  // 0.4 s: the beam is where the first unit begins.
constexpr Tick kUntil = 150'000'000;

double markAt(int unit) {
  return static_cast<double>(kFirstMark) +
         unit * test::smallJob().pitch_mm / test::smallJob().belt_speed_mm_s * kClock_hz;
}

class OwnJobOnEachChip : public OwnJobOnChip, public testing::WithParamInterface<const char*> {};

TEST_P(OwnJobOnEachChip, MakesThePulsesOfFigure5WithinItsAccount) {
  const OwnJob job = test::makeSmallJob({.mcu = GetParam()});
  const std::vector<PinEvent> events = run(build(job), GetParam(), inputsFor(kFirstMark), kUntil);
  EXPECT_LE(longest_, static_cast<Tick>(job.account.tick_clocks));
  // The longest way of all takes a mark at the end of a unit, together with a carry of the clock.
  EXPECT_GT(longest_, static_cast<Tick>(job.account.tick_clocks * 2 / 3));
  EXPECT_LE(used_, job.account.program_bytes + job.table.bytes.size());
  EXPECT_GT(used_ + 64, job.account.program_bytes + job.table.bytes.size());
  for (const unsigned axis : {0U, 1U}) expectFigure5(levelsOf(events, axis), job.account.target);
}
INSTANTIATE_TEST_SUITE_P(Parts, OwnJobOnEachChip, testing::Values("at89s52", "stc15f2k60s2"));

TEST_F(OwnJobOnChip, AStepForwardFromBothHighIsThePapersSequence) {
  const OwnJob job = test::makeSmallJob({});
  const std::vector<PinEvent> events = run(build(job), "at89s52", inputsFor(kFirstMark, 1), kUntil / 3);
  const auto text = [](const std::vector<Levels>& levels, std::size_t from) {
    std::string all;
    for (std::size_t i = from; i < from + 6; ++i)
      all += std::string("(") + (levels[i].pul ? "1" : "0") + "," + (levels[i].dir ? "1" : "0") + ")";
    return all;
  };
  int found = 0;
  for (const unsigned axis : {0U, 1U}) {
    const std::vector<Levels> levels = levelsOf(events, axis);
    for (std::size_t i = 0; i + 6 < levels.size(); ++i) {
      if (!levels[i].dir || levels[i + 1].dir) continue;
      EXPECT_EQ(text(levels, i), "(1,1)(1,0)(0,0)(1,0)(0,0)(1,0)");
      ++found;
    }
  }
  EXPECT_GE(found, 2);
}

TEST_F(OwnJobOnChip, IsWithinAStepOfTheTableAtTheEndOfEachPeriodAfterItsMark) {
  const OwnJob job = test::makeSmallJob({});
  const std::vector<PinEvent> events = run(build(job), "at89s52", inputsFor(kFirstMark), kUntil);
  const double tick = job.account.timer_counts * 12.0;
  std::array<Counter, 2> counters{Counter(stepsOf(levelsOf(events, 0))),
                                  Counter(stepsOf(levelsOf(events, 1)))};
  int worst = 0;
  for (const Shown& period : test::periodsIn(job.source, job.table)) {
    // A unit's way back is at rest on its last period when the next mark's unit begins.
    if (period.unit < 0 || period.power < 0) continue;
    const double end = markAt(period.unit) + (job.table.mark_ticks + 32.0 * period.since_mark) * tick;
    for (const int axis : {0, 1})
      worst = std::max(worst, std::abs(counters.at(std::size_t(axis)).before(end) - period.steps[axis]));
  }
  EXPECT_LE(worst, 1);
  for (Counter& counter : counters) EXPECT_EQ(counter.before(1e18), 0);
}

/// Clocks at which a pin of port 1 takes a level.
std::vector<Tick> takesLevel(const std::vector<PinEvent>& events, unsigned bit, bool level) {
  std::vector<Tick> ticks;
  for (const PinEvent& event : events) {
    if (event.port == 1 && (event.changed >> bit & 1) != 0 && ((event.level >> bit & 1) != 0) == level)
      ticks.push_back(event.tick);
  }
  return ticks;
}

TEST_F(OwnJobOnChip, TheGateOpensByTheMirrorsDelayAfterThePeriodWithinATick) {
  const OwnJob job = test::makeSmallJob({});
  const std::vector<PinEvent> events = run(build(job), "at89s52", inputsFor(kFirstMark), kUntil);
  const std::vector<Tick> opens = takesLevel(events, 4, false);
  const double tick = job.account.timer_counts * 12.0;
  std::vector<double> wanted;
  int power_before = -1;
  for (const Shown& period : test::periodsIn(job.source, job.table)) {
    if (period.power >= 0 && power_before < 0)
      wanted.push_back(markAt(period.unit) + (job.table.mark_ticks + 32.0 * (period.since_mark - 1)) * tick +
                       test::smallMachine().tracking_delay_s * kClock_hz);
    power_before = period.power;
  }
  ASSERT_EQ(opens.size(), wanted.size());
  ASSERT_GE(opens.size(), 3U);
  for (std::size_t i = 0; i < opens.size(); ++i)
    EXPECT_NEAR(static_cast<double>(opens[i]), wanted[i], tick) << i;
}

TEST_F(OwnJobOnChip, AnOpenGuardDarkensTheLaserWithinATickAndEndsThePulses) {
  const OwnJob job = test::makeSmallJob({});
  const std::vector<std::uint8_t> code = build(job);
  const std::vector<PinEvent> whole = run(code, "at89s52", inputsFor(kFirstMark, 1), kUntil / 2);
  const Tick opened = takesLevel(whole, 4, false).at(0) + 5'000'000;
  std::vector<Input> inputs = inputsFor(kFirstMark, 1);
  inputs.push_back({opened, 4, false});
  const std::vector<PinEvent> events = run(code, "at89s52", inputs, kUntil / 2);
  const std::vector<Tick> dark = takesLevel(events, 4, true);
  ASSERT_FALSE(dark.empty());
  const Tick tick_clocks = static_cast<Tick>(job.account.timer_counts) * 12;
  EXPECT_GE(dark.back(), opened);
  EXPECT_LE(dark.back(), opened + 2 * tick_clocks);
  EXPECT_LE(events.back().tick, opened + 2 * tick_clocks);
  EXPECT_GT(whole.back().tick, opened + 5'000'000);
}

TEST_F(OwnJobOnChip, AUnitWhoseTimeHasPassedIsNotCutLate) {
  const OwnJob job = test::makeSmallJob({});
  // The second mark comes 0.1 s after the first: its unit should begin before the first is done.
  std::vector<Input> inputs = inputsFor(kFirstMark, 1);
  inputs.push_back({kFirstMark + 2'400'000, 3, true});
  const std::vector<PinEvent> events = run(build(job), "at89s52", inputs, kUntil);
  EXPECT_EQ(takesLevel(events, 4, false).size(), 1U);
}

}  // namespace
}  // namespace kerfbench::planner
