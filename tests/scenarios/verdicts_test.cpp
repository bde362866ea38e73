// SPDX-License-Identifier: Apache-2.0
// The bench on releases that are known to be good and known to be bad. A suite whose name ends in Long is one
// of the long proofs: the same claims on the other releases and machines, and on whole jobs
// (CONTRIBUTING.md).
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// Length of a run: as shipped, or the same claim in a fraction of the time, a single unit on the fast twin.
enum Length { kAsShipped, kOneUnit };

/// The hole (E8) of a label with its kerf compensated, cut alone and in the order of the drawing.
ProgramRun runOfHoleAlone(const std::string& more, const ScratchFolder& scratch) {
  const std::string keys = fmt::format(
      "name: hole\nprint: {{units: 1}}\nselect: {{entities: '8'}}\nplanner: {{order: drawn{}}}\n", more);
  return fastRunOf(scenarioWith("native/label-edges.yaml", keys, scratch), scratch);
}

ProgramRun runOf(const std::string& scenario, Length length, const ScratchFolder& scratch) {
  if (length == kOneUnit)
    return fastRunOf(scenarioWith(scenario, "print: {units: 1}\n", scratch), scratch, "--timing");
  return kerfbench(fmt::format("run '{}' --no-pictures --results-dir '{}' --timing",
                               fixture("scenarios/" + scenario).string(), scratch.path().string()));
}

/// One label of which the width of its cuts is ordered, as what 0.105 J/mm leave open for light.
ProgramRun runOfOrderedLabel(const std::string& more, const ScratchFolder& scratch) {
  const std::string keys =
      "name: ordered\nprint: {units: 1}\nchecks: {ordered_width: {nominal_mm: 0.132}}\n" + more;
  return fastRunOf(scenarioWith("native/label-on-belt.yaml", keys, scratch), scratch);
}

/// Writes a recording again with these signals the other way round, and without a sum, as an analyser of
/// another house would write it.
void invert(const std::vector<std::string>& signals, const std::filesystem::path& from,
            const std::filesystem::path& to) {
  std::istringstream in(textOf(from));
  std::ofstream out(to);
  std::string ids;
  for (std::string line; std::getline(in, line);) {
    for (const std::string& signal : signals)
      if (line.starts_with("$var wire 1 ") && line.ends_with(" " + signal + " $end")) ids += line[12];
    const bool is_change = line.size() == 2 && (line[0] == '0' || line[0] == '1');
    if (is_change && ids.find(line[1]) != std::string::npos) line[0] = line[0] == '0' ? '1' : '0';
    if (!line.starts_with("$comment kerfbench sum ")) out << line << '\n';
  }
}

ProgramRun fastReplayOf(const std::filesystem::path& pins, const std::filesystem::path& scenario,
                        const ScratchFolder& scratch) {
  return kerfbench(fmt::format("replay '{}' --scenario '{}' --no-pictures --twin fast --results-dir '{}'",
                               pins.string(), scenario.string(), scratch.path().string()));
}

/// One label, on a belt of these keys, by a release whose X axis runs the wrong way.
void invertedXFails(const std::string& belt) {
  const ScratchFolder scratch;
  const std::filesystem::path scenario =
      scenarioWith("native/label-on-belt.yaml", "name: label\nprint: {units: 1}\n" + belt, scratch);
  ASSERT_EQ(fastRunOf(scenario, scratch).exit_code, 0);
  invert({"galvo_x_dir"}, scratch.path() / "label/latest/pins.vcd", scratch.path() / "inverted.vcd");
  const ProgramRun run = fastReplayOf(scratch.path() / "inverted.vcd", scenario, scratch);
  EXPECT_EQ(run.exit_code, 1) << run.output;
  const nlohmann::json verdict = verdictOf(scratch.path() / "label-replay");
  EXPECT_THAT(checksThat(verdict, "FAIL"), AllOf(Contains("path"), Contains("coverage"), Contains("stray")))
      << run.output;
  EXPECT_THAT(verdict.at("likely_cause").get<std::string>(), HasSubstr("X runs backwards")) << run.output;
}

void passes(const std::string& scenario, Length length = kAsShipped) {
  const ScratchFolder scratch;
  const ProgramRun run = runOf(scenario, length, scratch);
  EXPECT_EQ(run.exit_code, 0) << run.output;
  std::printf("%s", run.output.c_str());
}

/// Runs fixtures/scenarios/faults/NAME.yaml, and expects this check to fail.
void failsBy(const std::string& name, const std::string& check, Length length = kAsShipped) {
  const ScratchFolder scratch;
  const ProgramRun run = runOf("faults/" + name + ".yaml", length, scratch);
  EXPECT_EQ(run.exit_code, 1) << run.output;
  const auto verdict = verdictOf(scratch.path() / ("fault-" + name));
  EXPECT_THAT(checksThat(verdict, "FAIL"), Contains(check)) << run.output;
  // None of these releases has anything wrong with its axes.
  for (const auto& cause : verdict.at("diagnosis").at("causes"))
    EXPECT_NE(cause.at("cause"), "axes") << run.output;
}

TEST(GoodRelease, LabelAvrPasses) { passes("label-on-belt.yaml"); }
TEST(GoodRelease, LabelEdgesAvrPasses) { passes("label-edges.yaml", kOneUnit); }
TEST(GoodReleaseLong, LabelEdgesAvrPasses) { passes("label-edges.yaml"); }
TEST(GoodReleaseLong, LabelEdgesNativePasses) { passes("native/label-edges.yaml"); }
TEST(GoodRelease, HoleAlonePasses) {
  const ScratchFolder scratch;
  const ProgramRun run = runOfHoleAlone("", scratch);
  EXPECT_EQ(run.exit_code, 0) << run.output;
}
TEST(GoodReleaseLong, LabelOfTheOrderedWidthPasses) {
  const ScratchFolder scratch;
  const ProgramRun run = runOfOrderedLabel("", scratch);
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(checksThat(verdictOf(scratch.path() / "ordered"), "PASS"), Contains("ordered_width"));
}
TEST(GoodRelease, LabelOnSlowPinsPasses) { passes("pins/label-slow.yaml"); }
TEST(GoodRelease, LabelFedPasses) { passes("label-fed.yaml", kOneUnit); }
TEST(GoodReleaseLong, LabelFedPasses) { passes("label-fed.yaml"); }
TEST(GoodReleaseLong, LabelNativePasses) { passes("native/label-on-belt.yaml"); }
TEST(GoodRelease, CartonAvrPasses) { passes("carton-on-belt.yaml"); }
TEST(GoodReleaseLong, CartonNativePasses) { passes("native/carton-on-belt.yaml"); }
TEST(GoodReleaseLong, ThreeLayersAvrPasses) { passes("carton-three-layers.yaml"); }
TEST(GoodReleaseLong, ThreeLayersNativePasses) { passes("native/carton-three-layers.yaml"); }
TEST(GoodRelease, CouponPerforatedAvrPasses) { passes("coupon-perforated.yaml", kOneUnit); }
TEST(GoodReleaseLong, CouponPerforatedAvrPasses) { passes("coupon-perforated.yaml"); }
TEST(GoodReleaseLong, CouponPerforatedNativePasses) { passes("native/coupon-perforated.yaml"); }
TEST(GoodRelease, ShortLinesAvrPasses) { passes("short-lines.yaml"); }
TEST(GoodReleaseLong, ShortLinesNativePasses) { passes("native/short-lines.yaml"); }
TEST(GoodRelease, ButtonAvrPasses) { passes("button.yaml"); }
TEST(GoodReleaseLong, ButtonNativePasses) { passes("native/button.yaml"); }
TEST(GoodReleaseLong, ButtonSlowLoopNativePasses) { passes("native/button-slow-loop.yaml"); }
TEST(GoodReleaseLong, ButtonJerkNativePasses) { passes("native/button-jerk.yaml"); }
TEST(GoodReleaseLong, ButtonOnBeltNativePasses) { passes("native/button-on-belt.yaml"); }
TEST(GoodReleaseLong, ButtonStraightNativePasses) { passes("native/button-straight.yaml"); }
TEST(GoodReleaseLong, StripAvrPasses) { passes("strip-crosscut.yaml"); }
TEST(GoodReleaseLong, StripNativePasses) { passes("native/strip-crosscut.yaml"); }
TEST(GoodRelease, StripStopAndGoAvrPasses) { passes("strip-stop-and-go.yaml", kOneUnit); }
TEST(GoodReleaseLong, StripStopAndGoAvrPasses) { passes("strip-stop-and-go.yaml"); }
TEST(GoodReleaseLong, StripRunUpAvrPasses) { passes("strip-run-up.yaml"); }
TEST(GoodReleaseLong, StripSpeedVariesAvrPasses) { passes("strip-speed-varies.yaml"); }

TEST(BadRelease, BeltIgnoredFailsByStillnessX) { failsBy("belt-ignored", "stillness_x", kOneUnit); }
TEST(BadReleaseLong, BeltIgnoredFailsByStillnessX) { failsBy("belt-ignored", "stillness_x"); }
TEST(BadRelease, EncoderScaleFailsByPath) { failsBy("encoder-scale", "path", kOneUnit); }
TEST(BadReleaseLong, EncoderScaleFailsByPath) { failsBy("encoder-scale", "path"); }
/// One label on a machine whose drives have these levels, by the release whose planner knows them.
ProgramRun runOfLevels(const std::string& axes, const ScratchFolder& scratch) {
  std::ofstream(scratch.path() / "machine.yaml")
      << "extends: " << fixture("machines/two-mirror.yaml").string() << "\nname: levels\n"
      << axes;
  return fastRunOf(scenarioWith("native/label-on-belt.yaml",
                                "name: levels\nprint: {units: 1}\nmachine: machine.yaml\n", scratch),
                   scratch);
}

TEST(GoodRelease, DrivesOfOtherLevelsAreServedAndJudgedByThem) {
  const ScratchFolder scratch;
  const ProgramRun run =
      runOfLevels("galvo_x: {dir_low: true}\ngalvo_y: {dir_low: true, active_edge: falling}\n", scratch);
  EXPECT_EQ(run.exit_code, 0) << run.output;
}

TEST(GoodRelease, ARecordingOfOneSenseOfDirFailsOnAMachineOfTheOther) {
  const ScratchFolder scratch;
  ASSERT_EQ(runOfLevels("galvo_y: {dir_low: true}\n", scratch).exit_code, 0);
  const ProgramRun run = fastReplayOf(
      scratch.path() / "levels/latest/pins.vcd",
      scenarioWith("native/label-on-belt.yaml", "name: usual\nprint: {units: 1}\n", scratch), scratch);
  EXPECT_EQ(run.exit_code, 1) << run.output;
}

TEST(GoodRelease, ALaserThatListensToLowLevelsIsJudgedByThem) {
  const ScratchFolder scratch;
  const auto scenario = [&](const std::string& name, const std::string& machine) {
    return scenarioWith("native/label-on-belt.yaml", "name: " + name + "\nprint: {units: 1}\n" + machine,
                        scratch);
  };
  ASSERT_EQ(fastRunOf(scenario("high", ""), scratch).exit_code, 0);
  std::ofstream(scratch.path() / "machine.yaml")
      << "extends: " << fixture("machines/two-mirror.yaml").string()
      << "\nname: low\nlaser: {gate_low: true, pwm_low: true}\n";
  const std::filesystem::path inverted = scratch.path() / "inverted.vcd";
  invert({"laser_gate", "laser_pwm"}, scratch.path() / "high/latest/pins.vcd", inverted);
  const ProgramRun low = fastReplayOf(inverted, scenario("low", "machine: machine.yaml\n"), scratch);
  EXPECT_EQ(low.exit_code, 0) << low.output;
  EXPECT_EQ(verdictOf(scratch.path() / "low-replay").at("checks"),
            verdictOf(scratch.path() / "high").at("checks"));

  const ProgramRun wrong = fastReplayOf(scratch.path() / "high/latest/pins.vcd",
                                        scenario("wrong", "machine: machine.yaml\n"), scratch);
  EXPECT_EQ(wrong.exit_code, 1) << wrong.output;
  EXPECT_THAT(verdictOf(scratch.path() / "wrong-replay").at("likely_cause").get<std::string>(),
              testing::StartsWith("The laser's gate is open between the cuts and closed in them: invert the "
                                  "gate in the firmware, or set `laser.gate_low: false`"))
      << wrong.output;
}

TEST(BadRelease, DirLateFailsByPulseTiming) { failsBy("dir-late", "pulse_timing", kOneUnit); }
TEST(BadReleaseLong, DirLateFailsByPulseTiming) { failsBy("dir-late", "pulse_timing"); }
TEST(BadReleaseLong, PulsesLostFailsByPath) { failsBy("pulses-lost", "path"); }
TEST(BadReleaseLong, PincushionUncorrectedFailsByPath) { failsBy("pincushion-uncorrected", "path"); }
TEST(BadRelease, GateLateFailsByGateLag) { failsBy("gate-late", "gate_lag", kOneUnit); }
TEST(BadReleaseLong, GateLateFailsByGateLag) { failsBy("gate-late", "gate_lag"); }
TEST(BadReleaseLong, EdgesUncompensatedFailsByEdge) { failsBy("edges-uncompensated", "edge"); }
TEST(BadRelease, EdgesWrongSideFailsByEdge) { failsBy("edges-wrong-side", "edge", kOneUnit); }
TEST(BadReleaseLong, EdgesWrongSideFailsByEdge) { failsBy("edges-wrong-side", "edge"); }
TEST(BadRelease, HoleAloneOnTheWrongSideFailsByEdge) {
  const ScratchFolder scratch;
  const ProgramRun run = runOfHoleAlone(", faults: {kerf_wrong_side: true}", scratch);
  EXPECT_EQ(run.exit_code, 1) << run.output;
  EXPECT_THAT(checksThat(verdictOf(scratch.path() / "hole"), "FAIL"), Contains("edge")) << run.output;
}
TEST(BadRelease, ButtonStraightHooksFailsByJoints) { failsBy("button-straight-hooks", "joints", kOneUnit); }
TEST(BadRelease, ShortLinesOpenLoopFailsByLineEnergy) { failsBy("short-lines-open-loop", "line_energy"); }
TEST(BadReleaseLong, ShortLinesByThePapersGainBehindALateMeterFailsByLineEnergy) {
  failsBy("short-lines-paper-law", "line_energy");
}
TEST(BadRelease, ShortLinesConstantPowerFailsByEvenDepthAndTheCauseIsSaid) {
  const ScratchFolder scratch;
  const ProgramRun run = runOf("faults/short-lines-constant-power.yaml", kAsShipped, scratch);
  EXPECT_EQ(run.exit_code, 1) << run.output;
  const auto verdict = verdictOf(scratch.path() / "fault-short-lines-constant-power");
  EXPECT_THAT(checksThat(verdict, "FAIL"), Contains("even_depth")) << run.output;
  EXPECT_THAT(verdict.at("likely_cause").get<std::string>(),
              ::testing::HasSubstr("keeps its power where the beam is slow"));
}
TEST(BadRelease, HalfCutThroughFailsByDepth) { failsBy("half-cut-through", "depth", kOneUnit); }
TEST(BadRelease, PerforationOtherFailsByPerforation) {
  failsBy("perforation-other", "perforation", kOneUnit);
}
TEST(BadReleaseLong, PerforationOtherFailsByPerforation) { failsBy("perforation-other", "perforation"); }
TEST(BadRelease, LabelWithTooMuchEnergyFailsByOrderedWidth) {
  const ScratchFolder scratch;
  const ProgramRun run = runOfOrderedLabel("planner: {cut_energy_j_per_mm: 0.3045}\n", scratch);
  EXPECT_EQ(run.exit_code, 1) << run.output;
  EXPECT_THAT(checksThat(verdictOf(scratch.path() / "ordered"), "FAIL"), ElementsAre("ordered_width"))
      << run.output;
}
TEST(BadReleaseLong, EnergyTooHighFailsByOrderedWidth) { failsBy("energy-too-high", "ordered_width"); }
TEST(BadRelease, EntitySkippedFailsByCoverage) { failsBy("entity-skipped", "coverage", kOneUnit); }
TEST(BadReleaseLong, EntitySkippedFailsByCoverage) { failsBy("entity-skipped", "coverage"); }
TEST(BadRelease, EntityTwiceFailsByRepeat) { failsBy("entity-twice", "repeat", kOneUnit); }
TEST(BadReleaseLong, EntityTwiceFailsByRepeat) { failsBy("entity-twice", "repeat"); }
TEST(BadReleaseLong, StripReturnSlowFailsByFinish) { failsBy("strip-return-slow", "finish"); }
TEST(BadRelease, InvertedXOnARestingSheetFails) {
  invertedXFails("belt: {speed_mm_s: 0, start_x_mm: 27.5}\n");
}
TEST(BadReleaseLong, InvertedXOnAMovingBeltFails) { invertedXFails(""); }
TEST(BadReleaseLong, ButtonStraightFastFailsByPath) { failsBy("button-straight-fast", "path"); }

}  // namespace
}  // namespace kerfbench::test
