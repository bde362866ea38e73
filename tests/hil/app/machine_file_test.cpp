// SPDX-License-Identifier: Apache-2.0
#include "hil/app/machine_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "hil/base/yaml_reader.h"
#include "tests/hil/app/temp_folder.h"
#include "twin/cutter/twin.h"

namespace kerfbench::hil {
namespace {

using testing::HasSubstr;
using twin::MachineDescription;

class MachineFile : public testing::Test {
 protected:
  static std::string text(const std::string& name) {
    return replaced(contentOf(fixture("machines/" + name)), "drivers: drivers.yaml",
                    "drivers: " + fixture("machines/drivers.yaml").string());
  }
  std::string faultsOf(const std::string& content) const {
    try {
      readMachine(temp_.write("m.yaml", content));
    } catch (const ConfigError& e) {
      return e.what();
    }
    return {};
  }
  const TempFolder temp_;
};

TEST_F(MachineFile, TheTwoMirrorMachineReads) {
  const MachineDescription machine = readMachine(fixture("machines/two-mirror.yaml"));
  EXPECT_EQ(machine.name, "two-mirror");
  EXPECT_EQ(machine.kind, MachineDescription::Kind::kTwoMirror);
  EXPECT_EQ(machine.throw_mm, 500.0);
  EXPECT_EQ(machine.mirror_spacing_mm, 15.0);
  for (const auto* galvo : {&machine.galvo_x, &machine.galvo_y}) {
    EXPECT_EQ(galvo->profile.name, "galvo-pul-dir");
    EXPECT_TRUE(galvo->profile.active_edge_rising);
    EXPECT_DOUBLE_EQ(galvo->profile.setup_s, 5e-6);
    EXPECT_DOUBLE_EQ(galvo->profile.width_s, 2.5e-6);
    EXPECT_EQ(galvo->step, 12.5e-6);
    EXPECT_EQ(galvo->inertia, 5e-7);
    EXPECT_DOUBLE_EQ(galvo->servo.natural_frequency_rad_s, 2.0 * std::numbers::pi * 1200.0);
  }
  EXPECT_EQ(machine.belt.feed.step, 0.0125);
  EXPECT_EQ(machine.belt.feed.inertia, machine.belt.roller_inertia_kg_m2);
  EXPECT_EQ(machine.signals.pin(Signal::kGalvoXPul), (PinId{0, 0}));
  EXPECT_EQ(machine.signals.pin(Signal::kEncoderA), (PinId{3, 2}));
  EXPECT_EQ(machine.signals.pin(Signal::kInterlock), (PinId{11, 2}));
  EXPECT_DOUBLE_EQ(machine.laser.rise_time_s, 20e-6);
  EXPECT_NO_THROW(twin::Twin(machine, twin::WebDescription{}, TickRate{}));
}

TEST_F(MachineFile, TheDelayThatTheControllerIsToldIsThatOfItsMirrors) {
  const MachineDescription machine = readMachine(fixture("machines/two-mirror.yaml"));
  EXPECT_NEAR(machine.controller.tracking_delay_s,
              2.0 * machine.galvo_x.servo.damping / machine.galvo_x.servo.natural_frequency_rad_s, 1e-8);
}

TEST_F(MachineFile, TheGantryReads) {
  const MachineDescription machine = readMachine(fixture("machines/strip-gantry.yaml"));
  EXPECT_EQ(machine.kind, MachineDescription::Kind::kGantry);
  EXPECT_EQ(machine.gantry_x.inertia, 12.0);
  EXPECT_EQ(machine.gantry_y.inertia, 3.0);
  EXPECT_EQ(machine.gantry_x.profile.name, "DM556");
  EXPECT_LT(machine.travel_min_mm[0], machine.controller.field_min_mm[0]);
  EXPECT_GT(machine.travel_max_mm[1], machine.controller.field_max_mm[1]);
  EXPECT_NO_THROW(twin::Twin(machine, twin::WebDescription{}, TickRate{}));
}

TEST_F(MachineFile, TheSpotCameraSeesItsCentreInTheMiddleOfThePicture) {
  std::string content = withValue(text("strip-gantry.yaml"), "centre_mm", "[370, -20]");
  content = withValue(withValue(content, "height_mm", "2500"), "pitch_mm", "0.2");
  const auto machine = readMachine(temp_.write("m.yaml", content));
  const Eigen::Vector3d centre = machine.spot_camera.X_CP * Eigen::Vector3d(370.0, -20.0, 0.0);
  EXPECT_NEAR(centre.x(), 0.0, 1e-9);
  EXPECT_NEAR(centre.y(), 0.0, 1e-9);
  EXPECT_NEAR(centre.z(), 2500.0, 1e-9);
  EXPECT_NEAR(machine.spot_camera.fx_px / centre.z(), 1.0 / 0.2, 1e-9);
}

TEST_F(MachineFile, EveryFaultIsListedWithItsLineAtOnce) {
  std::string bad = text("two-mirror.yaml");
  bad = replaced(bad, "throw_mm: 500", "throw_mm: -1");
  bad = replaced(bad, "damping: 0.7", "dampness: 0.7");
  bad = replaced(bad, "full_power_w: 100", "full_power_w: much");
  bad = replaced(bad, "roller_radius_mm: 30", "roller_radius_mm: .nan");
  bad = replaced(bad, "field_y_mm: [-80, 80]", "field_y_mm: [-80]");
  const std::string faults = faultsOf(bad);
  const auto at = [&](const char* part, const char* key) {
    EXPECT_THAT(faults, HasSubstr(fmt::format("m.yaml:{}: {}:", lineOf(bad, part), key)));
  };
  at("throw_mm: -1", "optics.throw_mm");
  at("dampness", "galvo_x.dampness");
  at("full_power_w: much", "laser.full_power_w");
  at("roller_radius_mm: .nan", "belt.roller_radius_mm");
  at("field_y_mm: [-80]", "controller.field_y_mm");
}

TEST_F(MachineFile, APinThatIsGivenTwiceIsNamedWithBothSignals) {
  const std::string bad = replaced(text("two-mirror.yaml"), "galvo_y_pul: PA2", "galvo_y_pul: PA0");
  const std::string faults = faultsOf(bad);
  EXPECT_THAT(faults, HasSubstr("PA0 is given to galvo_x_pul and to galvo_y_pul"));
  EXPECT_THAT(faults, HasSubstr(fmt::format("m.yaml:{}:", lineOf(bad, "galvo_y_pul"))));
}

TEST_F(MachineFile, ASignalThatIsGivenTwoPinsIsAFault) {
  const std::string bad =
      replaced(text("two-mirror.yaml"), "galvo_y_pul: PA2", "galvo_y_pul: PA2\n  galvo_y_pul: PB2");
  const std::string faults = faultsOf(bad);
  EXPECT_THAT(faults, HasSubstr("galvo_y_pul: given twice"));
  EXPECT_THAT(faults, HasSubstr(fmt::format("m.yaml:{}:", lineOf(bad, "galvo_y_pul: PB2"))));
}

TEST_F(MachineFile, WhatIsNoPinOrNoSignalIsAFaultAtItsLine) {
  for (const char* pin : {"A0", "PA", "PA16", "pA0", "PAx", "PA-1", "PA001", "7"}) {
    const std::string bad =
        replaced(text("two-mirror.yaml"), "laser_gate: PC2", fmt::format("laser_gate: {}", pin));
    EXPECT_THAT(faultsOf(bad), HasSubstr(fmt::format("m.yaml:{}: pins.laser_gate: '{}' is no pin",
                                                     lineOf(bad, "laser_gate"), pin)));
  }
  const std::string bad = replaced(text("two-mirror.yaml"), "laser_gate: PC2", "laser_gat: PC2");
  EXPECT_THAT(faultsOf(bad),
              HasSubstr(fmt::format("m.yaml:{}: pins.laser_gat: unknown", lineOf(bad, "laser_gat"))));
}

TEST_F(MachineFile, APinThatTheMachineNeedsIsMissed) {
  const std::string bad = replaced(text("two-mirror.yaml"), "  galvo_x_dir: PA1\n", "");
  EXPECT_THAT(faultsOf(bad), HasSubstr("pins.galvo_x_dir: has no pin"));
}

TEST_F(MachineFile, ADriverThatNobodyKnowsIsAFault) {
  const std::string bad = replaced(text("strip-gantry.yaml"), "driver: DM556", "driver: DM557");
  EXPECT_THAT(faultsOf(bad), HasSubstr(fmt::format("m.yaml:{}: gantry_x.driver: no driver 'DM557'",
                                                   lineOf(bad, "driver: DM557"))));
}

TEST_F(MachineFile, ABandwidthThatTheStepCannotFollowIsAFault) {
  const std::string bad = replaced(text("two-mirror.yaml"), "bandwidth_hz: 1200", "bandwidth_hz: 3200");
  EXPECT_THAT(faultsOf(bad), HasSubstr(fmt::format("m.yaml:{}: galvo_x.bandwidth_hz: 3200 is outside",
                                                   lineOf(bad, "3200"))));
  EXPECT_EQ(faultsOf(replaced(text("two-mirror.yaml"), "bandwidth_hz: 1200", "bandwidth_hz: 3180")), "");
}

TEST_F(MachineFile, ABridgeLighterThanItsCarriageIsAFault) {
  EXPECT_THAT(faultsOf(replaced(text("strip-gantry.yaml"), "mass_kg: 12", "mass_kg: 3")),
              HasSubstr("gantry_x.mass_kg: the bridge carries the carriage"));
}

TEST_F(MachineFile, TravelThatGoesBackwardsIsAFault) {
  const std::string bad = replaced(text("strip-gantry.yaml"), "y_mm: [-430, 430]", "y_mm: [430, -430]");
  EXPECT_THAT(faultsOf(bad), HasSubstr(fmt::format("m.yaml:{}: travel.y_mm:", lineOf(bad, "[430, -430]"))));
}

TEST_F(MachineFile, ACameraThatCannotBeIsAFault) {
  for (const auto& [key, value] : {std::pair("exposure_us", "1500"),
                                   {"exposure_us", "55"},
                                   {"size_px", "[0, 1800]"},
                                   {"size_px", "[1800, 1e7]"},
                                   {"size_px", "[1800.5, 1800]"},
                                   {"pitch_mm", "0"},
                                   {"psf_sigma_px", "-1"}}) {
    const std::string bad = withValue(text("two-mirror.yaml"), key, value);
    EXPECT_THAT(faultsOf(bad), HasSubstr(fmt::format(
                                   "m.yaml:{}: cameras.spot.{}:", lineOf(bad, std::string(key) + ": "), key)))
        << value;
  }
}

TEST_F(MachineFile, FaultsInTheFileOfDriversAreNamedThere) {
  const auto drivers =
      temp_.write("bad.yaml", "drivers:\n  - {name: X, setup_us: -1, hold_us: 1, width_us: 1}\n");
  const std::string faults = faultsOf(replaced(contentOf(fixture("machines/two-mirror.yaml")),
                                               "drivers: drivers.yaml", "drivers: " + drivers.string()));
  EXPECT_THAT(faults, HasSubstr("bad.yaml:2: drivers[0].setup_us: -1 is outside"));
  EXPECT_THAT(faults, HasSubstr("bad.yaml:2: drivers[0].space_us: missing"));
}

TEST_F(MachineFile, ANewerVersionIsRefused) {
  EXPECT_THAT(faultsOf(replaced(text("two-mirror.yaml"), "version: 1", "version: 2")),
              HasSubstr("version: this program reads version 1"));
}

TEST_F(MachineFile, ASensorThatTheMachineCanDoWithoutNeedsNoPin) {
  std::string content = replaced(text("two-mirror.yaml"), "  limit_y: PL1\n", "");
  EXPECT_EQ(faultsOf(content), "");
}

}  // namespace
}  // namespace kerfbench::hil
