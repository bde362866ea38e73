// SPDX-License-Identifier: Apache-2.0
#include "hil/run/lockstep.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "hil/machine_file/machine_file.h"
#include "hil/run/twin_model.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::run {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr Tick kQuantum = 8000;
constexpr TickRate kRate{1, 16'000'000};

// A scripted controller: its events, and its end.
class ScriptedSource : public source::SignalSource {
 public:
  std::vector<PinEvent> events;
  Tick stop_at{~Tick{0}};
  source::Stop stop{source::Stop::kReached};
  bool accepts_input{true};
  Tick heard_behind{};  // Watermark of the last advance.

  std::vector<Tick> advanced;                        // Watermarks of the advances.
  std::vector<std::pair<Tick, std::size_t>> driven;  // Ticks of the driven edges, and quanta run before.
  std::vector<std::uint8_t> written;
  std::vector<std::pair<Tick, Tick>> foreseen;  // Steps and ends of what was promised.

  [[nodiscard]] source::SourceInfo info() const override { return {kRate, 0, true, accepts_input, "script"}; }
  source::Stop advance(Tick until, source::Batch& batch) override {
    batch = {};
    const Tick from = advanced.empty() ? 0 : advanced.back();
    batch.watermark = std::min(until, stop_at);
    batch.uart_received = batch.watermark + heard_behind;
    for (const PinEvent& e : events) {
      if (e.tick > from && e.tick <= batch.watermark) batch.events.push_back(e);
    }
    advanced.push_back(batch.watermark);
    return until >= stop_at ? stop : source::Stop::kReached;
  }
  void foresee(Tick step, Tick until) override { foreseen.emplace_back(step, until); }
  void drive(PinId, bool, Tick at) override { driven.emplace_back(at, advanced.size()); }
  void uartWrite(std::span<const std::uint8_t> bytes) override {
    written.insert(written.end(), bytes.begin(), bytes.end());
  }
  [[nodiscard]] std::string message() const override { return "the script says so"; }
};

// A dialog that ends at a given time.
class ScriptedDialog : public Dialog {
 public:
  ScriptedDialog(double end_s, State end, double quiet_s = 0.0)
      : end_s_(end_s), end_(end), quiet_s_(quiet_s) {}
  std::vector<std::uint8_t> step(std::span<const std::uint8_t>, double now_s) override {
    ++steps;
    if (now_s >= end_s_ - 1e-12) state_ = end_;
    return steps == 1 ? std::vector<std::uint8_t>{1, 2, 3} : std::vector<std::uint8_t>{};
  }
  [[nodiscard]] State state() const override { return state_; }
  [[nodiscard]] std::string message() const override { return "talking"; }
  [[nodiscard]] double quiet_s() const override { return quiet_s_; }
  int steps{0};

 private:
  double end_s_;
  State end_;
  double quiet_s_;
  State state_{State::kBusy};
};

class Lockstep : public testing::Test {
 protected:
  RecordedRun run(Dialog* talk) { return runLockstep(source, model, machine.signals, talk, options, {}); }
  twin::MachineDescription machine = machine_file::readMachine(base::fixture("machines/two-mirror.yaml"));
  const twin::WebDescription web = [] {
    twin::WebDescription result;
    result.print.pitch_mm = 70;
    result.start_x_mm = -200;
    result.belt_speed_mm_s = 60;
    return result;
  }();
  twin::Twin twin{machine, web, kRate};
  TwinModel model{twin};
  ScriptedSource source;
  ScriptedDialog dialog{0.02, Dialog::State::kDone};
  LockstepOptions options{.quantum_s = 0.5e-3, .time_limit_s = 1.0, .settle_s = 0.01};
};

TEST_F(Lockstep, SensorsOfAQuantumAreSentBeforeItRuns) {
  const auto result = run(&dialog);
  EXPECT_THAT(result.problems, IsEmpty());
  ASSERT_GT(source.driven.size(), 150U);  // 0.03 s at 60 mm/s and 0.01 mm.
  for (const auto& [tick, quanta_before] : source.driven) {
    EXPECT_GT(tick, quanta_before * kQuantum);
    EXPECT_LE(tick, (quanta_before + 1) * kQuantum);
  }
  EXPECT_TRUE(std::ranges::is_sorted(source.driven));
  // Lines of the sensors are low from the start, whatever pull-ups the controller has.
  const auto at_start = std::ranges::count(source.driven, std::pair{Tick{1}, std::size_t{0}});
  EXPECT_EQ(at_start, 6 + 1) << "six low, and the guard, which is closed";
  EXPECT_EQ(result.recording.sensors.size(), source.driven.size() - 6);
}

TEST_F(Lockstep, GoesOnInWholeQuantaForTheSettlingTimeAfterTheDialog) {
  options.settle_s = 0.0101;
  const auto result = run(&dialog);
  for (std::size_t i = 0; i < source.advanced.size(); ++i) {
    EXPECT_EQ(source.advanced[i], (i + 1) * kQuantum);
  }
  EXPECT_EQ(result.recording.end, source.advanced.back());
  EXPECT_GE(kRate.seconds(result.recording.end), 0.0301);
  EXPECT_LE(kRate.seconds(result.recording.end), 0.0301 + 0.5e-3);
  EXPECT_EQ(dialog.steps, 40);
}

// The head of a controller that does not say when it is at rest.
class LockstepUntilQuiet : public Lockstep {
 protected:
  /// Pulses of galvo_x to the end of a span, one each 2 ms.
  void pulseUntil(double end_s) {
    for (Tick tick = 16'000; kRate.seconds(tick) < end_s; tick += 32'000) {
      source.events.push_back({tick, 0, 1, 1, 0});
      source.events.push_back({tick + 8000, 0, 1, 0, 0});
    }
  }
  ScriptedDialog quiet{0.02, Dialog::State::kDone, 0.05};
};

TEST_F(LockstepUntilQuiet, ARunGoesOnWhileTheHeadIsPulsed) {
  pulseUntil(0.2);
  const auto result = run(&quiet);
  EXPECT_THAT(result.problems, IsEmpty());
  EXPECT_NEAR(kRate.seconds(result.recording.end), 0.2 + 0.05, 3e-3);
  EXPECT_EQ(result.recording.end % kQuantum, 0U);
  EXPECT_EQ(result.recording.outputs.size(), source.events.size());
}

TEST_F(LockstepUntilQuiet, WithoutPulsesItEndsWhenItHasBeenQuiet) {
  source.events.push_back({400'000, 0, 0b10, 0b10, 0});  // DIR moves nothing.
  EXPECT_NEAR(kRate.seconds(run(&quiet).recording.end), 0.02 + 0.05, 1e-3);
}

TEST_F(LockstepUntilQuiet, APauseThatIsLongEnoughIsTheEnd) {
  pulseUntil(0.03);
  source.events.push_back({2'400'000, 0, 1, 1, 0});  // At 0.15 s.
  EXPECT_NEAR(kRate.seconds(run(&quiet).recording.end), 0.03 + 0.05, 3e-3);
}

TEST_F(LockstepUntilQuiet, AHeadThatIsNeverAtRestIsAProblem) {
  options.time_limit_s = 0.3;
  pulseUntil(0.3);
  const auto result = run(&quiet);
  EXPECT_THAT(result.problems,
              ElementsAre(HasSubstr("the time limit of 0.3 s was reached before the head was at rest")));
  EXPECT_EQ(result.recording.problems, result.problems);
}

TEST_F(LockstepUntilQuiet, AControllerThatSaysItIsAtRestIsBelieved) {
  pulseUntil(0.2);
  EXPECT_NEAR(kRate.seconds(run(&dialog).recording.end), 0.03, 1e-3);
}

TEST_F(LockstepUntilQuiet, AFailedDialogEndsTheRun) {
  pulseUntil(0.2);
  ScriptedDialog failing(0.02, Dialog::State::kFailed, 0.05);
  EXPECT_NEAR(kRate.seconds(run(&failing).recording.end), 0.03, 1e-3);
}

TEST_F(LockstepUntilQuiet, AJobOfTheControllersOwnEndsWhenTheHeadHasBeenQuiet) {
  options.by_itself = SelfStart{0.05, 0.012, {}};
  pulseUntil(0.2);
  const auto result = run(nullptr);
  EXPECT_THAT(result.problems, IsEmpty());
  EXPECT_NEAR(kRate.seconds(result.recording.end), 0.2 + 0.05, 3e-3);
  std::vector<SensorEdge> pressed;
  for (const SensorEdge& edge : result.recording.sensors)
    if (edge.signal == Signal::kStart) pressed.push_back(edge);
  EXPECT_THAT(pressed, IsEmpty()) << "this machine has no button";
}

TEST_F(LockstepUntilQuiet, TheStartButtonIsPressedAndLetGo) {
  machine.signals.assign(Signal::kStart, {3, 4});
  options.by_itself = SelfStart{0.15, 0.012, {}};
  pulseUntil(0.03);
  const auto result = run(nullptr);
  std::vector<std::pair<double, bool>> pressed;
  for (const SensorEdge& edge : result.recording.sensors)
    if (edge.signal == Signal::kStart) pressed.emplace_back(kRate.seconds(edge.tick), edge.level);
  EXPECT_THAT(pressed, ElementsAre(std::pair{0.012, true}, std::pair{0.112, false}));
  EXPECT_TRUE(std::ranges::is_sorted(source.driven));
}

TEST_F(LockstepUntilQuiet, WhatAFirmwareDoesBeforeItsButtonIsPressedIsNotTheJob) {
  options.by_itself = SelfStart{0.05, 0.4, {}};
  pulseUntil(0.02);  // A glitch of the start.
  for (Tick tick = kRate.ticksAt(0.41); kRate.seconds(tick) < 0.5; tick += 32'000) {
    source.events.push_back({tick, 0, 1, 1, 0});
    source.events.push_back({tick + 8000, 0, 1, 0, 0});
  }
  const auto result = run(nullptr);
  EXPECT_THAT(result.problems, IsEmpty());
  EXPECT_NEAR(kRate.seconds(result.recording.end), 0.5 + 0.05, 3e-3);
}

TEST_F(LockstepUntilQuiet, ALineThatGoesToItsIdleLevelIsNoPulse) {
  options.by_itself = SelfStart{0.05, {}, {Signal::kGalvoXPul}};
  options.time_limit_s = 0.3;
  source.events = {{400'000, 0, 1, 1, 0}};
  EXPECT_THAT(run(nullptr).problems, ElementsAre(HasSubstr("the head was never pulsed")));
}

TEST_F(LockstepUntilQuiet, AJobOfItsOwnThatNeverBeginsIsAProblem) {
  options.by_itself = SelfStart{0.05, {}, {}};
  options.time_limit_s = 0.3;
  EXPECT_THAT(run(nullptr).problems, ElementsAre(HasSubstr("the head was never pulsed")));
}

TEST_F(LockstepUntilQuiet, AControllerMayHaltAfterItsOwnJobAndTheMachineGoesOn) {
  options.by_itself = SelfStart{0.05, {}, {}};
  pulseUntil(0.1);
  source.stop_at = kRate.ticksAt(0.11);
  source.stop = source::Stop::kEnded;
  const auto result = run(nullptr);
  EXPECT_THAT(result.problems, IsEmpty());
  EXPECT_NEAR(kRate.seconds(result.recording.end), 0.1 + 0.05, 3e-3);
}

TEST_F(LockstepUntilQuiet, AHaltBeforeTheFirstPulseIsAProblem) {
  options.by_itself = SelfStart{0.05, {}, {}};
  source.stop_at = kRate.ticksAt(0.11);
  source.stop = source::Stop::kEnded;
  EXPECT_THAT(run(nullptr).problems, ElementsAre(HasSubstr("halted before the job was done")));
}

TEST_F(Lockstep, TheDialogsBytesGoToTheUart) {
  run(&dialog);
  EXPECT_THAT(source.written, ElementsAre(1, 2, 3));
}

TEST_F(Lockstep, TheTwinAndTheRecordingGetEveryEventOnce) {
  for (Tick tick = 5000; tick < 400000; tick += 1000) {
    const auto level = static_cast<std::uint16_t>((tick / 1000) % 2);
    source.events.push_back({tick, 0, 1, level, 0});
  }
  const auto result = run(&dialog);
  EXPECT_EQ(result.recording.outputs, source.events);
  twin::Twin alone(machine, web, kRate);
  alone.advance(result.recording.end, source.events);
  EXPECT_EQ(twin.truth().p_WQ_mm, alone.truth().p_WQ_mm);
  EXPECT_LT(twin.truth().p_WQ_mm.x(), -1.0);
}

TEST_F(Lockstep, LostEventsAreAProblem) {
  source.events = {{100'000, 0, 1, 1, 0}, {200'000, 0, 1, 0, PinEvent::kGap}};
  const auto result = run(&dialog);
  EXPECT_THAT(result.problems, ElementsAre(HasSubstr("pin events were lost before 0.0125")));
  EXPECT_EQ(result.recording.outputs.size(), 2U);
}

TEST_F(Lockstep, EventsLostAgainAndAgainAreOneProblem) {
  for (Tick tick = 100'000; tick <= 300'000; tick += 100'000)
    source.events.push_back({tick, 0, 1, static_cast<std::uint16_t>(tick / 100'000 % 2), PinEvent::kGap});
  EXPECT_THAT(run(&dialog).problems, ElementsAre(AllOf(HasSubstr("lost before 0.0065"),
                                                       HasSubstr("2 times more, the last before 0.0190"))));
}

TEST_F(Lockstep, AnEndThatTheDialogDidNotWantIsAProblem) {
  for (const auto& [stop, words] : {std::pair(source::Stop::kCrashed, "crashed"),
                                    {source::Stop::kFlooded, "floods"},
                                    {source::Stop::kHung, "does not answer"},
                                    {source::Stop::kEnded, "halted before"}}) {
    ScriptedSource broken;
    broken.stop = stop;
    broken.stop_at = 83'333;
    twin::Twin machine_twin(machine, web, kRate);
    TwinModel broken_model(machine_twin);
    ScriptedDialog talk(0.02, Dialog::State::kDone);
    const auto result = runLockstep(broken, broken_model, machine.signals, &talk, options, {});
    EXPECT_THAT(result.problems, ElementsAre(HasSubstr(words)));
    EXPECT_THAT(result.problems, ElementsAre(HasSubstr("at 0.005 s: the script says so")));
    EXPECT_EQ(result.recording.end, 83'333U);
    EXPECT_EQ(result.recording.problems, result.problems) << "or a replay would be clean";
  }
}

TEST_F(Lockstep, ACrashWhileSettlingIsAProblemToo) {
  source.stop = source::Stop::kCrashed;
  source.stop_at = 400'000;
  EXPECT_THAT(run(&dialog).problems, ElementsAre(HasSubstr("crashed")));
}

TEST_F(Lockstep, TheTimeLimitIsAProblem) {
  options.time_limit_s = 0.05;
  ScriptedDialog endless(1e9, Dialog::State::kDone);
  const auto result = run(&endless);
  EXPECT_THAT(result.problems, ElementsAre(HasSubstr("the time limit of 0.05 s was reached (talking)")));
  EXPECT_EQ(result.recording.end, 800'000U);
  EXPECT_EQ(result.recording.problems, result.problems);
}

TEST_F(Lockstep, AFailedDialogIsToldAndLeftToTheCaller) {
  ScriptedDialog failing(0.02, Dialog::State::kFailed);
  const auto result = run(&failing);
  EXPECT_EQ(result.dialog.reason, "at 0.020 s: talking");
  EXPECT_NEAR(result.dialog.time_s, 0.02, 1e-9);
  EXPECT_THAT(result.problems, IsEmpty());
}

// Bytes of a real line are read later than the watermark.
TEST_F(Lockstep, ADialogFailsAtTheTickOfWhatItHeard) {
  source.heard_behind = 42 * kQuantum;
  ScriptedDialog failing(0.02, Dialog::State::kFailed);
  const auto result = run(&failing);
  EXPECT_EQ(result.dialog.reason, "at 0.020 s: talking");
  EXPECT_NEAR(result.dialog.time_s, 0.041, 1e-9);
}

TEST_F(Lockstep, ARecordingIsReplayedToItsEndAndDrivesNothing) {
  source.accepts_input = false;
  source.stop = source::Stop::kEnded;
  source.stop_at = 300'000;
  source.events = {{299'999, 2, 4, 4, 0}};
  const auto result = run(nullptr);
  EXPECT_THAT(result.problems, IsEmpty());
  EXPECT_THAT(source.driven, IsEmpty());
  EXPECT_EQ(result.recording.end, 300'000U);
  EXPECT_EQ(result.recording.outputs, source.events);
}

TEST_F(Lockstep, ARecordingLongerThanTheTimeLimitIsAProblem) {
  source.accepts_input = false;
  source.stop = source::Stop::kEnded;
  source.stop_at = 300'000;
  options.time_limit_s = 0.01;
  const auto result = run(nullptr);
  EXPECT_THAT(result.problems, ElementsAre(HasSubstr("the time limit of 0.01 s")));
}

TEST_F(Lockstep, ARecordingThatEndsWithTheTimeLimitIsNone) {
  source.accepts_input = false;
  source.stop = source::Stop::kEnded;
  source.stop_at = 160'000;
  options.time_limit_s = 0.01;
  EXPECT_THAT(run(nullptr).problems, IsEmpty());
}

// A controller whose inputs depend on nothing that it does may run ahead, but not beyond its button.
TEST_F(Lockstep, AJobWithoutFeedbackIsForeseenFromPressToPress) {
  SignalMap bare;
  bare.assign(Signal::kGalvoXPul, {0, 0});
  bare.assign(Signal::kInterlock, {11, 2});
  bare.assign(Signal::kStart, {11, 3});
  options.by_itself = SelfStart{0.05, 0.0121, {}};
  options.time_limit_s = 0.2;
  (void)runLockstep(source, model, bare, nullptr, options, {});
  constexpr Tick kPress = 193'600, kRelease = 1'793'600, kEnd = 3'200'000;
  ASSERT_EQ(source.foreseen.size() + 1, source.advanced.size());  // The guard is closed in the first one.
  for (std::size_t i = 0; i < source.foreseen.size(); ++i) {
    const Tick begin = source.advanced[i];
    const Tick expected = begin + kQuantum < kPress     ? Tick{192'000}
                          : begin + kQuantum < kRelease ? Tick{1'792'000}
                                                        : kEnd;
    EXPECT_EQ(source.foreseen[i], std::pair(kQuantum, expected)) << i;
  }
  EXPECT_TRUE(std::ranges::is_sorted(source.driven));
}

TEST_F(Lockstep, WithFeedbackNothingIsForeseen) {
  options.by_itself = SelfStart{0.05, {}, {}};
  options.time_limit_s = 0.1;
  (void)run(nullptr);
  EXPECT_GT(source.advanced.size(), 1U);
  EXPECT_THAT(source.foreseen, IsEmpty());
}

TEST_F(Lockstep, WithADialogNothingIsForeseen) {
  SignalMap bare;
  bare.assign(Signal::kGalvoXPul, {0, 0});
  (void)runLockstep(source, model, bare, &dialog, options, {});
  EXPECT_GT(source.advanced.size(), 1U);
  EXPECT_THAT(source.foreseen, IsEmpty());
}

TEST_F(Lockstep, SensorsWithoutAPinAreNotSent) {
  SignalMap bare;
  bare.assign(Signal::kInterlock, {11, 2});
  const auto result = runLockstep(source, model, bare, &dialog, options, {});
  ASSERT_EQ(result.recording.sensors.size(), 1U);
  EXPECT_EQ(result.recording.sensors[0].signal, Signal::kInterlock);
}

}  // namespace
}  // namespace kerfbench::run
