// SPDX-License-Identifier: Apache-2.0
// The pins around the moment of a check, and the line of the program.
#include "hil/judge/moments.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kerfbench::judge {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr Tick kMs = 16'000;  // Ticks of a clock of 16 MHz.

SignalMap wires() {
  SignalMap map;
  map.assign(Signal::kGalvoXPul, {0, 0});
  map.assign(Signal::kGalvoXDir, {0, 1});
  map.assign(Signal::kLaserGate, {0, 2});
  map.assign(Signal::kGantryXPul, {0, 3});
  map.assign(Signal::kEncoderA, {1, 0});
  map.assign(Signal::kLimitX, {1, 1});
  return map;
}

/// A gate that opens at 3 ms and closes at 22 ms, a pulse each millisecond from 1 ms on.
source::PinRecording recording() {
  source::PinRecording r;
  std::uint16_t level = 0;
  const auto write = [&](Tick tick, std::uint16_t bit, bool high) {
    const auto mask = static_cast<std::uint16_t>(1U << bit);
    const auto next = static_cast<std::uint16_t>(high ? level | mask : level & ~mask);
    r.outputs.push_back({tick, 0, static_cast<std::uint16_t>(next ^ level), next, PinEvent::kNone});
    level = next;
  };
  for (Tick ms = 1; ms < 30; ++ms) {
    if (ms == 3) write(ms * kMs, 2, true);
    if (ms == 22) write(ms * kMs, 2, false);
    write(ms * kMs + 100, 0, true);
    write(ms * kMs + 200, 0, false);
  }
  r.sensors.push_back({2 * kMs, Signal::kEncoderA, true});
  r.sensors.push_back({21 * kMs, Signal::kEncoderA, false});
  r.end = 30 * kMs;
  return r;
}

inspect::Check failing(const std::string& name, double time_s) {
  inspect::Check check{.name = name};
  check.verdict = inspect::Verdict::kFail;
  check.where.time = inspect::Whereabouts::Time::kPins;
  check.where.time_s = time_s;
  return check;
}

const report::PinTrace* traceOf(const report::Moment& moment, const std::string& name) {
  const auto found = std::ranges::find(moment.pins, name, &report::PinTrace::name);
  return found == moment.pins.end() ? nullptr : &*found;
}

TEST(Moments, ShowEachPinFromItsLevelAtTheBeginOfTheSpan) {
  report::RunReport report;
  report.result.checks = {failing("gate_lag", 0.020)};
  addMoments(recording(), wires(), "", report);
  ASSERT_EQ(report.moments.size(), 1U);
  const report::Moment& moment = report.moments[0];
  EXPECT_DOUBLE_EQ(moment.from_s, 0.015);
  EXPECT_DOUBLE_EQ(moment.to_s, 0.025);
  const report::PinTrace* gate = traceOf(moment, "laser_gate");
  ASSERT_NE(gate, nullptr);
  EXPECT_TRUE(gate->level);  // The gate opened long before.
  EXPECT_THAT(gate->toggle_s, ElementsAre(DoubleNear(0.022, 1e-12)));
  const report::PinTrace* pul = traceOf(moment, "galvo_x_pul");
  ASSERT_NE(pul, nullptr);
  EXPECT_FALSE(pul->level);
  EXPECT_EQ(pul->toggle_s.size(), 20U);  // Ten pulses, from 15 to 24 ms.
  const report::PinTrace* encoder = traceOf(moment, "encoder_a");
  ASSERT_NE(encoder, nullptr);
  EXPECT_TRUE(encoder->level);
  EXPECT_EQ(encoder->toggle_s.size(), 1U);
}

TEST(Moments, LeaveOutWhatNeverMoves) {
  report::RunReport report;
  report.result.checks = {failing("gate_lag", 0.020)};
  addMoments(recording(), wires(), "", report);
  EXPECT_EQ(traceOf(report.moments[0], "gantry_x_pul"), nullptr);
  EXPECT_EQ(traceOf(report.moments[0], "limit_x"), nullptr);
}

TEST(Moments, EndWithTheRecordingAndAreSharedByChecksOfOneTime) {
  report::RunReport report;
  report.result.checks = {failing("path", 0.028), failing("joints", 0.02805), failing("stray", 0.001),
                          failing("coverage", 7.0), failing("account", std::nan(""))};
  report.result.checks.push_back(failing("repeat", 0.012));
  report.result.checks.back().verdict = inspect::Verdict::kPass;
  addMoments(recording(), wires(), "", report);
  ASSERT_EQ(report.moments.size(), 2U);
  EXPECT_THAT(report.moments[0].checks, ElementsAre("stray"));
  EXPECT_DOUBLE_EQ(report.moments[0].from_s, 0.0);
  EXPECT_THAT(report.moments[1].checks, ElementsAre("path", "joints"));
  EXPECT_DOUBLE_EQ(report.moments[1].to_s, 0.030);
}

TEST(Moments, OfARunThatPassesAreNone) {
  report::RunReport report;
  report.result.checks = {failing("path", 0.02)};
  report.result.checks[0].verdict = inspect::Verdict::kPass;
  addMoments(recording(), wires(), "", report);
  EXPECT_THAT(report.moments, IsEmpty());
}

/// A cut along E4 and then E5, a frame each millisecond.
inspect::CutResult cut() {
  inspect::CutResult cut;
  cut.unit = 1;
  for (int i = 0; i < 6; ++i) cut.track.push_back({0.018 + 1e-3 * i, 4, {2.0 * i, 0.01}, 0.0});
  for (int i = 1; i < 6; ++i) cut.track.push_back({0.023 + 1e-3 * i, 5, {10.0, 2.0 * i}, 0.0});
  return cut;
}

const std::string kProgram =
    "G21\nG00 X0.0000 Y0.0000 (E4 cut)\nG01 X10.0000 Y0.0000 Z1 (E4 cut)\nG01 X10.0000 Y10.0000 Z1 (E5 "
    "cut)\n";

TEST(Moments, NameTheLineOfTheProgramUnderWay) {
  report::RunReport report;
  report.result.checks = {failing("path", 0.020)};
  report.result.cuts = {cut()};
  addMoments(recording(), wires(), kProgram, report);
  const auto& followed = report.moments.at(0).followed;
  ASSERT_EQ(followed.size(), 2U);
  EXPECT_EQ(followed[0].unit, 1);
  EXPECT_EQ(followed[0].entity, 4);
  EXPECT_EQ(followed[0].line, 3);
  EXPECT_EQ(followed[1].entity, 5);
  EXPECT_EQ(followed[1].line, 4);
  EXPECT_DOUBLE_EQ(followed[0].to_s, followed[1].from_s);
  ASSERT_TRUE(report.program.contains(3));
  EXPECT_EQ(report.program.at(3), "G01 X10.0000 Y0.0000 Z1 (E4 cut)");
  EXPECT_FALSE(report.program.contains(2));
}

TEST(Moments, KnowNoLineWhereThePlaceIsOnNone) {
  report::RunReport report;
  report.result.checks = {failing("path", 0.020)};
  report.result.cuts = {cut()};
  for (inspect::CutFrame& frame : report.result.cuts[0].track) frame.p_S_mm.y() += 40.0;
  addMoments(recording(), wires(), kProgram, report);
  for (const inspect::CutFrame& frame : report.result.cuts[0].track) EXPECT_EQ(frame.program_line, 0);
  EXPECT_THAT(report.program, IsEmpty());
}

TEST(SafeTimelines, HaveWhatCameAndByWhenItWasDue) {
  inspect::SafeStateEvidence evidence;
  evidence.demand = {"the guard was opened", 4.0, 0.002, 0.0064, 0.05, {"interlock"}};
  evidence.gates = {{3.0, 3.5}, {3.9, 4.0015}};
  evidence.last_pulse_s = 4.005;
  evidence.reports = {{3.0, true, "uart"},
                      {3.999, true, "interlock"}};  // Inferred a little before the bench.
  const report::SafeTimeline safe = safeTimeline(evidence);
  EXPECT_DOUBLE_EQ(safe.gate_off_s, 4.0015);
  EXPECT_DOUBLE_EQ(safe.laser_due_s, 4.0 + 0.002 + inspect::kLaserOff_s);
  EXPECT_DOUBLE_EQ(safe.axes_due_s, safe.laser_due_s + 0.0064);
  EXPECT_EQ(safe.word, "interlock");
  EXPECT_DOUBLE_EQ(safe.word_s, 3.999);
  evidence.reports.clear();
  evidence.gates.clear();
  evidence.last_pulse_s = -1.0;
  const report::SafeTimeline nothing = safeTimeline(evidence);
  EXPECT_TRUE(std::isnan(nothing.gate_off_s) && std::isnan(nothing.last_pulse_s) &&
              std::isnan(nothing.word_s));
}

}  // namespace
}  // namespace kerfbench::judge
