// SPDX-License-Identifier: Apache-2.0
#include "hil/app/machine_file.h"

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/yaml_reader.h"

namespace kerfbench::hil {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using twin::MachineDescription;
namespace fs = std::filesystem;

const fs::path kMachines = fs::path(KERFBENCH_SOURCE_DIR) / "fixtures/machines";

/// A copy of the machines in a folder of its own, to be spoilt.
class MachineFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / (std::string("kerfbench-machine-") +
                                           testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::copy(kMachines, folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void replace(const std::string& file, const std::string& from, const std::string& to) const {
    std::string content = text(file);
    const auto at = content.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    std::ofstream(folder_ / file) << content.replace(at, from.size(), to);
  }
  /// Gives the first `key` of the file another value, whatever it has.
  void set(const std::string& file, const std::string& key, const std::string& value) const {
    const std::string content = text(file);
    const std::regex pattern("\\b" + key + ": *(\\[[^\\]]*\\]|[^\\s,}]+)");
    ASSERT_TRUE(std::regex_search(content, pattern)) << key;
    std::ofstream(folder_ / file) << std::regex_replace(content, pattern, key + ": " + value,
                                                        std::regex_constants::format_first_only);
  }
  [[nodiscard]] MachineDescription read(const std::string& file = "two-mirror.yaml") const {
    return readMachine(folder_ / file);
  }
  /// What is wrong with it; empty when nothing is.
  [[nodiscard]] std::string faults(const std::string& file = "two-mirror.yaml") const {
    try {
      (void)read(file);
      return {};
    } catch (const ConfigError& error) {
      return error.what();
    }
  }

 private:
  [[nodiscard]] std::string text(const std::string& file) const {
    std::ifstream in(folder_ / file);
    std::stringstream content;
    content << in.rdbuf();
    return content.str();
  }
  fs::path folder_;
};

TEST_F(MachineFile, TheHousesMachinesAreFineAndTheirControllersAreToldTheTruth) {
  const MachineDescription mirrors = read("two-mirror.yaml");
  EXPECT_EQ(mirrors.kind, MachineDescription::Kind::kTwoMirror);
  EXPECT_EQ(mirrors.controller.throw_mm, mirrors.throw_mm);
  EXPECT_EQ(mirrors.controller.mirror_spacing_mm, mirrors.mirror_spacing_mm);
  EXPECT_EQ(mirrors.controller.mirror_step_rad, mirrors.galvo_x.step);
  EXPECT_EQ(mirrors.controller.mirror_step_rad, mirrors.galvo_y.step);
  EXPECT_EQ(mirrors.controller.feed_step_mm, mirrors.belt.feed.step);
  const auto& servo = mirrors.galvo_x.servo;
  EXPECT_NEAR(mirrors.controller.tracking_delay_s, 2.0 * servo.damping / servo.natural_frequency_rad_s, 1e-8);

  const MachineDescription strip = read("strip-gantry.yaml");
  EXPECT_EQ(strip.kind, MachineDescription::Kind::kGantry);
  EXPECT_EQ(strip.controller.gantry_step_mm, strip.gantry_x.step);
  EXPECT_EQ(strip.controller.gantry_step_mm, strip.gantry_y.step);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_GT(strip.controller.field_min_mm.at(i), strip.travel_min_mm.at(i));
    EXPECT_LT(strip.controller.field_max_mm.at(i), strip.travel_max_mm.at(i));
  }
  for (const MachineDescription& machine : {mirrors, strip}) {
    EXPECT_EQ(machine.controller.encoder_count_mm, machine.belt.encoder_count_mm);
    EXPECT_EQ(machine.controller.print_mark_sensor_x_mm, machine.belt.print_mark_sensor_x_mm);
    EXPECT_EQ(machine.controller.full_power_w, machine.laser.full_power_w);
    EXPECT_EQ(twin::faultsOf(machine.spot_camera), "");
    EXPECT_EQ(twin::faultsOf(machine.kerf_camera), "");
  }
}

TEST_F(MachineFile, TheSpotCameraSeesTheWholeField) {
  for (const char* file : {"two-mirror.yaml", "strip-gantry.yaml"}) {
    const MachineDescription machine = read(file);
    const auto& camera = machine.spot_camera;
    const auto& told = machine.controller;
    for (const double x : {told.field_min_mm[0], told.field_max_mm[0]}) {
      for (const double y : {told.field_min_mm[1], told.field_max_mm[1]}) {
        const Eigen::Vector3d p = camera.X_CP * Eigen::Vector3d(x, y, 0.0);
        ASSERT_GT(p.z(), 0.0);  // In front of the camera.
        const Eigen::Vector2d n = p.head<2>() / p.z();
        const double stretch = 1.0 + camera.distortion[0] * n.squaredNorm();
        EXPECT_NEAR(camera.fx_px * stretch * n.x() + camera.cx_px, 0.5 * camera.width_px,
                    0.5 * camera.width_px - 5);
        EXPECT_NEAR(camera.fy_px * stretch * n.y() + camera.cy_px, 0.5 * camera.height_px,
                    0.5 * camera.height_px - 5);
      }
    }
  }
}

TEST_F(MachineFile, TheDriveProfilesAreThoseOfTheDataSheets) {
  set("two-mirror.yaml", "driver", "Gecko201");
  const DriverProfile profile = read().galvo_x.profile;
  EXPECT_EQ(profile.name, "Gecko201");
  EXPECT_FALSE(profile.active_edge_rising);
  EXPECT_DOUBLE_EQ(profile.setup_s, 1e-6);
  EXPECT_DOUBLE_EQ(profile.hold_s, 20e-6);
  EXPECT_DOUBLE_EQ(profile.width_s, 0.5e-6);
  EXPECT_DOUBLE_EQ(profile.space_s, 4e-6);
}

TEST_F(MachineFile, EveryFaultIsNamedAtOnceWithItsLine) {
  set("two-mirror.yaml", "throw_mm", "-5");
  replace("two-mirror.yaml", "roller_radius_mm: 30", "roller_radios_mm: 30");
  set("two-mirror.yaml", "driver", "nobody");
  set("two-mirror.yaml", "galvo_y_pul", "PA0");
  const std::string all = faults();
  EXPECT_THAT(all, HasSubstr("throw_mm: -5 is outside"));
  EXPECT_THAT(all, HasSubstr("roller_radios_mm"));
  EXPECT_THAT(all, HasSubstr("roller_radius_mm"));
  EXPECT_THAT(all, HasSubstr("no driver 'nobody'"));
  EXPECT_THAT(all, HasSubstr("PA0 is given to galvo_x_pul and to galvo_y_pul"));
  EXPECT_THAT(all, HasSubstr("two-mirror.yaml:"));
}

TEST_F(MachineFile, APinThatTheMachineNeedsMustBeWired) {
  replace("two-mirror.yaml", "  laser_gate: PC2\n", "");
  replace("two-mirror.yaml", "  gantry_x_pul: PA4\n", "");  // Not needed by mirrors.
  EXPECT_THAT(faults(), ContainsRegex("laser_gate:? has no pin"));
  EXPECT_THAT(faults(), testing::Not(HasSubstr("gantry")));
  replace("strip-gantry.yaml", "  gantry_x_dir: PA5\n", "");
  EXPECT_THAT(faults("strip-gantry.yaml"), ContainsRegex("gantry_x_dir:? has no pin"));
}

TEST_F(MachineFile, AnExposureThatTheTwinCannotTakeIsRefused) {
  set("two-mirror.yaml", "exposure_us", "55");
  EXPECT_THAT(faults(), HasSubstr("exposure_us: must be a multiple of 10"));
  set("two-mirror.yaml", "exposure_us", "2000");
  EXPECT_THAT(faults(), HasSubstr("exposure_us: is longer than"));
}

TEST_F(MachineFile, APictureOfAnImpossibleSizeIsRefused) {
  set("two-mirror.yaml", "size_px", "[1e30, 1799.5]");
  EXPECT_THAT(faults(), HasSubstr("1e+30 is no whole number"));
  EXPECT_THAT(faults(), HasSubstr("1799.5 is no whole number"));
}

TEST_F(MachineFile, AServoThatTheStepCannotFollowIsRefused) {
  set("two-mirror.yaml", "bandwidth_hz", "8000");
  EXPECT_THAT(faults(), HasSubstr("bandwidth_hz: 8000 is outside"));
}

TEST_F(MachineFile, ABridgeLighterThanItsCarriageIsRefused) {
  set("strip-gantry.yaml", "mass_kg", "2");
  EXPECT_THAT(faults("strip-gantry.yaml"), HasSubstr("the bridge carries the carriage"));
}

TEST_F(MachineFile, AFieldOrATravelTurnedRoundIsRefused) {
  set("strip-gantry.yaml", "field_y_mm", "[420, -420]");
  set("strip-gantry.yaml", "x_mm", "[800, -40]");
  EXPECT_THAT(faults("strip-gantry.yaml"),
              HasSubstr("controller.field_y_mm: the second value must be the larger"));
  EXPECT_THAT(faults("strip-gantry.yaml"), HasSubstr("travel.x_mm: the second value must be the larger"));
}

TEST_F(MachineFile, ADriverNamedTwiceIsRefused) {
  replace("drivers.yaml", "name: TB6560", "name: DM556");
  EXPECT_THAT(faults(), HasSubstr("'DM556' is there twice"));
}

}  // namespace
}  // namespace kerfbench::hil
