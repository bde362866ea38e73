// SPDX-License-Identifier: Apache-2.0
// Command kerfbench lint: good files are accepted, faults are named with their place.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;

std::string lineEntity(const std::string& layer, double x0, double y0, double x1, double y1) {
  return fmt::format("0\nLINE\n8\n{}\n10\n{}\n20\n{}\n11\n{}\n21\n{}\n", layer, x0, y0, x1, y1);
}

class Lint : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& name, const std::string& content) const {
    std::ofstream(scratch_.path() / name) << content;
    return scratch_.path() / name;
  }
  std::filesystem::path drawing(const std::string& name, const std::string& entities) const {
    return file(name, "0\nSECTION\n2\nENTITIES\n" + entities + "0\nENDSEC\n0\nEOF\n");
  }
  static ProgramRun lint(const std::filesystem::path& path, const std::string& options = "") {
    return kerfbench(fmt::format("lint '{}' {}", path.string(), options));
  }
  ScratchFolder scratch_;
};

/// What is not part of the cut is told with the drawing.
TEST_F(Lint, TellsWhatACf2HasBesides) {
  const auto path =
      file("box.cf2",
           "$BOF\nV2\nMAIN,BOX\nUM\nL,2,1,0,0,0,50,0,2,0.8\nL,2,1,0,50,0,50,30,0,0\nL,2,1,0,50,30,0,0,0,0\n"
           "L,2,46,0,0,-5,50,-5,0,0\nT,1,46,0,5,5,0,4,3\n50 mm\nEND\n$EOF\n");
  const auto result = lint(path);
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, AllOf(HasSubstr("note: Ignored: 1 texts."), HasSubstr("2 bridges of 1 lines"),
                                   HasSubstr("4 entities, 50.00 x 30.00 mm"), HasSubstr("box.cf2: good")));
}

TEST_F(Lint, EveryFixtureIsGood) {
  std::vector<std::filesystem::path> files;
  for (const char* folder : {"scenarios", "machines", "dielines", "fold"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(fixture(folder))) {
      const auto path = entry.path();
      if (path.string().find("generate") != std::string::npos || path.filename() == "drivers.yaml") continue;
      if (path.string().find("dielines/reader") != std::string::npos) continue;
      const auto extension = path.extension();
      if (extension == ".yaml" || extension == ".dxf" || extension == ".svg") files.push_back(path);
    }
  }
  EXPECT_GE(files.size(), 20U);
  for (const auto& path : files) {
    // Whoever runs Grbl brings it along.
    const bool has_image = !path.filename().string().starts_with("grbl-");
    const auto result =
        lint(path, has_image ? "" : fmt::format("--image '{}'", releaseImage("linecutter-avr.hex").string()));
    EXPECT_EQ(result.exit_code, 0) << path << "\n" << result.output;
    EXPECT_THAT(result.output, HasSubstr(path.string() + ": good\n"));
  }
}

TEST_F(Lint, AControllerThatTheEmulatorLacksIsRefusedWithThoseMostLikeIt) {
  const auto scenario = file("s.yaml", "extends: " + fixture("scenarios/label-on-belt.yaml").string() +
                                           "\nname: s\nfirmware: {mcu: atmega256}\n");
  const auto result = lint(scenario);
  EXPECT_EQ(result.exit_code, 65);
  EXPECT_THAT(result.output,
              HasSubstr(scenario.string() + ":3: firmware.mcu: the emulator has no 'atmega256'"));
  EXPECT_THAT(result.output, HasSubstr("atmega2560"));
  // A run refuses it in the same words.
  const auto run = kerfbench(
      fmt::format("run '{}' --results-dir '{}/results'", scenario.string(), scratch_.path().string()));
  EXPECT_EQ(run.exit_code, 65);
  EXPECT_THAT(run.output, HasSubstr("firmware.mcu: the emulator has no 'atmega256'"));
}

TEST_F(Lint, APinThatTheControllerLacksIsNamedWithItsLine) {
  (void)file("m.yaml", "extends: " + fixture("machines/two-mirror-linecutter.yaml").string() +
                           "\nname: m\npins:\n  galvo_x_pul: PA2\n  laser_gate: PB9\n");
  const auto scenario = file("s.yaml", "extends: " + fixture("scenarios/line-ok/plate.yaml").string() +
                                           "\nname: s\nmachine: m.yaml\n");
  const auto result = lint(scenario);
  EXPECT_EQ(result.exit_code, 65);
  EXPECT_THAT(
      result.output,
      AllOf(HasSubstr("m.yaml:4: pins.galvo_x_pul: an atmega328p has no PA2: its ports are PB, PC, PD"),
            HasSubstr("m.yaml:5: pins.laser_gate: an atmega328p has no PB9")));
}

TEST_F(Lint, APinByTheNameOfAnotherFamilyIsRefused) {
  (void)file("m.yaml", "extends: " + fixture("machines/two-mirror-linecutter.yaml").string() +
                           "\nname: m\npins:\n  laser_gate: P1.4\n");
  const auto scenario = file("s.yaml", "extends: " + fixture("scenarios/line-ok/plate.yaml").string() +
                                           "\nname: s\nmachine: m.yaml\n");
  const auto result = lint(scenario);
  EXPECT_EQ(result.exit_code, 65);
  EXPECT_THAT(result.output, HasSubstr("m.yaml:4: pins.laser_gate: an atmega328p has no P1.4"));
}

TEST_F(Lint, AControllerWhoseUartTheBenchCannotReachIsRefused) {
  const auto scenario = file("s.yaml", "extends: " + fixture("scenarios/line-ok/plate.yaml").string() +
                                           "\nname: s\nfirmware: {mcu: attiny84}\n");
  const auto result = lint(scenario);
  EXPECT_EQ(result.exit_code, 65);
  EXPECT_THAT(result.output, HasSubstr(":3: firmware.mcu: the emulator has no UART 0 of an attiny84"));
}

TEST_F(Lint, QuietSaysNothingOfWhatIsGood) {
  const auto result = lint(fixture("scenarios/label-on-belt.yaml"), "-q");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.output, "");
}

TEST_F(Lint, ALineDrawnTwiceIsNamedWithPlaceAndLayer) {
  const std::string square = lineEntity("CUT", 0, 0, 20, 0) + lineEntity("CUT", 20, 0, 20, 20) +
                             lineEntity("CUT", 20, 20, 0, 20) + lineEntity("CUT", 0, 20, 0, 0);
  EXPECT_EQ(lint(drawing("square.dxf", square)).exit_code, 0);
  const auto path = drawing("twice.dxf", square + lineEntity("CUT", 20, 20, 20, 0));
  const auto result = lint(path, "-q");
  EXPECT_EQ(result.exit_code, 65) << result.output;
  EXPECT_THAT(result.output,
              AllOf(HasSubstr(path.string() + ": error at (20.000, "), HasSubstr("layer CUT")));

  // A scenario that names the file is as bad, and is not run either.
  const auto scenario = file("s.yaml", "extends: " + fixture("scenarios/label-on-belt.yaml").string() +
                                           "\nname: twice\ndieline: twice.dxf\n");
  EXPECT_EQ(lint(scenario).exit_code, 65);
  const auto run = kerfbench(
      fmt::format("run '{}' --results-dir '{}/results'", scenario.string(), scratch_.path().string()));
  EXPECT_EQ(run.exit_code, 65);
  EXPECT_THAT(run.output, AllOf(HasSubstr("twice.dxf: at (20.000, "), HasSubstr("layer CUT")));
}

TEST_F(Lint, ALayerWithoutARuleIs65) {
  const auto result = lint(drawing("layer.dxf", lineEntity("SECRET", 0, 0, 20, 0)));
  EXPECT_EQ(result.exit_code, 65);
  EXPECT_THAT(result.output, HasSubstr("SECRET"));
}

TEST_F(Lint, EveryFaultOfAMachineIsNamedWithItsLine) {
  const auto path = file(
      "bad.yaml", "extends: " + fixture("machines/two-mirror.yaml").string() +
                      "\npins: {galvo_x_pul: Q7, galvo_y_pul: PA1}\noptics:\n  throw_mm: -5\n  lenses: 1\n");
  const auto result = lint(path);
  EXPECT_EQ(result.exit_code, 65);
  EXPECT_THAT(result.output, HasSubstr("bad.yaml:2: pins.galvo_x_pul: 'Q7' is no pin like PA0"));
  EXPECT_THAT(result.output, HasSubstr("PA1 is given to galvo_x_dir and to galvo_y_pul"));
  EXPECT_THAT(result.output, ContainsRegex("bad.yaml:4: optics.throw_mm: "));
  EXPECT_THAT(result.output, HasSubstr("bad.yaml:5: optics.lenses: unknown key"));
}

TEST_F(Lint, OneBadFileOfSeveralDecides) {
  const auto bad = file("bad.yaml", "version: 1\n");
  const auto result =
      kerfbench(fmt::format("lint '{}' '{}'", fixture("machines/two-mirror.yaml").string(), bad.string()));
  EXPECT_EQ(result.exit_code, 65);
  EXPECT_THAT(result.output, HasSubstr("two-mirror.yaml: good"));
  EXPECT_EQ(lint("/nonexistent.dxf").exit_code, 65);
}

}  // namespace
}  // namespace kerfbench::test
