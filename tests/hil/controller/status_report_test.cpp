// SPDX-License-Identifier: Apache-2.0
#include "hil/controller/status_report.h"

#include <gtest/gtest.h>

namespace kerfbench::controller {
namespace {

source::PinRecording saying(const std::vector<std::string>& words) {
  source::PinRecording recording;
  recording.rate = {1, 1'000'000};
  Tick tick = 0;
  for (const std::string& part : words) recording.uart.push_back({tick += 1000, {part.begin(), part.end()}});
  return recording;
}

std::optional<StatusReport> lastOf(const std::vector<std::string>& words) {
  return statusWords(saying(words)).last;
}

TEST(StatusReport, TheLastWholeOneCounts) {
  const auto report = lastOf({"ok\r\n<Run|MPos:1.000,2.000,0.000|FS:500,0>\r\nok\r\n<Idle|MP",
                              "os:40.000,-12.345,0.000|FS:0,0|WCO:0.000,0.000,0.000>\r\n<Idle|MPos:1."});
  ASSERT_TRUE(report);
  EXPECT_EQ(report->state, "Idle");
  EXPECT_DOUBLE_EQ(report->machine_place[0], 40.0);
  EXPECT_DOUBLE_EQ(report->machine_place[1], -12.345);
  EXPECT_DOUBLE_EQ(report->resolution, 0.001);
}

TEST(StatusReport, GrblBeforeOneDotOneSaysItWithCommas) {
  const auto report = lastOf({"<Idle,MPos:5.529,0.560,7.000,WPos:1.529,-5.440,-0.000>\r\n"});
  ASSERT_TRUE(report);
  EXPECT_DOUBLE_EQ(report->machine_place[0], 5.529);
}

TEST(StatusReport, OneWithoutAMachinesPlaceIsNone) {
  EXPECT_FALSE(lastOf({"<Idle>\r\n<Idle|WPos:1.000,2.000,0.000>\r\n", "<Idle|MPos:nan,inf,0>\r\n"}));
  EXPECT_FALSE(lastOf({}));
}

/// 1000 steps of x forwards and 250 of y backwards.
PulseCounter pins() {
  SignalMap map;
  map.assign(Signal::kGantryXPul, {0, 0});
  map.assign(Signal::kGantryXDir, {0, 1});
  map.assign(Signal::kGantryYPul, {0, 2});
  map.assign(Signal::kGantryYDir, {0, 3});
  source::PinRecording recording = saying({});
  Tick tick = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto pulses = static_cast<std::uint16_t>(1U | (i < 250 ? 4U : 0U));
    recording.outputs.push_back({tick += 100, 0, static_cast<std::uint16_t>(pulses | (i == 0 ? 2U : 0U)),
                                 static_cast<std::uint16_t>(pulses | 2U), 0});
    recording.outputs.push_back({tick += 100, 0, pulses, 2, 0});
  }
  return {recording, map};
}

inspect::ControllerAccount accountOf(double x, double y, double resolution = 0.001) {
  return compareWithStatus({"Idle", {x, y}, resolution, 0}, pins(),
                           {{{Signal::kGantryXPul, 0.0125}, {Signal::kGantryYPul, 0.0125}}});
}

TEST(StatusReport, ThatAgreesWithThePulsesTellsTheirNumber) {
  const auto account = accountOf(12.5, -3.125);
  EXPECT_TRUE(account.told);
  ASSERT_EQ(account.axes.size(), 2U);
  EXPECT_EQ(account.axes[0].name, "gantry_x");
  EXPECT_EQ(account.axes[0].told, 1000);
  EXPECT_EQ(account.axes[0].seen, 1000);
  EXPECT_EQ(account.axes[1].told, -250);
  EXPECT_EQ(account.axes[1].seen, -250);
  // In inches, rounded to their last digit.
  EXPECT_EQ(accountOf(0.4921, -0.1230, 0.0001).axes[0].told, 1000);
}

TEST(StatusReport, ThatIsAStepOrAScaleOffTellsItsOwnNumber) {
  EXPECT_EQ(accountOf(12.5125, -3.125).axes[0].told, 1001);
  EXPECT_EQ(accountOf(12.475, -3.125).axes[0].told, 998);
  EXPECT_EQ(accountOf(12.5, 3.125).axes[1].told, 250);
}

TEST(StatusReport, NearZeroAPlaceInMmIsNotReadAsInches) {
  SignalMap map;
  map.assign(Signal::kGantryXPul, {0, 0});
  map.assign(Signal::kGantryXDir, {0, 1});
  source::PinRecording recording = saying({});
  Tick tick = 0;
  for (int i = 0; i < 6; ++i) {
    recording.outputs.push_back({tick += 100, 0, static_cast<std::uint16_t>(i == 0 ? 3 : 1), 3, 0});
    recording.outputs.push_back({tick += 100, 0, 1, 2, 0});
  }
  const auto account = compareWithStatus({"Idle", {0.0, 0.0}, 0.001, 0}, PulseCounter(recording, map),
                                         {{{Signal::kGantryXPul, 0.004}, {Signal::kGantryYPul, 0.004}}});
  ASSERT_EQ(account.axes.size(), 1U);
  EXPECT_EQ(account.axes[0].seen, 6);
  EXPECT_EQ(account.axes[0].told, 0);
}

TEST(StatusReport, AnyAmountOfWordsIsRead) {
  // A report that lost its end, and then 200 kB without another.
  std::string words = "ok\n<Idle|MPos:1.0\n<Idle|MPos:2.000,3.000,0.000>\n<Run|MPos:4.0";
  for (int i = 0; i < 60'000; ++i) words += "ok\r\n";
  words += std::string(1'000'000, '<');
  const StatusWords found = statusWords(saying({"boot\n", words}));
  ASSERT_TRUE(found.last);
  EXPECT_DOUBLE_EQ(found.last->machine_place[1], 3.0);
  EXPECT_EQ(found.first_ok, Tick{2000});
}

TEST(StatusReport, AnAxisWithoutItsLinesIsLeftOut) {
  const auto account = compareWithStatus({"Idle", {1, 2}, 0.001, 0}, pins(),
                                         {{{Signal::kGalvoXPul, 0.01}, {Signal::kGantryYPul, 0.0125}}});
  ASSERT_EQ(account.axes.size(), 1U);
  EXPECT_EQ(account.axes[0].name, "gantry_y");
}

}  // namespace
}  // namespace kerfbench::controller
