// SPDX-License-Identifier: Apache-2.0
// The bench's reader of pins on the kernel's real GPIO, with the kernel's simulated chip. Time is the
// guest's: a count of instructions, so waiting and rates are the same in every run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hil/source/gpio/capture.h"
#include "hil/source/gpio/chips.h"
#include "hil/source/gpio/edge_order.h"
#include "hil/source/gpio/line_request.h"
#include "hil/source/gpio/real_time.h"
#include "tests/guest/held_line.h"
#include "tests/guest/player.h"
#include "tests/guest/sim_chip.h"
#include "tests/guest/watched_system.h"

namespace kerfbench::guest {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint32_t kPul = 0;
constexpr std::uint32_t kDir = 1;
constexpr std::uint32_t kGate = 2;

/// Pulses of half_ns high and low under an open gate, with a turn after every 50, DIR half_ns before the
/// pulse.
std::vector<Stroke> pulses(std::size_t count, std::uint64_t half_ns) {
  std::vector<Stroke> strokes{{0, kGate, true}};
  std::uint64_t at_ns = 0;
  bool dir = false;
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 50 == 49) strokes.push_back({at_ns += half_ns, kDir, dir = !dir});
    strokes.push_back({at_ns += half_ns, kPul, true});
    strokes.push_back({at_ns += half_ns, kPul, false});
  }
  strokes.push_back({at_ns + half_ns, kGate, false});
  if (dir) strokes.push_back({at_ns + 2 * half_ns, kDir, false});
  return strokes;
}

class PinsTest : public testing::Test {
 protected:
  PinsTest() {
    for (const auto& [signal, line] :
         {std::pair{Signal::kGalvoXPul, kPul}, std::pair{Signal::kGalvoXDir, kDir},
          std::pair{Signal::kLaserGate, kGate}}) {
      map.assign(signal, {0, static_cast<std::uint16_t>(line)});
      options.wires.push_back({signal, line});
    }
    options.chip = chip.device();
    options.stamp_err_s = 10e-6;
    options.quiet_s = 0.2;
    options.time_limit_s = 30.0;
  }
  source::PinCapture capture(const std::shared_ptr<source::GpioSystem>& system = source::linuxGpioSystem()) {
    return source::capturePins(options, map, system);
  }
  /// Line and level of each edge of a recording, in its order.
  static std::vector<std::pair<std::uint32_t, bool>> edgesOf(const source::PinCapture& captured) {
    std::vector<std::pair<std::uint32_t, bool>> edges;
    for (const PinEvent& event : captured.recording.outputs) {
      for (std::uint32_t line = 0; line < 3; ++line) {
        if ((event.changed >> line & 1U) != 0) edges.emplace_back(line, (event.level >> line & 1U) != 0);
      }
    }
    return edges;
  }
  static std::vector<std::pair<std::uint32_t, bool>> edgesOf(const std::vector<Stroke>& strokes) {
    std::vector<std::pair<std::uint32_t, bool>> edges;
    for (const Stroke& stroke : strokes) edges.emplace_back(stroke.line, stroke.level);
    return edges;
  }
  static bool hasGap(const source::PinCapture& captured) {
    return std::ranges::any_of(captured.recording.outputs,
                               [](const PinEvent& event) { return (event.flags & PinEvent::kGap) != 0; });
  }
  /// Expects a problem of these words, and a gap that a replay of the recording finds.
  static void expectInvalid(const source::PinCapture& captured, const std::string& words) {
    EXPECT_THAT(captured.recording.problems, Contains(HasSubstr(words)));
    EXPECT_TRUE(hasGap(captured));
  }

  SimChip chip{"kerfbench-test", {"PUL", "DIR", "GATE", "", "spare"}};
  SignalMap map;
  source::GpioCaptureOptions options;
};

TEST_F(PinsTest, ListsWhatConfigfsMade) {
  const SimChip other("second-chip", {"", "A"});
  const source::GpioChipList list = source::listChips();
  EXPECT_THAT(list.faults, IsEmpty());
  for (const SimChip* made : std::initializer_list<const SimChip*>{&chip, &other}) {
    const source::GpioChipInfo& found = source::findChip(list, made->label());
    EXPECT_EQ(found.path, made->device());
    std::vector<std::string> names;
    for (const source::GpioLineInfo& line : found.lines) {
      names.push_back(line.name);
      EXPECT_FALSE(line.used);
      EXPECT_FALSE(line.output);
    }
    EXPECT_EQ(names, made->lineNames());
    EXPECT_EQ(source::edgeTrouble(*source::linuxGpioSystem(), made->device()), "");
  }
}

TEST_F(PinsTest, TenThousandEdgesASecondAreReadOneByOneAndInOrder) {
  const std::vector<Stroke> strokes = pulses(10'000, 90'000);
  Player player(chip, strokes);
  const source::PinCapture captured = capture();
  const Played played = player.join();
  EXPECT_GE(played.rate_hz(strokes.size()), 10'000.0);
  EXPECT_THAT(captured.recording.problems, IsEmpty());
  EXPECT_THAT(captured.notes, IsEmpty());
  EXPECT_EQ(captured.edges, strokes.size());
  EXPECT_FALSE(hasGap(captured));
  EXPECT_EQ(edgesOf(captured), edgesOf(strokes));
}

TEST_F(PinsTest, StampsAreThoseOfTheWire) {
  const std::vector<Stroke> strokes = pulses(500, 200'000);
  Player player(chip, strokes);
  const source::PinCapture captured = capture();
  const Played played = player.join();
  const std::vector<PinEvent> events = captured.recording.outputs.unpacked();
  ASSERT_EQ(events.size(), strokes.size());
  std::vector<double> off_us;
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    const auto stamped_ns = static_cast<double>(events[i].tick - events.front().tick);
    const auto pulled_ns = static_cast<double>(played.pulled_ns[i] - played.pulled_ns.front());
    off_us.push_back(1e-3 * std::abs(stamped_ns - pulled_ns));
  }
  std::ranges::sort(off_us);
  EXPECT_LT(off_us[off_us.size() * 95 / 100], 5.0);
  // Ticks of the kernel's clock come in between, some 12 us each and sometimes several. Edges are 200 us
  // apart: beyond half of that a stamp would belong to the next one.
  EXPECT_LT(off_us.back(), 100.0);
}

TEST_F(PinsTest, AReaderThatStallsKeepsWhatTheKernelBuffers) {
  const std::vector<Stroke> strokes = pulses(450, 100'000);
  ASSERT_LT(strokes.size(), source::kEventBuffer);
  Player player(chip, strokes);
  const source::PinCapture captured = capture(std::make_shared<WatchedSystem>([&] { player.join(); }));
  EXPECT_EQ(captured.edges, strokes.size());
  EXPECT_EQ(edgesOf(captured), edgesOf(strokes));
}

TEST_F(PinsTest, AReaderThatStallsTooLongIsNoticed) {
  const std::vector<Stroke> strokes = pulses(1'000, 100'000);
  Player player(chip, strokes);
  const source::PinCapture captured = capture(std::make_shared<WatchedSystem>([&] { player.join(); }));
  EXPECT_EQ(captured.edges, source::kEventBuffer);
  expectInvalid(captured, fmt::format("{} edges lost because the kernel's buffer was full",
                                      strokes.size() - source::kEventBuffer));
}

TEST_F(PinsTest, EdgesThatTheKernelMergesAreNoticed) {
  // A player above the interrupt threads: three edges of PUL before any of them is looked at.
  std::vector<Stroke> strokes = pulses(20, 100'000);
  const std::uint64_t after_ns = strokes.back().at_ns + 1'000'000;
  for (const bool level : {true, false, true}) strokes.push_back({after_ns, kPul, level});
  strokes.push_back({after_ns + 1'000'000, kPul, false});
  Player player(chip, strokes, {.real_time_priority = 60});
  const source::PinCapture captured = capture();
  player.join();
  EXPECT_LT(captured.edges, strokes.size());
  expectInvalid(captured, "came faster than its interrupt thread takes them");
}

TEST_F(PinsTest, TwoEdgesThatBecomeOneAreNoticed) {
  std::vector<Stroke> strokes = pulses(20, 100'000);
  const std::uint64_t after_ns = strokes.back().at_ns + 1'000'000;
  for (const bool level : {true, false}) strokes.push_back({after_ns, kPul, level});
  Player player(chip, strokes, {.real_time_priority = 60});
  const source::PinCapture captured = capture();
  player.join();
  EXPECT_EQ(captured.edges, strokes.size() - 1);
  expectInvalid(captured, "1 edge to a level that the line had already");
}

TEST_F(PinsTest, EdgesOfTwoLinesThatTheKernelTellsInTheWrongOrderArePutRight) {
  std::vector<Stroke> strokes;
  for (std::uint64_t i = 1; i <= 50; ++i) {
    const std::uint64_t at_ns = i * 1'000'000;
    const bool high = i % 2 != 0;
    strokes.push_back({at_ns, kDir, high});
    strokes.push_back({at_ns + 5'000, kPul, true});
    strokes.push_back({at_ns + 500'000, kPul, false});
  }
  // The thread that serves PUL goes first; both have edges to serve when the player rests.
  const auto preferPul = [] { setRealTime(interruptThreads().at(kPul), 55); };
  Player player(chip, strokes, {.real_time_priority = 60, .before = preferPul});
  const auto system = std::make_shared<WatchedSystem>();
  const source::PinCapture captured = capture(system);
  player.join();
  EXPECT_FALSE(std::ranges::is_sorted(system->numbers())) << "the kernel was to tell PUL before DIR";
  EXPECT_THAT(captured.recording.problems, IsEmpty());
  EXPECT_FALSE(hasGap(captured));
  EXPECT_EQ(edgesOf(captured), edgesOf(strokes));
}

TEST_F(PinsTest, RatesThatOneProcessorHolds) {
  fmt::print(
      "| asked for, edges/s | played, edges/s | edges | lost | worst delay from stamp to read, µs |\n");
  fmt::print("|---|---|---|---|---|\n");
  for (const std::uint64_t half_ns : {500'000U, 100'000U, 50'000U, 1U}) {
    const std::vector<Stroke> strokes = pulses(3'000, half_ns);
    Player player(chip, strokes);
    const auto system = std::make_shared<WatchedSystem>();
    const source::PinCapture captured = capture(system);
    const Played played = player.join();
    EXPECT_THAT(captured.recording.problems, IsEmpty());
    fmt::print("| {} | {:.0f} | {} | {} | {:.0f} |\n",
               half_ns == 1 ? "as many as go" : std::to_string(1'000'000'000 / half_ns),
               played.rate_hz(strokes.size()), strokes.size(), strokes.size() - captured.edges,
               1e-3 * static_cast<double>(system->worstDelay_ns()));
  }
}

TEST_F(PinsTest, ALineThatAnotherProgramHasIsNamedWithItsUser) {
  const HeldLine held(chip.device(), kDir, "spi0 CS1");
  EXPECT_EQ(source::readChip(chip.device()).lines.at(kDir).consumer, "spi0 CS1");
  try {
    capture();
    ADD_FAILURE() << "a line was shared";
  } catch (const source::GpioError& error) {
    EXPECT_THAT(error.what(), HasSubstr("line 1 for galvo_x_dir is taken by 'spi0 CS1'"));
  }
}

TEST_F(PinsTest, AControllerThatSaysNothingIsNoticed) {
  options.time_limit_s = 0.5;
  expectInvalid(capture(), "no edge came within 0.5 s");
}

TEST_F(PinsTest, AUserWithoutPermissionIsToldWhatToDo) {
  constexpr uid_t kNobody = 65534;
  ASSERT_EQ(::seteuid(kNobody), 0);
  const std::string opened = source::edgeTrouble(*source::linuxGpioSystem(), chip.device());
  const std::vector<std::string> notes = source::RealTime(source::linuxGpioSystem()).notes();
  ASSERT_EQ(::seteuid(0), 0);
  EXPECT_THAT(opened, HasSubstr("not allowed; as a rule in /etc/udev/rules.d/60-gpio.rules put"));
  EXPECT_THAT(notes, Contains(HasSubstr("no real-time priority")));
}

// This test is the last: this kernel complains of the chip's lines still being in use, and leaks them.
TEST_F(PinsTest, AChipThatVanishesWhileItsLinesAreReadIsNoticed) {
  const std::vector<Stroke> strokes = pulses(100, 100'000);
  Player player(chip, strokes);
  std::jthread thief([&] {
    player.join();
    chip.vanish();
  });
  const source::PinCapture captured = capture();
  EXPECT_EQ(edgesOf(captured), edgesOf(strokes));
  expectInvalid(captured, "the chip has gone while its lines were read");
}

}  // namespace
}  // namespace kerfbench::guest
