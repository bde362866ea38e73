// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/case.h"
#include "firmware_under_test/planner/program/job_issues.h"

#include <algorithm>
#include <set>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/power/model.h"
#include "firmware_under_test/planner/program/plan.h"
#include "hil/base/yaml_reader.h"
#include "hil/dieline/geometry.h"
#include "hil/run/dialogs.h"
#include "hil/scenario/pul_axes.h"
#include "tests/hil/base/temp_folder.h"
#include "twin/optics/scan_head.h"

namespace kerfbench::scenario {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class CaseTest : public testing::Test {
 protected:
  void SetUp() override { (void)temp_.write("controller-avr.hex", ":00000001FF\n"); }
  Case label(const std::string& lines) const {
    const auto path =
        temp_.write("s.yaml", "extends: " + base::fixture("scenarios/label-on-belt.yaml").string() +
                                  "\nname: changed\n" + lines);
    return readCase(path, temp_.path());
  }
  std::string faultsOf(const std::string& lines) const {
    try {
      label(lines);
    } catch (const base::ConfigError& e) {
      return e.what();
    }
    return {};
  }
  const base::TempFolder temp_;
};

TEST_F(CaseTest, TheFirstEyeMarkReachesItsSensorAfterTheLeadTime) {
  const Case test_case = label("belt: {lead_s: 0.7}\n");
  const twin::WebDescription web = webOf(test_case);
  const double mark_mm = web.start_x_mm + web.print.eye_mark_x_mm + 0.7 * web.belt_speed_mm_s;
  EXPECT_NEAR(mark_mm, test_case.machine.belt.print_mark_sensor.x_mm, 1e-9);
  EXPECT_EQ(plannerJob(test_case).web_start_x_mm, web.start_x_mm);
}

TEST_F(CaseTest, ThePlannerIsToldTheDataSheetAndNotTheTruth) {
  Case test_case = label("");
  test_case.machine.head.throw_mm = 512.0;
  test_case.machine.belt.encoder.count_mm = 0.02;
  EXPECT_EQ(plannerMachine(test_case).throw_mm, 500.0);
  EXPECT_EQ(plannerMachine(test_case).encoder_count_mm, 0.01);
}

TEST_F(CaseTest, TheMachineSetsTheRadiusOfJumpsAndTheScenarioWins) {
  const auto path =
      temp_.write("slow.yaml", "extends: " + base::fixture("machines/two-mirror-slow.yaml").string() + "\n");
  const std::string slow = "machine: " + path.string() + "\n";
  EXPECT_EQ(plannerJob(label("")).jump_radius_mm, 0.0);
  EXPECT_EQ(plannerJob(label(slow)).jump_radius_mm, 5.0);
  EXPECT_EQ(plannerMachine(label(slow)).mirror_acceleration_rad_s2, 9.0);
  EXPECT_EQ(plannerJob(label(slow + "planner: {jump_radius_mm: 0}\n")).jump_radius_mm, 0.0);
  EXPECT_EQ(plannerJob(label("planner: {jump_radius_mm: -1}\n")).jump_radius_mm, planner::kRadiusOfDrawing);
  EXPECT_EQ(plannerJob(label("planner: {jump_acceleration_mm_s2: 5000}\n")).jump_acceleration_mm_s2, 5000.0);
  EXPECT_THAT(faultsOf("planner: {jump_radius_mm: -0.5}\n"),
              HasSubstr("planner.jump_radius_mm: is a radius"));
}

TEST_F(CaseTest, TheBeltHasALowestAndAHighestSpeed) {
  const Case told = label("belt: {min_mm_s: 59, max_mm_s: 61, profile: [{at_s: 1, speed_mm_s: 60.5}]}\n");
  EXPECT_EQ(plannerJob(told).belt_min_mm_s, 59.0);
  EXPECT_EQ(plannerJob(told).belt_max_mm_s, 61.0);
  EXPECT_EQ(plannerJob(label("")).belt_max_mm_s, 0.0);
  EXPECT_THAT(
      faultsOf("belt: {min_mm_s: 59, max_mm_s: 61, profile: [{at_s: 1, speed_mm_s: 61.5}, {at_s: 2, "
               "speed_mm_s: 58}]}\n"),
      AllOf(HasSubstr("belt.profile: 61.5 mm/s at 1 s is outside"), HasSubstr("58 mm/s at 2 s is outside")));
}

TEST_F(CaseTest, PowerIsByEnergyOrByDepth) {
  const std::string power = fmt::format(
      "planner: {{power: {{material: {}, laser: {}, spot_diameter_mm: 0.2, ",
      base::fixture("power/mild-steel.yaml").string(), base::fixture("power/co2-tube-80w.yaml").string());
  EXPECT_EQ(plannerJob(label("")).power, nullptr);
  const Case by_depth = label(power + "depth_mm: 0.3, half_depth_mm: 0.1}}\n");
  ASSERT_NE(plannerJob(by_depth).power, nullptr);
  EXPECT_EQ(plannerJob(by_depth).power->depthOf(1.0, 0.5), 0.3);
  EXPECT_EQ(plannerJob(by_depth).power->depthOf(0.5, 0.5), 0.1);
  EXPECT_THAT(faultsOf(power + "depth_mm: 0.5}}\n"),
              HasSubstr("s.yaml:3: planner.power.depth_mm: depth: 0.5 mm cannot be had in mild steel"));
  const auto broken = temp_.write("broken.yaml", "version: 1\nkind: laser\n");
  EXPECT_THAT(
      faultsOf("planner: {power: {material: no.yaml, laser: " + broken.string() + ", width: 3}}\n"),
      AllOf(HasSubstr("planner.power.material: no such file 'no.yaml'"),
            HasSubstr("planner.power.depth_mm: missing"), HasSubstr("planner.power.laser: cannot be used"),
            HasSubstr("broken.yaml:1: points: 0 of them"), HasSubstr("planner.power.width: unknown key")));
}

TEST_F(CaseTest, MaterialAndLaserAreEntriesOfALibrary) {
  const std::string library = base::fixture("power").string();
  const auto power = [&](const std::string& keys) {
    return fmt::format("planner: {{power: {{{}, spot_diameter_mm: 0.2, depth_mm: 0.3}}}}\n", keys);
  };
  const Case by_number = label(power("library: " + library + ", material: 1, laser: 1"));
  ASSERT_NE(plannerJob(by_number).power, nullptr);
  EXPECT_EQ(plannerJob(by_number).power->material().name, "mild steel");
  EXPECT_TRUE(std::ranges::count(by_number.inputs, base::fixture("power/mild-steel.yaml")) == 1);
  const Case by_name =
      label(power("library: " + library + ", material: carton board 0.4 mm, laser: CO2 Tube 80 W"));
  EXPECT_EQ(plannerJob(by_name).power->material().number, 2);
  EXPECT_THAT(faultsOf(power("material: 1, laser: 1")),
              AllOf(HasSubstr("planner.power.material: '1' is no .yaml file, and no `library` has it"),
                    HasSubstr("planner.power.laser: '1' is no .yaml file")));
  EXPECT_THAT(faultsOf(power("library: " + library + ", material: 9, laser: tube")),
              AllOf(HasSubstr("there is no material '9'; there are 1 (mild steel), 2 (carton board 0.4 mm)"),
                    HasSubstr("there is no laser 'tube'")));
  EXPECT_THAT(faultsOf(power("library: nowhere, material: 1, laser: 1")),
              HasSubstr("planner.power.library: " + (temp_.path() / "nowhere").string() + ": is no folder"));
}

TEST_F(CaseTest, WhatMayBeLostIsNamed) {
  EXPECT_EQ(plannerJob(label("planner: {allow_lost_features: 'E3,7-9'}\n")).allow_lost,
            (planner::EntityRanges{{3, 3}, {7, 9}}));
  EXPECT_THAT(
      faultsOf("planner: {allow_lost_features: true}\n"),
      HasSubstr("planner.allow_lost_features: what may be lost: 'true' is neither an id nor a range"));
}

TEST_F(CaseTest, OpenCutsAreJudgedWhereThePlannerPutsTheKerf) {
  using OpenCuts = inspect::Tolerances::OpenCuts;
  const auto sideOf = [&](const std::string& lines) { return label(lines).scenario.limits.open_cuts; };
  EXPECT_EQ(sideOf("planner: {open_cuts: left}\n"), OpenCuts::kCentre);  // Without a kerf it is on the line.
  EXPECT_EQ(sideOf("planner: {kerf_radius_mm: 0.05, open_cuts: left}\n"), OpenCuts::kLeft);
  EXPECT_EQ(sideOf("planner: {kerf_radius_mm: 0.05, open_cuts: right}\n"), OpenCuts::kRight);
  EXPECT_EQ(sideOf("planner: {kerf_radius_mm: 0.05, open_cuts: left}\nchecks: {open_cuts: right}\n"),
            OpenCuts::kRight);
}

TEST_F(CaseTest, AxesThatTheMachineHasNotAreSpare) {
  const Case test_case = label("");
  const std::vector<Signal> spare = spareOutputs(test_case.machine, false);
  for (const Signal signal :
       {Signal::kGantryXPul, Signal::kGantryYDir, Signal::kGantryXEnable, Signal::kFeedPul, Signal::kFeedDir})
    EXPECT_EQ(std::ranges::count(spare, signal), 1) << signalName(signal);
  for (const Signal signal : {Signal::kGalvoXPul, Signal::kGalvoYDir, Signal::kLaserGate, Signal::kLaserPwm})
    EXPECT_EQ(std::ranges::count(spare, signal), 0) << signalName(signal);
  EXPECT_EQ(std::ranges::count(spareOutputs(test_case.machine, true), Signal::kFeedPul), 0);
}

TEST_F(CaseTest, AMachineWithoutAFeedDriveCannotFeed) {
  const auto path =
      temp_.write("no-feed.yaml",
                  "extends: " + base::fixture("machines/two-mirror.yaml").string() + "\nbelt: {feed: ~}\n");
  const std::string lines = "machine: " + path.string() + "\n";
  EXPECT_EQ(faultsOf(lines), "");
  EXPECT_THAT(faultsOf(lines + "belt: {drive: controller}\n"), HasSubstr("feed"));
}

TEST_F(CaseTest, NamesEveryFileOnWhichTheRunDepends) {
  std::set<std::string> names;
  const Case test_case = label("");
  for (const std::filesystem::path& input : test_case.inputs) {
    EXPECT_TRUE(input.is_absolute()) << input;
    EXPECT_TRUE(names.insert(input.filename().string()).second) << input;
  }
  // The scenario, what it extends, and what these and the machine name.
  EXPECT_THAT(names, ::testing::IsSupersetOf({"s.yaml", "label-on-belt.yaml", "label-60x40.dxf",
                                              "two-mirror.yaml", "drivers.yaml",
                                              "two-mirror.spot.camera.yaml", "two-mirror.kerf.camera.yaml"}));
  EXPECT_EQ(names.size(), test_case.inputs.size());
}

TEST_F(CaseTest, WhatIsNotSelectedIsNeitherCutNorJudged) {
  const Case test_case = label("select: {entities: '0-3'}\n");
  int cut = 0;
  for (const dieline::Entity& entity : test_case.dieline->entities)
    cut += entity.process != dieline::Process::kIgnore ? 1 : 0;
  EXPECT_EQ(cut, 4);
  EXPECT_THAT(faultsOf("select: {entities: '0-x', process: burn}\n"),
              AllOf(HasSubstr("'0-x'"), HasSubstr("'burn'"), HasSubstr("s.yaml:3")));
  EXPECT_THAT(faultsOf("select: {entities: '70'}\n"), HasSubstr("select: E70: there is no such entity"));
}

/// The label's drawing has a window (E8) in an outline (E0 to E7).
TEST_F(CaseTest, WhatIsNotSelectedStillCountsForTheNesting) {
  const std::string lines = "select: {entities: '8'}\nplanner: {kerf_radius_mm: 0.066, order: ";
  for (const std::string order : {"shortest", "nearest", "drawn"}) {
    const Case test_case = label(lines + order + "}\nchecks: {edge: nesting}\n");
    for (const dieline::Entity& entity : test_case.dieline->entities) {
      EXPECT_EQ(dieline::drawnFor(entity), dieline::Process::kCut);
      EXPECT_EQ(entity.left_out.has_value(), entity.id != 8);
    }
    const std::string gcode =
        planner::makeGcode(*test_case.dieline, plannerMachine(test_case), plannerJob(test_case));
    EXPECT_THAT(gcode, HasSubstr("I-2.4340"));
  }
}

TEST_F(CaseTest, WhatIsNotSelectedMustBeFitIfItCountsForTheNesting) {
  (void)temp_.write("twice.svg",
                    "<svg xmlns='http://www.w3.org/2000/svg' width='90mm' height='90mm' viewBox='0 0 90 90'>"
                    "<g fill='none' stroke='#ff0000'><circle cx='40' cy='40' r='20'/>"
                    "<circle cx='40' cy='40' r='20'/><circle cx='40' cy='40' r='5'/></g></svg>");
  const std::string lines = "dieline: twice.svg\nlayers: {'#ff0000': cut}\nselect: {entities: '2'}\n";
  EXPECT_EQ(faultsOf(lines), "");
  for (const std::string more : {"checks: {edge: nesting}\n", "planner: {kerf_radius_mm: 0.1}\n"}) {
    EXPECT_THAT(faultsOf(lines + more),
                AllOf(HasSubstr("s.yaml: select: the whole drawing"), HasSubstr("repeats")));
  }
}

TEST_F(CaseTest, GcodeEditedByHandTakesThePlaceOfThePlanners) {
  (void)temp_.write("controller-avr.hex",
                    base::contentOf(KERFBENCH_BINARY_DIR "/firmware/controller-avr.hex"));
  (void)temp_.write("edited.nc", "G00 X-10 Y0 Z0\nG01 X-20 Y0 Z1\n");
  const run::PreparedJob job = run::prepareJob(label("planner: {gcode: edited.nc}\n"));
  EXPECT_EQ(job.gcode, "G00 X-10 Y0 Z0\nG01 X-20 Y0 Z1\n");
  EXPECT_THAT(faultsOf("planner: {gcode: lost.nc}\n"), HasSubstr("no such file 'lost.nc'"));
}

TEST_F(CaseTest, WiresOfForeignRecordingsHaveTheirSignals) {
  const Case test_case = label("wires: {galvo_x_pul: X_STEP, encoder_a: 'ENC A'}\n");
  using Wires = std::vector<std::pair<Signal, std::string>>;
  EXPECT_EQ(test_case.scenario.wires, (Wires{{Signal::kGalvoXPul, "X_STEP"}, {Signal::kEncoderA, "ENC A"}}));
  EXPECT_THAT(faultsOf("wires: {x_step: X, galvo_x_pul: X, galvo_y_pul: X}\n"),
              AllOf(HasSubstr("s.yaml:3: wires: 'x_step' is no signal"),
                    HasSubstr("the wire 'X' is given to two signals")));
}

class LineOkCase : public CaseTest {
 protected:
  [[nodiscard]] std::filesystem::path plate(const std::string& firmware) const {
    (void)temp_.write("linecutter-avr.hex", "");
    return temp_.write("s.yaml", "extends: " + base::fixture("scenarios/line-ok/plate.yaml").string() +
                                     "\nfirmware: {" + firmware + "}\n");
  }
  [[nodiscard]] FirmwareChoice firmwareOf(const std::string& firmware) const {
    return readScenarioFile(plate(firmware), {temp_.path()}).scenario.firmware;
  }
  [[nodiscard]] std::string faultsIn(const std::string& firmware) const {
    try {
      (void)firmwareOf(firmware);
    } catch (const base::ConfigError& e) {
      return e.what();
    }
    return {};
  }
};

TEST_F(LineOkCase, SetupLinesAndTheReceiveBufferAreRead) {
  const FirmwareChoice usual = firmwareOf("");
  EXPECT_TRUE(usual.setup.empty());
  EXPECT_EQ(usual.ahead_bytes, 0U);
  const FirmwareChoice own = firmwareOf("setup: ['$X', $32=1], ahead_bytes: 127");
  EXPECT_EQ(own.setup, (std::vector<std::string>{"$X", "$32=1"}));
  EXPECT_EQ(own.ahead_bytes, 127U);
  EXPECT_THAT(
      faultsIn("setup: [\"$X\\n$H\"], ahead_bytes: -1"),
      AllOf(HasSubstr("s.yaml:2: firmware.setup: a line has"), HasSubstr("ahead_bytes: -1 is outside")));
  EXPECT_THAT(faultsIn("setup: ['" + std::string(256, 'x') + "']"), HasSubstr("up to 255 characters"));
  EXPECT_EQ(faultsIn("setup: ['" + std::string(255, 'x') + "']"), "");
}

TEST_F(LineOkCase, TheEepromIsAFileOrBlank) {
  (void)temp_.write("settings.eep", "");
  EXPECT_TRUE(firmwareOf("").eeprom.empty());
  EXPECT_FALSE(firmwareOf("").eeprom_blank);
  EXPECT_TRUE(firmwareOf("eeprom: blank").eeprom_blank);
  EXPECT_EQ(firmwareOf("eeprom: settings.eep").eeprom, temp_.path() / "settings.eep");
  EXPECT_THAT(faultsIn("eeprom: lost.eep"), HasSubstr("no such file 'lost.eep'"));
  EXPECT_THAT(faultsIn("source: native, eeprom: blank"), HasSubstr("eeprom: is for an emulated release"));
  const auto inputs = readScenarioFile(plate("eeprom: settings.eep"), {temp_.path()}).scenario.inputs;
  EXPECT_EQ(std::ranges::count(inputs, temp_.path() / "settings.eep"), 1) << "or the digest does not bind it";
}

// The table is found by trial: where to aim the head of the twin so that its spot lands on the node.
TEST_F(CaseTest, AnFThetaHeadIsTrueWithItsTable) {
  const twin::MachineDescription machine =
      machine_file::readMachine(base::fixture("machines/f-theta-300.yaml"));
  const twin::ScanHead head(machine.head, machine.beam);
  const twin::Surface board{machine.surface};
  const double f_mm = 430.0;
  const auto spotOf = [&](const Eigen::Vector2d& mirror_rad) -> Eigen::Vector2d {
    return head.spotAt(mirror_rad, Eigen::Vector2d::Zero(), board, 0.0).value().p_WQ_mm.head<2>();
  };
  std::string table = "x_mm,y_mm,dx_mm,dy_mm\n";
  constexpr int kNodes = 33;
  for (int i = 0; i < kNodes * kNodes; ++i) {
    const Eigen::Vector2d p(-150.0 + 300.0 * (i % kNodes) / (kNodes - 1),
                            -150.0 + 300.0 * (i / kNodes) / (kNodes - 1));
    Eigen::Vector2d aim = p;
    for (int k = 0; k < 60; ++k) aim += p - spotOf(aim / (2.0 * f_mm));
    table += fmt::format("{},{},{},{}\n", p.x(), p.y(), aim.x() - p.x(), aim.y() - p.y());
  }
  (void)temp_.write("t.csv", table);
  const std::string corrected = "extends: " + base::fixture("machines/f-theta-300.yaml").string() +
                                "\ncontroller: {focal_length_mm: 430, correction: t.csv}\n";
  const auto worst = [&](const std::string& lines) {
    const auto path = temp_.write("f.yaml", lines);
    const planner::MachineParameters told = plannerMachine(label("machine: " + path.string() + "\n"));
    const planner::Axes axes(told, {});
    EXPECT_TRUE(planner::jobIssues(told, planner::JobParameters{.cut_energy_j_per_mm = 0.1}).empty());
    double worst_mm = 0.0;
    for (int i = 0; i < 61 * 61; ++i) {
      const Eigen::Vector2d p(-149.0 + 4.96 * (i % 61), -149.0 + 4.96 * (i / 61));
      worst_mm = std::max(worst_mm, (spotOf(axes.stepsAt(p) * told.mirror_step_rad) - p).norm());
    }
    return worst_mm;
  };
  EXPECT_LT(worst(corrected), 0.001);
  EXPECT_GT(worst("extends: " + base::fixture("machines/f-theta-300.yaml").string() +
                  "\ncontroller: {focal_length_mm: 430}\n"),
            1.0);
  EXPECT_THAT(
      faultsOf("machine: " + temp_.write("f.yaml", corrected + "surface: {height_mm: x}\n").string() + "\n"),
      HasSubstr("height_mm"));
  EXPECT_THAT(
      faultsOf("machine: " +
               temp_
                   .write("f.yaml", "extends: " + base::fixture("machines/f-theta-300.yaml").string() +
                                        "\ncontroller: {correction: lost.csv}\n")
                   .string() +
               "\n"),
      HasSubstr("no such file 'lost.csv'"));
}

TEST_F(CaseTest, ALineMayChangeItsSpeed) {
  const Case test_case =
      label("belt: {profile: [{at_s: 1.0, speed_mm_s: 70}, {at_s: 2.5, speed_mm_s: 0}]}\n");
  const twin::WebDescription web = webOf(test_case);
  ASSERT_EQ(web.belt_speed_changes.size(), 2U);
  EXPECT_EQ(web.belt_speed_changes[1].time_s, 2.5);
  EXPECT_EQ(web.belt_speed_changes[0].speed_mm_s, 70.0);
  EXPECT_EQ(web.belt_speed_mm_s, 60.0);
  EXPECT_THAT(faultsOf("belt: {profile: [{at_s: 2, speed_mm_s: 70}, {at_s: 1, speed_mm_s: 0}]}\n"),
              HasSubstr("at_s: must be later than the point before"));
  EXPECT_THAT(faultsOf("belt: {profile: wild}\n"), HasSubstr("belt.profile: 'wild' is none of: constant"));
  EXPECT_THAT(faultsOf("belt: {drive: controller, profile: [{at_s: 2, speed_mm_s: 70}]}\n"),
              HasSubstr("belt.profile: is the line's"));
}

TEST_F(CaseTest, ABoardMayHaveADepthCurveAndScorch) {
  const Case test_case = label(
      "board: {depth_curve: [{fluence_share: 0.2, depth_share: 0}, {fluence_share: 1, depth_share: 1}], "
      "scorch: {fluence_j_mm2: 0.3, darkening: 0.2, shift_mm: [0.05, 0]}}\n");
  const twin::BoardDescription board = webOf(test_case).board;
  ASSERT_EQ(board.depth_curve.size(), 2U);
  EXPECT_EQ(board.depth_curve[0].fluence_share, 0.2);
  EXPECT_EQ(board.scorch.fluence_j_mm2, 0.3);
  EXPECT_EQ(board.scorch.shift_mm[0], 0.05);
  EXPECT_THAT(faultsOf("board: {depth_curve: [{fluence_share: 1, depth_share: 1}]}\n"),
              HasSubstr("board.depth_curve: must go from depth_share 0"));
}

TEST_F(CaseTest, AMachineIsDrawnAroundItsDescriptionByPresetAndSeed) {
  const auto drawn = [&](const char* lines) { return sampledMachine(label(lines)); };
  EXPECT_TRUE(drawn("").imperfections.empty());
  const auto one = drawn("imperfections: dynamic\nseed: 7\n");
  const auto again = drawn("imperfections: dynamic\nseed: 7\n");
  const auto other = drawn("imperfections: dynamic\nseed: 8\n");
  ASSERT_FALSE(one.imperfections.empty());
  ASSERT_EQ(one.imperfections.size(), again.imperfections.size());
  EXPECT_EQ(one.imperfections[0].value, again.imperfections[0].value);
  EXPECT_NE(one.imperfections[0].value, other.imperfections[0].value);
  // The controller's configuration stays as it was.
  EXPECT_EQ(one.machine.controller.encoder_count_mm, 0.01);
  EXPECT_NE(one.machine.belt.encoder.count_mm, 0.01);
  EXPECT_GT(one.imperfections.size(), drawn("imperfections: static\nseed: 7\n").imperfections.size());
  EXPECT_THAT(faultsOf("imperfections: some\n"), HasSubstr("'some' is none of: ideal, static, dynamic"));
  EXPECT_THAT(faultsOf("twin: slow\n"), HasSubstr("'slow' is none of: reference, fast"));
}

TEST_F(CaseTest, AMachineThatTheTwinCannotRunIsRefusedWithItsLine) {
  const auto path =
      temp_.write("weak.yaml", "extends: " + base::fixture("machines/two-mirror.yaml").string() +
                                   "\ngalvo_x: {friction: {coulomb_n_m: 1}}\n");
  EXPECT_THAT(faultsOf("machine: " + path.string() + "\n"), HasSubstr("weak.yaml:2: galvo_x: "));
}

TEST_F(CaseTest, EyeMarksThatOverlapAreAFault) {
  EXPECT_THAT(faultsOf("print: {eye_mark_length_mm: 70}\n"), HasSubstr("print.eye_mark_length_mm"));
}

}  // namespace
}  // namespace kerfbench::scenario
