// SPDX-License-Identifier: Apache-2.0
// Impossible machines: refused before anything runs, with everything that is wrong, and no trace of a run.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;

class HostileMachine : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file(const std::string& name, const std::string& content) const {
    std::ofstream(scratch_.path() / name) << content;
    return scratch_.path() / name;
  }
  // Machine file; lines 2 and on are the caller's.
  [[nodiscard]] std::filesystem::path machine(const std::string& base, const std::string& lines) const {
    return file("bad.yaml", "extends: " + fixture("machines/" + base + ".yaml").string() + "\n" + lines);
  }
  [[nodiscard]] std::string refused(const std::string& base, const std::string& lines) const {
    const auto result = kerfbench(fmt::format("lint '{}'", machine(base, lines).string()));
    EXPECT_EQ(result.exit_code, 65) << result.output;
    return result.output;
  }
  ScratchFolder scratch_;
};

TEST_F(HostileMachine, EverythingThatIsWrongIsListedAtOnce) {
  const std::string said = refused("strip-gantry",
                                   "gantry_x: {mass_kg: 0, stiffness_n_mm: -5}\n"
                                   "gantry_y: {servo: {bandwidth_hz: 1.0e+9}}\n"
                                   "frame: {mass_kg: .nan}\n"
                                   "belt: {mass_kg: .inf, roller_radius_mm: 1.0e+300}\n"
                                   "laser: {full_power_w: -.inf}\n"
                                   "travel: {x_mm: [-1.0e+300, 5]}\n");
  EXPECT_THAT(said, AllOf(HasSubstr("bad.yaml:2: gantry_x.mass_kg: 0 is outside"),
                          HasSubstr("bad.yaml:2: gantry_x.stiffness_n_mm: -5 is outside"),
                          HasSubstr("bad.yaml:3: gantry_y.servo.bandwidth_hz: 1000000000 is outside"),
                          HasSubstr("bad.yaml:4: frame.mass_kg: '.nan' is not a number")));
  EXPECT_THAT(said, AllOf(HasSubstr("bad.yaml:5: belt.mass_kg: '.inf' is not a number"),
                          HasSubstr("bad.yaml:5: belt.roller_radius_mm: 1e+300 is outside"),
                          HasSubstr("bad.yaml:6: laser.full_power_w: '-.inf' is not a number"),
                          HasSubstr("bad.yaml:7: travel.x_mm: -1e+300 is outside")));
}

TEST_F(HostileMachine, ValuesThatAreFineAloneAndImpossibleTogetherAreNamedWithTheirLine) {
  // The motor cannot move its load, and the belt swings faster than the model steps.
  const std::string said = refused("two-mirror",
                                   "galvo_x: {friction: {coulomb_n_m: 1}}\n"
                                   "belt: {mass_kg: 0.01, stiffness_n_mm: 1.0e+6}\n");
  EXPECT_THAT(said, ContainsRegex("bad.yaml:2: galvo_x: the motor's 0.08 N m cannot move"));
  EXPECT_THAT(said, ContainsRegex("bad.yaml:3: belt: roller against belt swings at"));
}

TEST_F(HostileMachine, AServoThatSwingsUpIsNoMachine) {
  // The current loop is much too slow for the position loop around it.
  EXPECT_THAT(refused("two-mirror", "galvo_y: {servo: {current_lag_us: 2000}}\n"),
              ContainsRegex("bad.yaml:2: galvo_y: servo, current loop and transmission together swing up"));
}

TEST_F(HostileMachine, AFieldBeyondTheTravelIsNamedWithItsLine) {
  EXPECT_THAT(refused("strip-gantry", "travel: {x_mm: [-10, 100]}\n"),
              ContainsRegex("the controller's field along x, -30 … 790 mm, is beyond the travel"));
}

TEST_F(HostileMachine, HugeListsAreRefusedAndNotRead) {
  std::string points = "laser:\n  power_curve:\n";
  for (int i = 0; i <= 5000; ++i)
    points += fmt::format("    - {{demand: {}, power: {}}}\n", i / 5000.0, i / 5000.0);
  EXPECT_THAT(refused("two-mirror", points), HasSubstr("laser.power_curve: has more than 100 points"));
  // A megabyte of text is no configuration.
  EXPECT_THAT(refused("two-mirror", "# " + std::string(2U << 20U, 'x') + "\n"),
              HasSubstr("and at most 1048576 are read"));
}

TEST_F(HostileMachine, NamesThatNamesStandForDoNotMultiply) {
  // Ten aliases of ten aliases of …: a few lines that would be 10^9 numbers if written out.
  std::string bomb = "a0: &a0 [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]\n";
  for (int i = 1; i < 10; ++i) {
    bomb += fmt::format("a{}: &a{} [", i, i);
    for (int k = 0; k < 10; ++k) bomb += fmt::format("{}*a{}", k == 0 ? "" : ", ", i - 1);
    bomb += "]\n";
  }
  const std::string said = refused("two-mirror", bomb + "imperfections: {zero_urad: *a9}\n");
  EXPECT_THAT(said,
              AllOf(HasSubstr("a9: unknown key"), HasSubstr("imperfections.zero_urad: '…' is not a number")));
}

TEST_F(HostileMachine, IsNotRunEither) {
  const auto bad = machine("two-mirror", "galvo_x: {friction: {coulomb_n_m: 1}}\n");
  const auto scenario = file("s.yaml", "extends: " + fixture("scenarios/label-on-belt.yaml").string() +
                                           "\nname: hostile\nmachine: " + bad.string() + "\n");
  const auto run = kerfbench(
      fmt::format("run '{}' --results-dir '{}/results'", scenario.string(), scratch_.path().string()));
  EXPECT_EQ(run.exit_code, 65) << run.output;
  EXPECT_THAT(run.output, HasSubstr("bad.yaml:2: galvo_x: "));
  EXPECT_FALSE(std::filesystem::exists(scratch_.path() / "results"));
}

TEST_F(HostileMachine, ASpreadThatDrawsAMachineThatCannotRunIsRefusedWithItsSeed) {
  // The servos are at the edge of what the step can follow: some seeds sample them over it.
  const auto edge = machine("two-mirror",
                            "galvo_x: {servo: {bandwidth_hz: 3180}, resonance_hz: 6300}\n"
                            "imperfections: {bandwidth_percent: 5}\n");
  const auto scenario = file("s.yaml", "extends: " + fixture("scenarios/label-on-belt.yaml").string() +
                                           "\nname: edge\nmachine: " + edge.string() + "\n");
  const auto described = kerfbench(fmt::format("lint '{}'", scenario.string()));
  ASSERT_EQ(described.exit_code, 0) << described.output;
  int refusals = 0;
  for (int seed = 1; seed <= 6; ++seed) {
    const auto run = kerfbench(fmt::format(
        "run '{}' --imperfections dynamic --seed {} --time-limit 0.01 --no-pictures --results-dir "
        "'{}/results'",
        scenario.string(), seed, scratch_.path().string()));
    if (run.exit_code == 3) continue;  // The time limit: this machine ran.
    EXPECT_EQ(run.exit_code, 65) << run.output;
    EXPECT_THAT(run.output,
                HasSubstr(fmt::format("the machine that seed {} draws cannot run: galvo_x", seed)));
    ++refusals;
  }
  EXPECT_GT(refusals, 0);
  EXPECT_LT(refusals, 6);
}

}  // namespace
}  // namespace kerfbench::test
