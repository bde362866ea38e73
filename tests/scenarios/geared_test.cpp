// SPDX-License-Identifier: Apache-2.0
// Cheng, Cui, Zhang 2014 on their own kind of machine: geared steppers on the mirrors. What holds, and that
// it does not without what the planner does for the rotors, nor on a machine that is not as the controller
// was told.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::Contains;

class GearedSteppers : public testing::Test {
 protected:
  /// Runs a scenario on the shipped machine, with these keys of the machine and of the scenario in place of
  /// its own.
  ProgramRun run(const std::string& scenario, const std::string& machine, const std::string& keys = "") {
    std::string all = "name: run\n" + keys;
    if (!machine.empty()) {
      const auto path = scratch_.path() / "machine.yaml";
      std::ofstream(path) << fmt::format("extends: '{}'\nname: machine\n{}",
                                         fixture("machines/two-mirror-geared.yaml").string(), machine);
      all += fmt::format("machine: '{}'\n", path.string());
    }
    return fastRunOf(scenarioWith("geared/" + scenario + ".yaml", all, scratch_), scratch_);
  }
  [[nodiscard]] nlohmann::json verdict() const { return verdictOf(scratch_.path() / "run"); }
  [[nodiscard]] double value(const std::string& check) const {
    const nlohmann::json whole = verdict();
    for (const auto& c : whole.at("checks"))
      if (c.at("name") == check) return c.at("value");
    ADD_FAILURE() << "no check " << check;
    return 0.0;
  }
  ScratchFolder scratch_;
};
using GearedSteppersLong = GearedSteppers;

TEST_F(GearedSteppers, PlateAtRestPasses) {
  const ProgramRun done = run("plate", "");
  EXPECT_EQ(done.exit_code, 0) << done.output;
  EXPECT_LT(value("joints"), 0.03);
}
TEST_F(GearedSteppers, PlateOnBeltPasses) {
  const ProgramRun done = run("plate-on-belt", "");
  EXPECT_EQ(done.exit_code, 0) << done.output;
  EXPECT_LT(value("joints"), 0.03);
}
TEST_F(GearedSteppersLong, OneLabelOnBeltPasses) {
  const ProgramRun done = run("label-on-belt", "", "print: {units: 1}\n");
  EXPECT_EQ(done.exit_code, 0) << done.output;
}
// The magnets alone: 0.031 mm, and what rounding adds.
TEST_F(GearedSteppers, AControllerThatKnowsNothingOfTheMagnetsProvesNothing) {
  const ProgramRun done = run("plate-on-belt", "controller: {detent_share: 0}\n");
  EXPECT_NE(done.exit_code, 0) << done.output;
  EXPECT_THAT(checksThat(verdict(), "PASS"), testing::Not(Contains("path"))) << done.output;
}
// At 26.7 mm/s the pattern of rounded steps comes round 192 times in a second.
TEST_F(GearedSteppersLong, TheSpeedThatSwingsTheRotorsIsHeldByStepsForTheRotor) {
  const std::string belt = "belt: {speed_mm_s: 26.7}\n";
  EXPECT_EQ(run("plate-on-belt", "", belt).exit_code, 0);
  const double led = value("stillness_x");
  const ProgramRun left = run("plate-on-belt", "controller: {rotor_resonance_hz: 0}\n", belt);
  EXPECT_NE(left.exit_code, 0) << left.output;
  EXPECT_GT(value("stillness_x"), 2.0 * led + 0.02);
}
TEST_F(GearedSteppers, AReductionThatIsTwoInAThousandOffFailsByPath) {
  const ProgramRun done = run("plate-on-belt", "galvo_x: {ratio: 0.0501}\ngalvo_y: {ratio: 0.0501}\n");
  EXPECT_EQ(done.exit_code, 1) << done.output;
  EXPECT_THAT(checksThat(verdict(), "FAIL"), Contains("path")) << done.output;
}
TEST_F(GearedSteppers, ADriveWithAnotherSubdivisionFails) {
  const ProgramRun done = run("plate", "galvo_y: {stepper: {subdivision: 50}}\n");
  EXPECT_EQ(done.exit_code, 1) << done.output;
}

TEST_F(GearedSteppersLong, PlateOnBeltByTheAvrPasses) {
  EXPECT_EQ(run("plate-on-belt-avr", "").exit_code, 0);
}
TEST_F(GearedSteppersLong, LabelsOnBeltPass) { EXPECT_EQ(run("label-on-belt", "").exit_code, 0); }
TEST_F(GearedSteppersLong, MachinesAsBuiltPassOnTheBelt) {
  for (const int seed : {1, 2, 3}) {
    for (const char* scenario : {"plate-on-belt", "label-on-belt"}) {
      const ProgramRun done =
          run(scenario, "", fmt::format("seed: {}\nimperfections: static\nprint: {{units: 1}}\n", seed));
      EXPECT_EQ(done.exit_code, 0) << scenario << " " << seed << "\n" << done.output;
    }
  }
}
// A motor whose magnets pull by a fifth more or less than its data sheet says.
TEST_F(GearedSteppersLong, HoldsForMagnetsThatAreAFifthStrongerOrWeaker) {
  for (const char* detent : {"0.024", "0.036"}) {
    const std::string mirror = fmt::format("{{stepper: {{detent_torque_n_m: {}}}}}\n", detent);
    const ProgramRun done = run("plate-on-belt", "galvo_x: " + mirror + "galvo_y: " + mirror);
    EXPECT_EQ(done.exit_code, 0) << detent << "\n" << done.output;
  }
}

}  // namespace
}  // namespace kerfbench::test
