// SPDX-License-Identifier: Apache-2.0
// Firmware of another house (tests/scenarios/firmware/linecutter.c), from its G-code to a verdict.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kStepsPerUnit = 80.0;  // Steps of the firmware for a unit.

// Steps of each axis in a program.
std::map<std::string, long> stepsOf(const std::filesystem::path& gcode) {
  std::ifstream file(gcode);
  const std::array<std::string, 2> axes{"galvo_x", "galvo_y"};
  std::array<long, 2> at{};
  std::map<std::string, long> steps;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(';')) continue;
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      const auto word = line.find(axis == 0 ? 'X' : 'Y');
      if (word == std::string::npos) continue;
      const long to = std::lround(kStepsPerUnit * std::strtod(line.c_str() + word + 1, nullptr));
      steps[axes.at(axis)] += std::abs(to - at.at(axis));
      at.at(axis) = to;
    }
  }
  return steps;
}

class LineOkFirmware : public testing::Test {
 protected:
  // Runs the plate scenario with these lines of its own.
  ProgramRun run(const std::string& lines, const std::string& options = "") const {
    const auto path = scratch_.path() / "changed.yaml";
    std::ofstream(path) << "extends: " << plate().string() << "\nname: changed\n" << lines;
    return kerfbench(fmt::format("run '{}' --no-pictures --results-dir '{}/results' {}", path.string(),
                                 scratch_.path().string(), options));
  }
  ProgramRun runGcode(const std::string& program) const {
    std::ofstream(scratch_.path() / "job.gcode") << program;
    return run("firmware: {gcode: job.gcode}\n");
  }
  static std::filesystem::path plate() { return fixture("scenarios/line-ok/plate.yaml"); }
  [[nodiscard]] nlohmann::json verdict() const { return verdictOf(scratch_.path() / "results" / "changed"); }
  ScratchFolder scratch_;
};

TEST_F(LineOkFirmware, CutsASheetAtRestAndPasses) {
  const auto result = run("");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  const auto said = verdict();
  EXPECT_THAT(checksThat(said, "FAIL"), IsEmpty());
  const auto asked = stepsOf(plate().parent_path() / "plate.gcode");
  ASSERT_EQ(said.at("pulses").size(), 2U);
  for (const auto& axis : said.at("pulses")) {
    const std::string name = axis.at("axis");
    EXPECT_EQ(axis.at("pulses").get<long>(), asked.at(name)) << name;
    EXPECT_GT(asked.at(name), 10000) << name;
  }
}

TEST_F(LineOkFirmware, AReleaseThatHoldsItsJobIsStartedByAButtonAndMakesTheSamePulses) {
  const auto result =
      kerfbench(fmt::format("run '{}' --no-pictures --twin fast --results-dir '{}'",
                            fixture("scenarios/line-ok/own-job.yaml").string(), scratch_.path().string()));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("started by its button at 0.3 s"));
  const auto asked = stepsOf(plate().parent_path() / "plate.gcode");
  const auto said = verdictOf(scratch_.path() / "line-ok-own-job");
  for (const auto& axis : said.at("pulses"))
    EXPECT_EQ(axis.at("pulses").get<long>(), asked.at(axis.at("axis").get<std::string>()));
}

TEST_F(LineOkFirmware, AxesThatAreWiredWronglyAreNamedFirst) {
  const std::vector<std::pair<std::string, std::string>> wirings{
      {"galvo_x: {dir_low: true}", "X runs backwards: invert DIR of galvo_x"},
      {"pins: {galvo_x_pul: PD3, galvo_x_dir: PD6, galvo_y_pul: PD2, galvo_y_dir: PD5}",
       "X and Y are swapped"},
      {"galvo_x: {step_urad: 12.525}", "X moves 0.200 ± 0.03"}};
  for (const auto& [keys, sentence] : wirings) {
    std::ofstream(scratch_.path() / "wired.yaml")
        << "extends: " << fixture("machines/two-mirror-linecutter.yaml").string() << "\nname: wired\n"
        << keys << '\n';
    const auto result = run("machine: wired.yaml\n", "--twin fast");
    EXPECT_EQ(result.exit_code, 1) << result.output;
    EXPECT_THAT(result.output, testing::ContainsRegex("line by line\n  Likely cause: " + sentence)) << keys;
    EXPECT_THAT(verdict().at("summary").get<std::string>(), testing::StartsWith(sentence));
    EXPECT_THAT(verdict().at("likely_cause").get<std::string>(), testing::StartsWith(sentence));
  }
}

TEST_F(LineOkFirmware, AButtonThatIsNeverPressedIsNoVerdict) {
  const auto path = scratch_.path() / "unpressed.yaml";
  std::ofstream(path) << "extends: " << fixture("scenarios/line-ok/own-job.yaml").string()
                      << "\nname: unpressed\nfirmware: {start_s: ~}\ntime_limit_s: 1\n";
  const auto result = kerfbench(fmt::format("run '{}' --no-pictures --twin fast --results-dir '{}'",
                                            path.string(), scratch_.path().string()));
  EXPECT_EQ(result.exit_code, 3) << result.output;
  EXPECT_THAT(result.output, HasSubstr("the head was never pulsed"));
}

TEST_F(LineOkFirmware, AMachineWithoutAButtonCannotBeStartedByIt) {
  const auto path = scratch_.path() / "buttonless.yaml";
  std::ofstream(path) << "extends: " << fixture("scenarios/label-on-belt.yaml").string()
                      << "\nname: buttonless\nfirmware: {dialog: none, start_s: 0.1}\n";
  const auto result = kerfbench(fmt::format("lint '{}'", path.string()));
  EXPECT_EQ(result.exit_code, 65) << result.output;
  EXPECT_THAT(result.output, HasSubstr("two-mirror.yaml has no pin `start`"));
}

TEST_F(LineOkFirmware, LinesOfASetupGoFirstAndAnErrorToThemIsNamed) {
  const auto result = run("firmware: {setup: ['G90', 'G2 X1'], ahead_bytes: 60}\n");
  EXPECT_EQ(result.exit_code, 3) << result.output;
  EXPECT_THAT(result.output, HasSubstr("error:20 to line 2 of the setup: G2 X1"));
}

TEST_F(LineOkFirmware, ALineRateThatItDoesNotHaveMakesTheRunInvalid) {
  const auto result = run("firmware: {baud: 9600}\n");
  EXPECT_EQ(result.exit_code, 3) << result.output;
  EXPECT_THAT(result.output, HasSubstr("bench and firmware do not hear each other"));
  EXPECT_THAT(result.output, HasSubstr("and the bench at 9600"));
}

TEST_F(LineOkFirmware, AnotherReleaseCanBeNamedOnTheCommandLine) {
  const auto lost = run("firmware: {image: candidate.hex}\n");
  EXPECT_EQ(lost.exit_code, 65);
  EXPECT_THAT(lost.output, HasSubstr("no such file 'candidate.hex'"));
  const std::string image = releaseImage("linecutter-avr.hex").string();
  const auto result = run("firmware: {image: candidate.hex}\n", fmt::format("--image '{}'", image));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(verdict().at("inputs").dump(), HasSubstr("linecutter-avr.hex"));
  const auto wrong = run("", "--image none.hex");
  EXPECT_EQ(wrong.exit_code, 65);
  EXPECT_THAT(wrong.output, HasSubstr("firmware.image: no such file 'none.hex' (--image)"));
}

// Grbl is not part of this project: the variable names an image of Grbl 1.1 for an ATmega328P.
class Grbl : public LineOkFirmware {
 protected:
  void SetUp() override {
    if (image() == nullptr) GTEST_SKIP() << "the variable that names the image is not set";
  }
  [[nodiscard]] virtual const char* image() const { return std::getenv("KERFBENCH_GRBL_IMAGE"); }
  [[nodiscard]] ProgramRun plateWith(const std::string& setup, const std::string& more = "") const {
    const auto path = scratch_.path() / "changed.yaml";
    std::ofstream(path) << "extends: " << fixture("scenarios/line-ok/grbl-plate.yaml").string()
                        << "\nname: changed\nfirmware: {setup: [" << setup << "]" << more << "}\n";
    return kerfbench(fmt::format("run '{}' --image '{}' --twin fast --no-pictures --results-dir '{}/results'",
                                 path.string(), image(), scratch_.path().string()));
  }
  static constexpr const char* kSetup = "$32=1, $110=6000, $111=6000, $120=500, $121=500";
};

TEST_F(Grbl, WithABlankEepromPassesAndItsComplaintIsTold) {
  const auto result = plateWith(kSetup);
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("The firmware said \"error:7\" before it was sent anything."));
  EXPECT_THAT(verdict().at("versions").at("firmware's words").get<std::string>(), HasSubstr("error:7"));
  EXPECT_THAT(checksThat(verdict(), "PASS"), testing::Contains("account"));
  const auto verified =
      kerfbench(fmt::format("verify '{}/results/changed' --scenario '{}/changed.yaml' --image '{}'",
                            scratch_.path().string(), scratch_.path().string(), image()));
  EXPECT_EQ(verified.exit_code, 0) << verified.output;
}

TEST_F(Grbl, WithAWrongScaleFailsByThePath) {
  EXPECT_EQ(plateWith(std::string(kSetup) + ", $100=250.5").exit_code, 1);
  EXPECT_THAT(checksThat(verdict(), "FAIL"), testing::IsSupersetOf({"path", "account"}));
  EXPECT_THAT(verdict().at("likely_cause").get<std::string>(), testing::StartsWith("X moves 0.2"));
}

TEST_F(Grbl, WithAnAxisInvertedFails) {
  EXPECT_EQ(plateWith(std::string(kSetup) + ", $3=1").exit_code, 1);
  EXPECT_THAT(verdict().at("likely_cause").get<std::string>(),
              testing::StartsWith("X runs backwards: invert DIR of gantry_x in the firmware (Grbl: $3)"));
  EXPECT_THAT(checksThat(verdict(), "FAIL"), testing::Contains("stray"));
}

TEST_F(Grbl, WithConstantPowerBurnsItsCorners) {
  std::ifstream plate(fixture("scenarios/line-ok/grbl-plate.gcode"));
  std::string program{std::istreambuf_iterator<char>(plate), {}};
  for (std::size_t at = 0; (at = program.find("M4", at)) != std::string::npos;) program.replace(at, 2, "M3");
  std::ofstream(scratch_.path() / "m3.gcode") << program;
  EXPECT_EQ(plateWith(kSetup, ", gcode: m3.gcode").exit_code, 1);
  EXPECT_THAT(checksThat(verdict(), "FAIL"), testing::Contains("joints"));
  EXPECT_THAT(verdict().at("likely_cause").get<std::string>(),
              testing::StartsWith("The laser keeps its power where the beam is slow"));
}

TEST_F(Grbl, WithItsEnableInvertedFailsAndNamesIt) {
  EXPECT_EQ(plateWith(std::string(kSetup) + ", $4=1").exit_code, 1);
  EXPECT_THAT(checksThat(verdict(), "FAIL"), testing::Contains("pulse_timing"));
  EXPECT_THAT(verdict().dump(), HasSubstr("pulses while the drive was disabled"));
}

TEST_F(Grbl, ThatHoldsItsDrivesEnabledPasses) {
  EXPECT_EQ(plateWith(std::string(kSetup) + ", $1=255").exit_code, 0);
}

TEST_F(Grbl, ThatAcceleratesBeyondItsDrivesFails) {
  EXPECT_EQ(plateWith(std::string(kSetup) + ", $120=20000, $121=20000").exit_code, 1);
  EXPECT_THAT(checksThat(verdict(), "FAIL"), testing::Contains("pulse_timing"));
  EXPECT_THAT(verdict().at("likely_cause").get<std::string>(),
              testing::StartsWith("The axes do not follow at corners"));
}

TEST_F(Grbl, ThatIsDarkAroundACornerIsNotBlamedOnTheAxes) {
  std::ifstream plate(fixture("scenarios/line-ok/grbl-plate.gcode"));
  std::string program{std::istreambuf_iterator<char>(plate), {}};
  const std::string corner = "G1 X45 Y-10\nG1 X45 Y30\n";
  const std::size_t at = program.find(corner);
  ASSERT_NE(at, std::string::npos);
  program.replace(at, corner.size(), "G1 X44.5 Y-10\nG1 X45 Y-10 S0\nG1 X45 Y-9.5\nG1 X45 Y30 S1000\n");
  std::ofstream(scratch_.path() / "dark.gcode") << program;
  EXPECT_EQ(plateWith(kSetup, ", gcode: dark.gcode").exit_code, 1);
  EXPECT_THAT(checksThat(verdict(), "FAIL"), testing::Contains("joints"));
  EXPECT_EQ(verdict().at("likely_cause"), "");
}

TEST_F(LineOkFirmware, ALineThatItRefusesMakesTheRunInvalidAndIsNamed) {
  const auto result = runGcode("G90\n; so far so good\nM3 S160\nG1 X2 Y0 F9000\nG2 X4 Y0 I1\nG1 X6\nM5\n");
  EXPECT_EQ(result.exit_code, 3) << result.output;
  EXPECT_THAT(result.output, HasSubstr("error:20 to line 5: G2 X4 Y0 I1"));
  EXPECT_EQ(verdict().at("verdict"), "INVALID");
}

TEST_F(LineOkFirmware, AProgramThatCutsNothingIsInvalid) {
  const auto result = runGcode("G90\nG0 X10 Y10\nG0 X0 Y0\n");
  EXPECT_EQ(result.exit_code, 3) << result.output;
  EXPECT_THAT(result.output, HasSubstr("nothing was cut"));
}

TEST_F(LineOkFirmware, AWrongDistanceOfTheHeadFailsByThePath) {
  // The machine's head hangs 2 mm lower than plate.py assumes; the program is the same.
  std::ofstream(scratch_.path() / "low.yaml")
      << "extends: " << fixture("machines/two-mirror-linecutter.yaml").string()
      << "\nname: low\noptics: {throw_mm: 498}\n";
  const auto result = run("machine: low.yaml\n");
  EXPECT_EQ(result.exit_code, 1) << result.output;
  const auto said = verdict();
  EXPECT_THAT(checksThat(said, "FAIL"), testing::Contains("path"));
  for (const auto& check : said.at("checks")) {
    if (check.at("name") != "path") continue;
    // The right side, at x = 45 mm, comes in by 2 / 515 of that.
    EXPECT_NEAR(check.at("value").get<double>(), 45.0 * 2 / 515, 0.02);
  }
}

TEST_F(LineOkFirmware, ABeltAtRestMustSayWhereTheSheetLies) {
  const auto label = fixture("scenarios/label-on-belt.yaml").string();
  std::ofstream(scratch_.path() / "rest.yaml")
      << "extends: " << label << "\nname: rest\nbelt: {speed_mm_s: 0}\n";
  const auto result = kerfbench(fmt::format("lint '{}'", (scratch_.path() / "rest.yaml").string()));
  EXPECT_EQ(result.exit_code, 65);
  EXPECT_THAT(result.output, HasSubstr("rest.yaml:3: belt.speed_mm_s: "));
  EXPECT_THAT(result.output, HasSubstr("start_x_mm"));
}

// KERFBENCH_GRBL_XY_IMAGE names one whose HOMING_CYCLE_0 is X and Y: there is no Z here that could go home.
class GrblHoming : public Grbl {
 protected:
  [[nodiscard]] const char* image() const override { return std::getenv("KERFBENCH_GRBL_XY_IMAGE"); }
  // Switches are high when they trip, and lie at the far ends of 800 and 430 mm.
  static constexpr const char* kHome =
      "$5=1, $22=1, $24=100, $25=3000, $27=1, $130=900, $131=900, $H, G10 L2 P1 X-800 Y-430";
};

TEST_F(GrblHoming, FindsTheSwitchesOfTheMachineAndCutsFromThere) {
  const auto result = plateWith(fmt::format("{}, {}", kSetup, kHome));
  EXPECT_EQ(result.exit_code, 0) << result.output;
}

TEST_F(GrblHoming, ASoftLimitIsAnAlarmWithTheLineThatRanIntoIt) {
  std::ofstream(scratch_.path() / "far.gcode") << "G21 G90\nG0 X-150 Y20\n";
  const auto result = plateWith(fmt::format("{}, {}, $20=1", kSetup, kHome), ", gcode: far.gcode");
  EXPECT_EQ(result.exit_code, 3) << result.output;
  EXPECT_THAT(result.output, HasSubstr("ALARM:2 to line 2: G0 X-150 Y20"));
}

TEST_F(GrblHoming, SwitchesThatAreTakenForTheirOppositeAreAnAlarm) {
  const auto result = plateWith("$5=0, $22=1, $130=900, $131=900, $H");
  EXPECT_EQ(result.exit_code, 3) << result.output;
  EXPECT_THAT(result.output, HasSubstr("ALARM:8 to line 5 of the setup: $H"));
}

}  // namespace
}  // namespace kerfbench::test
