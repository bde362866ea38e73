// SPDX-License-Identifier: Apache-2.0
// Faults of machine files, which are reported with their line.
#include <string>
#include <utility>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/hil/machine_file/machine_file_fixture.h"

namespace kerfbench::machine_file {
namespace {

using testing::HasSubstr;

class MachineFaultsTest : public MachineFileTest {};

TEST_F(MachineFaultsTest, EveryFaultIsListedWithItsLineAtOnce) {
  std::string bad = text("two-mirror.yaml");
  bad = base::replaced(bad, "throw_mm: 500", "throw_mm: -1");
  bad = base::replaced(bad, "damping: 0.7", "dampness: 0.7");
  bad = base::replaced(bad, "full_power_w: 100", "full_power_w: much");
  bad = base::replaced(bad, "roller_radius_mm: 30", "roller_radius_mm: .nan");
  bad = base::replaced(bad, "field_y_mm: [-80, 80]", "field_y_mm: [-80]");
  const std::string faults = faultsOf(bad);
  const auto at = [&](const char* part, const char* key) {
    EXPECT_THAT(faults, HasSubstr(fmt::format("m.yaml:{}: {}:", base::lineOf(bad, part), key)));
  };
  at("throw_mm: -1", "optics.throw_mm");
  at("dampness", "galvo_x.servo.dampness");
  at("full_power_w: much", "laser.full_power_w");
  at("roller_radius_mm: .nan", "belt.roller_radius_mm");
  at("field_y_mm: [-80]", "controller.field_y_mm");
}

TEST_F(MachineFaultsTest, APinThatIsGivenTwiceIsNamedWithBothSignals) {
  const std::string bad = base::replaced(text("two-mirror.yaml"), "galvo_y_pul: PA2", "galvo_y_pul: PA0");
  const std::string faults = faultsOf(bad);
  EXPECT_THAT(faults, HasSubstr("PA0 is given to galvo_x_pul and to galvo_y_pul"));
  EXPECT_THAT(faults, HasSubstr(fmt::format("m.yaml:{}:", base::lineOf(bad, "galvo_y_pul"))));
}

TEST_F(MachineFaultsTest, APinThatIsGateAndPowerIsToldHowItIsWritten) {
  const std::string good = text("two-mirror.yaml");
  const std::string gate = "laser_gate: PC2";
  ASSERT_THAT(good, HasSubstr(gate));
  const std::string bad = base::replaced(good, gate, "laser_gate: PC3");
  EXPECT_THAT(faultsOf(bad),
              HasSubstr("PC3 is given to laser_gate and to laser_pwm: a pin that is both is the gate, "
                        "with `laser_pwm: ~`"));
  EXPECT_EQ(faultsOf(base::replaced(bad, "laser_pwm: PC3", "laser_pwm: ~")), "");
}

TEST_F(MachineFaultsTest, OnlyEnablesShareAPin) {
  const auto with = [&](const std::string& pins) {
    return faultsOf(base::replaced(text("two-mirror.yaml"), "laser_gate: PC2", "laser_gate: PC2\n" + pins));
  };
  EXPECT_EQ(with("  galvo_x_enable: PK0\n  galvo_y_enable: PK0\n  feed_enable: PK0"), "");
  EXPECT_THAT(with("  galvo_x_enable: PC2"), HasSubstr("PC2 is given to laser_gate and to galvo_x_enable"));
  EXPECT_THAT(with("  galvo_x_enable: PK0\n  galvo_y_enable: PA0"),
              HasSubstr("PA0 is given to galvo_x_pul and to galvo_y_enable"));
}

TEST_F(MachineFaultsTest, LevelsAreTrueOrFalse) {
  const auto with = [&](const std::string& from, const std::string& key) {
    return faultsOf(base::replaced(text("two-mirror.yaml"), from, from + "\n" + key));
  };
  EXPECT_THAT(with("laser:", "  gate_low: low"), HasSubstr("laser.gate_low: is neither true nor false"));
  EXPECT_THAT(with("laser:", "  pwm_low: 1.5"), HasSubstr("laser.pwm_low: is neither true nor false"));
}

TEST_F(MachineFaultsTest, ASignalThatIsGivenTwoPinsIsAFault) {
  const std::string bad =
      base::replaced(text("two-mirror.yaml"), "galvo_y_pul: PA2", "galvo_y_pul: PA2\n  galvo_y_pul: PB2");
  const std::string faults = faultsOf(bad);
  EXPECT_THAT(faults, HasSubstr("galvo_y_pul: given twice"));
  EXPECT_THAT(faults, HasSubstr(fmt::format("m.yaml:{}:", base::lineOf(bad, "galvo_y_pul: PB2"))));
}

TEST_F(MachineFaultsTest, WhatIsNoPinOrNoSignalIsAFaultAtItsLine) {
  for (const char* pin : {"A0", "PA", "PA16", "pA0", "PAx", "PA-1", "PA001", "7"}) {
    const std::string bad =
        base::replaced(text("two-mirror.yaml"), "laser_gate: PC2", fmt::format("laser_gate: {}", pin));
    EXPECT_THAT(faultsOf(bad), HasSubstr(fmt::format("m.yaml:{}: pins.laser_gate: '{}' is no pin",
                                                     base::lineOf(bad, "laser_gate"), pin)));
  }
  const std::string bad = base::replaced(text("two-mirror.yaml"), "laser_gate: PC2", "laser_gat: PC2");
  EXPECT_THAT(faultsOf(bad),
              HasSubstr(fmt::format("m.yaml:{}: pins.laser_gat: unknown", base::lineOf(bad, "laser_gat"))));
}

TEST_F(MachineFaultsTest, APinThatTheMachineNeedsIsMissed) {
  const std::string bad = base::replaced(text("two-mirror.yaml"), "  galvo_x_dir: PA1\n", "");
  EXPECT_THAT(faultsOf(bad), HasSubstr("pins.galvo_x_dir: has no pin"));
  // Keys of the other head are not needed.
  EXPECT_EQ(faultsOf(base::replaced(text("two-mirror.yaml"), "  gantry_x_pul: PA4\n", "")), "");
}

TEST_F(MachineFaultsTest, ADriverThatNobodyKnowsIsAFault) {
  const std::string bad = base::replaced(text("strip-gantry.yaml"), "driver: DM556", "driver: DM557");
  EXPECT_THAT(faultsOf(bad), HasSubstr(fmt::format("m.yaml:{}: gantry_x.driver: no driver 'DM557'",
                                                   base::lineOf(bad, "driver: DM557"))));
}

TEST_F(MachineFaultsTest, ABandwidthThatTheStepCannotFollowIsAFault) {
  const std::string bad = base::replaced(text("two-mirror.yaml"), "bandwidth_hz: 1200", "bandwidth_hz: 3200");
  EXPECT_THAT(faultsOf(bad), HasSubstr(fmt::format("m.yaml:{}: galvo_x.servo.bandwidth_hz: 3200 is outside",
                                                   base::lineOf(bad, "3200"))));
  EXPECT_EQ(faultsOf(base::replaced(text("two-mirror.yaml"), "bandwidth_hz: 1200", "bandwidth_hz: 3180")),
            "");
}

TEST_F(MachineFaultsTest, ABridgeLighterThanItsCarriageIsAFault) {
  EXPECT_THAT(faultsOf(base::replaced(text("strip-gantry.yaml"), "mass_kg: 12", "mass_kg: 3")),
              HasSubstr("gantry_x.mass_kg: the bridge carries the carriage"));
}

TEST_F(MachineFaultsTest, TravelThatGoesBackwardsIsAFault) {
  const std::string bad = base::replaced(text("strip-gantry.yaml"), "y_mm: [-430, 430]", "y_mm: [430, -430]");
  EXPECT_THAT(faultsOf(bad),
              HasSubstr(fmt::format("m.yaml:{}: travel.y_mm:", base::lineOf(bad, "[430, -430]"))));
}

TEST_F(MachineFaultsTest, AFieldThatGoesBackwardsIsAFault) {
  EXPECT_THAT(faultsAt(extending("strip-gantry.yaml", "controller: {field_y_mm: [420, -420]}\n")),
              HasSubstr("m.yaml:2: controller.field_y_mm: the second value must be the larger"));
}

TEST_F(MachineFaultsTest, ACameraThatCannotBeIsAFault) {
  for (const auto& [key, value] : {std::pair("exposure_us", "1500"),
                                   {"exposure_us", "55"},
                                   {"size_px", "[0, 1800]"},
                                   {"size_px", "[1800, 1e7]"},
                                   {"size_px", "[1800.5, 1800]"},
                                   {"pitch_mm", "0"},
                                   {"psf_sigma_px", "-1"}}) {
    const std::string bad = base::withValue(text("two-mirror.yaml"), key, value);
    EXPECT_THAT(faultsOf(bad), HasSubstr(fmt::format("m.yaml:{}: cameras.spot.{}:",
                                                     base::lineOf(bad, std::string(key) + ": "), key)))
        << value;
  }
}

TEST_F(MachineFaultsTest, FaultsInTheFileOfDriversAreNamedThere) {
  const auto drivers =
      temp_.write("bad.yaml", "drivers:\n  - {name: X, setup_us: -1, hold_us: 1, width_us: 1}\n");
  const std::string faults =
      faultsOf(base::replaced(base::contentOf(base::fixture("machines/two-mirror.yaml")),
                              "drivers: drivers.yaml", "drivers: " + drivers.string()));
  EXPECT_THAT(faults, HasSubstr("bad.yaml:2: drivers[0].setup_us: -1 is outside"));
  EXPECT_THAT(faults, HasSubstr("bad.yaml:2: drivers[0].space_us: missing"));
  EXPECT_THAT(faults, HasSubstr("bad.yaml:2: drivers[0].source: missing"));
}

TEST_F(MachineFaultsTest, ADriverNamedTwiceIsAFault) {
  const auto drivers = temp_.write(
      "twice.yaml",
      base::replaced(base::contentOf(base::fixture("machines/drivers.yaml")), "name: TB6560", "name: DM556"));
  EXPECT_THAT(faultsOf(base::replaced(base::contentOf(base::fixture("machines/two-mirror.yaml")),
                                      "drivers: drivers.yaml", "drivers: " + drivers.string())),
              HasSubstr("'DM556' is there twice"));
}

TEST_F(MachineFaultsTest, ANewerVersionIsRefused) {
  EXPECT_THAT(faultsOf(base::replaced(text("two-mirror.yaml"), "version: 1", "version: 2")),
              HasSubstr("version: this program reads version 1"));
}

TEST_F(MachineFaultsTest, ASensorThatTheMachineCanDoWithoutNeedsNoPin) {
  std::string content = base::replaced(text("two-mirror.yaml"), "  limit_y: PL1\n", "");
  EXPECT_EQ(faultsOf(content), "");
}

}  // namespace
}  // namespace kerfbench::machine_file
