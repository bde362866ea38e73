// SPDX-License-Identifier: Apache-2.0
#include "hil/run/provoke.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hil/controller/pulse_counter.h"
#include "hil/controller/uart_listener.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/controller/spoken_frames.h"

namespace kerfbench::run {
namespace {

using Cause = scenario::ProvokeChoice::Cause;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr TickRate kRate{1, 16'000'000};

scenario::ProvokeChoice at(Cause cause, double at_s) {
  scenario::ProvokeChoice choice;
  choice.cause = cause;
  choice.at_s = at_s;
  return choice;
}

std::vector<std::tuple<Tick, Signal, bool>> changed(const scenario::ProvokeChoice& choice,
                                                    std::vector<SensorEdge> edges, Tick from, Tick until) {
  Provocation(choice, kRate, 1).changeSensors(edges, from, until);
  std::vector<std::tuple<Tick, Signal, bool>> result;
  for (const SensorEdge& edge : edges) result.emplace_back(edge.tick, edge.signal, edge.level);
  return result;
}

std::string refusalOf(const std::string& section, bool belt_is_followed = true) {
  const base::TempFolder folder;
  const auto path = folder.write("provoke.yaml", "provoke: {" + section + "}\n");
  try {
    auto file = base::YamlReader::openFile(path);
    (void)scenario::readProvoke(file.section("provoke"), belt_is_followed);
    file.finish();
  } catch (const base::ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(ProvokeSection, OneCauseAndWhatBelongsToIt) {
  EXPECT_EQ(refusalOf("interlock_open_at_s: 1, interlock_open_for_s: 0.1"), "");
  EXPECT_EQ(refusalOf("encoder_lost_at_s: 1, encoder_lines: a"), "");
  EXPECT_EQ(refusalOf("uart_silent_at_s: 1, expect: watchdog"), "");
  EXPECT_THAT(refusalOf("interlock_open_at_s: 1, limit_hit_at_s: 2"), HasSubstr("one thing at a time"));
  EXPECT_THAT(refusalOf("limit_hit_at_s: 1, encoder_lines: a"), HasSubstr("not there"));
  EXPECT_THAT(refusalOf("expect: dry"), HasSubstr("not there"));
  EXPECT_THAT(refusalOf("uart_silent_at_s: 1, expect: boredom"), HasSubstr("boredom"));
  EXPECT_THAT(refusalOf("interlock_open_at_s: -1"), HasSubstr("interlock_open_at_s"));
  EXPECT_THAT(refusalOf("encoder_lost_at_s: 1", false), HasSubstr("line drives"));
  EXPECT_THAT(refusalOf("cat_on_the_belt_at_s: 1"), HasSubstr("unknown key"));
}

TEST(Provocation, TheGuardOpensForAWhile) {
  auto choice = at(Cause::kInterlock, 1e-3);
  choice.open_for_s = 1e-4;
  EXPECT_THAT(changed(choice, {{17000, Signal::kPrintMark, true}}, 8000, 24000),
              ElementsAre(std::tuple{Tick{16000}, Signal::kInterlock, false},
                          std::tuple{Tick{17000}, Signal::kPrintMark, true},
                          std::tuple{Tick{17600}, Signal::kInterlock, true}));
  EXPECT_THAT(changed(choice, {}, 16000, 17599), IsEmpty()) << "each edge once";
}

TEST(Provocation, ALimitStaysHitWhateverTheTwinSays) {
  EXPECT_THAT(changed(at(Cause::kLimit, 1e-3),
                      {{15000, Signal::kLimitX, true}, {17000, Signal::kLimitX, false}}, 8000, 24000),
              ElementsAre(std::tuple{Tick{15000}, Signal::kLimitX, true},
                          std::tuple{Tick{16000}, Signal::kLimitX, true}));
}

TEST(Provocation, BrokenWiresAreSilentFromThenOn) {
  const std::vector<SensorEdge> edges{
      {15999, Signal::kEncoderA, true}, {16000, Signal::kEncoderB, true}, {16001, Signal::kEncoderA, false}};
  auto choice = at(Cause::kEncoder, 1e-3);
  EXPECT_EQ(changed(choice, edges, 8000, 24000).size(), 1U);
  choice.encoder_lines = "b";
  EXPECT_THAT(changed(choice, edges, 8000, 24000),
              ElementsAre(std::tuple{Tick{15999}, Signal::kEncoderA, true},
                          std::tuple{Tick{16001}, Signal::kEncoderA, false}));
}

TEST(Provocation, ASilentHostIsCutOffWithinAFrame) {
  Provocation provocation(at(Cause::kUartSilent, 1.0), kRate, 1);
  EXPECT_THAT(provocation.toController({1, 2, 3, 4}, 0.9), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(provocation.toController({}, 1.0), IsEmpty());
  EXPECT_TRUE(std::isnan(provocation.lineCut_s()));
  EXPECT_THAT(provocation.toController({1, 2, 3, 4}, 1.1), ElementsAre(1, 2));
  EXPECT_THAT(provocation.toController({1, 2, 3, 4}, 1.2), IsEmpty());
  EXPECT_EQ(provocation.lineCut_s(), 1.1);
}

TEST(Provocation, AFlickeringSensorGivesAMarkEachMillisecond) {
  constexpr Tick kAt = 16'000'000;
  const auto edges = changed(at(Cause::kMarksFlicker, 1.0), {}, kAt + 15'999, kAt + 32'001);
  EXPECT_THAT(edges, ElementsAre(std::tuple(kAt + 16'000, Signal::kPrintMark, true),
                                 std::tuple(kAt + 24'000, Signal::kPrintMark, false),
                                 std::tuple(kAt + 32'000, Signal::kPrintMark, true)));
}

TEST(Provocation, NoiseDamagesTheShareAskedForAndAlwaysTheSame) {
  auto choice = at(Cause::kUartNoise, 1.0);
  choice.share = 0.25;
  const std::vector<std::uint8_t> zeros(10000, 0);
  Provocation one(choice, kRate, 7);
  Provocation other(choice, kRate, 7);
  const auto bytes = one.toController(zeros, 1.0);
  EXPECT_EQ(bytes, other.toController(zeros, 1.0));
  const auto damaged = std::ranges::count_if(bytes, [](std::uint8_t byte) { return byte != 0; });
  EXPECT_NEAR(static_cast<double>(damaged), 2500.0, 4 * std::sqrt(2500.0 * 0.75));
}

TEST(UartListener, HearsStatesBetweenOtherFramesAndRubbish) {
  controller::UartListener ear;
  std::vector<std::uint8_t> line = controller::spokenState(1, 0, 4);
  const auto event = controller::spokenFrame({0x85, 0, 2, 3, 2});
  line.insert(line.end(), {0xA5, 0x00, 0xFF, 0xA5, 0xA5});
  line.insert(line.end(), event.begin(), event.end());
  for (const std::uint8_t byte : line) ear.hear(std::vector{byte}, 1.0);
  EXPECT_FALSE(ear.account()) << "it runs";
  ear.hear(controller::spokenState(3, 2, 44), 2.0);
  ASSERT_TRUE(ear.account());
  EXPECT_EQ(ear.account()->first_belt.counts, 0x01020304);
  EXPECT_EQ(ear.account()->belt.counts, 0x0102032C);
  EXPECT_EQ(ear.account()->belt.time_s, 2.0);
  EXPECT_THAT(ear.account()->steps, ElementsAre(0, 1, 2, 3, 4));
  ASSERT_EQ(ear.reports().size(), 2U);
  EXPECT_EQ(ear.reports()[1].fault, "interlock");
  EXPECT_TRUE(ear.reports()[1].stopped);
}

TEST(UartListener, DamagedFramesAreNotHeard) {
  controller::UartListener ear;
  auto line = controller::spokenState(3, 2, 0);
  line[6] ^= 1;
  ear.hear(line, 1.0);
  EXPECT_FALSE(ear.account());
  EXPECT_TRUE(ear.reports().empty());
}

TEST(PulseCounter, PulsesCountWithTheirSenseAndTheBeltWithItsOwn) {
  SignalMap map;
  map.assign(Signal::kGalvoXPul, {0, 0});
  map.assign(Signal::kGalvoXDir, {0, 1});
  map.assign(Signal::kEncoderA, {3, 2});
  map.assign(Signal::kEncoderB, {3, 1});
  source::PinRecording recording;
  recording.rate = kRate;
  Tick tick = 0;
  const auto pulse = [&](bool forwards) {
    const auto dir = static_cast<std::uint16_t>(forwards ? 2 : 0);
    recording.outputs.push_back({tick += 1000, 0, 3, static_cast<std::uint16_t>(dir | 1), 0});
    recording.outputs.push_back({tick += 1000, 0, 1, dir, 0});
  };
  for (int i = 0; i < 7; ++i) pulse(true);
  for (int i = 0; i < 3; ++i) pulse(false);
  // The belt makes 1000 counts a second forwards, then ten back.
  const auto belt = [&](int phase, double time_s) {
    const bool a = phase == 1 || phase == 2;
    const bool a_changes = phase == 1 || phase == 3;
    recording.sensors.push_back({kRate.ticksAt(time_s), a_changes ? Signal::kEncoderA : Signal::kEncoderB,
                                 a_changes ? a : phase == 2});
  };
  for (int i = 1; i <= 1000; ++i) belt(i % 4, 1e-3 * i);
  const controller::PulseCounter sums(recording, map);
  EXPECT_EQ(sums.lastPulse_s(), kRate.seconds(19000));
  EXPECT_EQ(sums.pulse_s(Signal::kGalvoXPul, 2), kRate.seconds(3000));
  EXPECT_TRUE(std::isnan(sums.pulse_s(Signal::kGalvoXPul, 11)));
  EXPECT_TRUE(std::isnan(sums.leaves_s(Signal::kGalvoXPul, 0, 7)));
  EXPECT_EQ(sums.leaves_s(Signal::kGalvoXPul, 0, 6), sums.pulse_s(Signal::kGalvoXPul, 7));
  EXPECT_EQ(sums.leaves_s(Signal::kGalvoXPul, 5, 7), sums.pulse_s(Signal::kGalvoXPul, 1));
  EXPECT_TRUE(std::isnan(sums.beltFaster_s(1050.0, 0.04)));
  EXPECT_LT(sums.beltFaster_s(950.0, 0.04), 0.1);
  controller::UartListener::Account told{{0.1, 90}, {0.9, 888}, {4, 0, 0, 0, 0}};
  const auto account = sums.compareWithReport(told, {250e3, 0.0});
  ASSERT_EQ(account.axes.size(), 1U) << "what is wired";
  EXPECT_EQ(account.axes[0].name, "galvo_x");
  EXPECT_EQ(account.axes[0].seen, 4);
  const controller::DriveOfPul low{Signal::kGalvoXPul, {.name = "", .dir_low = true}};
  EXPECT_EQ(
      controller::PulseCounter(recording, map, {&low, 1}).compareWithReport(told, {250e3, 0.0}).axes[0].seen,
      -4);
  ASSERT_TRUE(account.belt);
  EXPECT_EQ(account.belt->told, 798);
  EXPECT_EQ(account.belt->seen_min, 800 - 3);  // The controller can have read its belt within 3.64 ms.
  EXPECT_EQ(account.belt->seen_max, 800 + 3);
  // Read up to 16 ms late, it may have looked so much earlier.
  const auto late = sums.compareWithReport(told, {250e3, 16e-3});
  EXPECT_EQ(late.belt->seen_min, 800 - 3 - 16);
  EXPECT_EQ(late.belt->seen_max, 800 + 3 + 16);
  EXPECT_FALSE(sums.compareWithReport(std::nullopt, {250e3, 0.0}).told);
}

}  // namespace
}  // namespace kerfbench::run
