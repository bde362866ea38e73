// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/run_files.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/campaign/key_tree.h"
#include "hil/machine_file/machine_file.h"
#include "hil/scenario/scenario.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::campaign {
namespace {

using testing::HasSubstr;

/// A release that nobody runs.
scenario::ImagePath imagesIn(const base::TempFolder& folder) {
  (void)folder.write("controller-native", "");
  return {folder.path()};
}

Campaign campaignOf(const base::TempFolder& folder, const std::string& text,
                    const std::string& base = "scenarios/native/label-on-belt.yaml") {
  return readCampaign(
      folder.write("c.yaml", "version: 1\nname: c\nbase: " + base::fixture(base).string() + "\n" + text));
}

TEST(KeyTree, KeysBecomeSections) {
  EXPECT_EQ(yamlOf({{"b.c.d", "1"}, {"a", "[1, 2]"}, {"b.e", "x"}}),
            "a: [1, 2]\nb:\n  e: x\n  c:\n    d: 1\n");
  EXPECT_TRUE(isKeyPath("a.b_c.d-2"));
  for (const char* bad : {"", ".", "a.", ".a", "a..b", "a b", "a:b", "a[0].b"})
    EXPECT_FALSE(isKeyPath(bad)) << bad;
}

TEST(RunFiles, AnUnchangedMachineIsTheBases) {
  const base::TempFolder folder;
  const Campaign c = campaignOf(folder, "factors: [{name: speed, key: belt.speed_mm_s, values: [33]}]\n");
  const std::filesystem::path file = writeRunFiles(c, planOf(c, 0), folder.path());
  EXPECT_EQ(file.filename(), "000000.yaml");
  const scenario::Scenario s = scenario::readScenario(file, imagesIn(folder));
  EXPECT_EQ(s.name, "c-000000");
  EXPECT_EQ(s.belt_speed_mm_s, 33.0);
  EXPECT_EQ(s.seed, *planOf(c, 0).seed);
  EXPECT_EQ(s.machine, base::fixture("machines/two-mirror.yaml"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "000000.machine.yaml"));
}

TEST(RunFiles, AChangedMachineHasAFileOfItsOwn) {
  const base::TempFolder folder;
  const Campaign c = campaignOf(folder,
                                "set_machine: {laser: {gate_delay_us: 5}}\n"
                                "factors:\n"
                                "  - name: f\n"
                                "    faults:\n"
                                "      - name: scale\n"
                                "        size: [0.25]\n"
                                "        changes:\n"
                                "          - {machine: controller.encoder_count_mm, scale_by: 2}\n"
                                "          - {machine: controller.throw_mm, shift_by: -4}\n"
                                "          - {machine: controller.field_x_mm, set: '[-70, 7{size}]'}\n");
  const std::filesystem::path file = writeRunFiles(c, planOf(c, 0), folder.path());
  const scenario::Scenario s = scenario::readScenario(file, imagesIn(folder));
  EXPECT_EQ(s.machine, folder.path() / "000000.machine.yaml");
  const machine_file::MachineFile m = machine_file::readMachineFile(s.machine);
  EXPECT_DOUBLE_EQ(m.machine.controller.encoder_count_mm, 0.01 * 1.5);
  EXPECT_DOUBLE_EQ(m.machine.controller.throw_mm, 499.0);
  EXPECT_DOUBLE_EQ(m.machine.controller.field_max_mm[0], 70.25);
  // All else is the base's, its calibrations as well.
  const machine_file::MachineFile base =
      machine_file::readMachineFile(base::fixture("machines/two-mirror.yaml"));
  EXPECT_EQ(m.spot_camera.calibration, base.spot_camera.calibration);
  EXPECT_EQ(m.machine.controller.mirror_step_rad, base.machine.controller.mirror_step_rad);
}

TEST(RunFiles, ACalibrationThatLiesBesideTheMachineUnnamedIsNamed) {
  const base::TempFolder folder;
  const std::string machine = base::fixture("machines/two-mirror.yaml").string();
  (void)folder.write("m.yaml", "extends: " + machine + "\ncameras: {spot: {calibration: ~}}\n");
  (void)folder.write("m.spot.camera.yaml",
                     base::contentOf(base::fixture("machines/two-mirror.spot.camera.yaml")));
  (void)folder.write("s.yaml", "extends: " + base::fixture("scenarios/native/label-on-belt.yaml").string() +
                                   "\nname: s\nmachine: m.yaml\n");
  const Campaign c =
      readCampaign(folder.write("c.yaml",
                                "version: 1\nname: c\nbase: s.yaml\n"
                                "factors: [{name: d, machine: laser.gate_delay_us, values: [3]}]\n"));
  std::filesystem::create_directories(folder.path() / "out");
  const scenario::Scenario s =
      scenario::readScenario(writeRunFiles(c, planOf(c, 0), folder.path() / "out"), imagesIn(folder));
  EXPECT_EQ(machine_file::readMachineFile(s.machine).spot_camera.calibration,
            folder.path() / "m.spot.camera.yaml");
}

TEST(RunFiles, AnotherMachineMayBeAFactorAndIsChangedAsWell) {
  const base::TempFolder folder;
  (void)folder.write("slow.yaml",
                     "extends: " + base::fixture("machines/two-mirror.yaml").string() + "\nname: slow\n");
  const Campaign c = campaignOf(folder,
                                "factors:\n"
                                "  - {name: m, key: machine, values: [./slow.yaml]}\n"
                                "  - {name: d, machine: laser.gate_delay_us, values: [3]}\n");
  std::filesystem::create_directories(folder.path() / "out");
  const std::filesystem::path file = writeRunFiles(c, planOf(c, 0), folder.path() / "out");
  EXPECT_THAT(base::contentOf(folder.path() / "out" / "000000.machine.yaml"),
              HasSubstr("extends: \"../slow.yaml\""));
  EXPECT_EQ(scenario::readScenario(file, imagesIn(folder)).machine,
            folder.path() / "out" / "000000.machine.yaml");
}

TEST(RunFiles, ANumberThatTheBaseDoesNotGiveIsToldWithItsKey) {
  const base::TempFolder folder;
  const auto faultOf = [&](const std::string& key) -> std::string {
    const Campaign c =
        campaignOf(folder, "factors: [{name: f, faults: [{name: s, size: [1], changes: [{key: " + key +
                               ", scale_by: 1}]}]}]\n");
    try {
      (void)runFilesOf(c, planOf(c, 0), folder.path());
    } catch (const base::ConfigError& e) {
      return e.what();
    }
    return {};
  };
  EXPECT_THAT(faultOf("planner.jerk_mm_s3"), HasSubstr("planner.jerk_mm_s3"));
  EXPECT_THAT(faultOf("planner.jerk_mm_s3"), HasSubstr("there is none"));
  EXPECT_THAT(faultOf("belt.profile"), HasSubstr("it is 'constant'"));
  EXPECT_EQ(faultOf("belt.speed_mm_s"), "");
}

}  // namespace
}  // namespace kerfbench::campaign
