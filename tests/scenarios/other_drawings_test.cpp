// SPDX-License-Identifier: Apache-2.0
// Good drawings that other programs wrote, or that are drawn as others draw: the native release cuts them,
// and each is a PASS.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::Contains;
namespace fs = std::filesystem;

/// Marks of the label beside a drawing whose origin is the bottom left of its page, as SVG has it.
constexpr const char* kPage =
    "print:\n  units: 1\n  marks:\n    - {x_mm: 5, y_mm: -7, diameter_mm: 3}\n    - {x_mm: 5, y_mm: 47, "
    "diameter_mm: 3}\n"
    "    - {x_mm: 55, y_mm: -7, diameter_mm: 3}\n    - {x_mm: 55, y_mm: 47, diameter_mm: 3}\n"
    "    - {x_mm: 40, y_mm: 47, diameter_mm: 3}\n";

/// The label's job with another drawing of the same size. Returns the checks that pass.
std::vector<std::string> passingChecks(const fs::path& drawing, const std::string& keys,
                                       const ScratchFolder& scratch) {
  const fs::path scenario =
      scenarioWith("native/label-on-belt.yaml",
                   fmt::format("name: drawing\ndieline: '{}'\n{}", drawing.string(), keys), scratch);
  const ProgramRun run = fastRunOf(scenario, scratch);
  EXPECT_EQ(run.exit_code, 0) << run.output;
  std::printf("%s", run.output.c_str());
  return checksThat(verdictOf(scratch.path() / "drawing"), "PASS");
}

void fixturePasses(const std::string& name, const std::string& keys) {
  const ScratchFolder scratch;
  EXPECT_THAT(passingChecks(fixture("dielines/" + name), keys, scratch), Contains("path"));
}

/// A drawing of 60 x 40 mm: cuts in red, creases in blue.
fs::path svg(const std::string& cuts, const std::string& creases, const ScratchFolder& scratch) {
  const fs::path path = scratch.path() / "drawing.svg";
  std::ofstream(path) << fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='60mm' height='40mm' viewBox='0 0 60 40' "
      "fill='none'><path d='{}' stroke='#ff0000'/><path d='{}' stroke='#0000ff'/></svg>\n",
      cuts, creases);
  return path;
}

/// A panel with two fingers, as generators of boxes draw it: each corner has a fillet of this radius.
std::string fingered(double r) {
  const auto arc = [r](int sweep, double dx, double dy) {
    return fmt::format("a{0} {0} 0 0 {1} {2} {3}", r, sweep, r * dx, r * dy);
  };
  std::string d = fmt::format("M{} 0H{}{}V{}{}", r, 60.0 - r, arc(1, 1, 1), 40.0 - r, arc(1, -1, 1));
  for (const double x : {50.0, 30.0}) {
    d += fmt::format("H{}{}V{}{}", x + r, arc(1, -1, -1), 37.0 + r, arc(0, -1, -1));
    d += fmt::format("H{}{}V{}{}", x - 10.0 + r, arc(0, -1, 1), 40.0 - r, arc(1, -1, 1));
  }
  return d + fmt::format("H{}{}V{}{}Z", r, arc(1, -1, -1), r, arc(1, 1, -1));
}

TEST(OtherDrawings, LabelOfLibreCadPasses) {
  fixturePasses("label-60x40-librecad.dxf", "print: {units: 1}\n");
}
TEST(OtherDrawingsLong, LabelOfInkscapePasses) { fixturePasses("label-60x40.svg", kPage); }
TEST(OtherDrawingsLong, LabelThatInkscapeTurnedPasses) { fixturePasses("label-60x40-turned.svg", kPage); }
TEST(OtherDrawingsLong, LabelAsPathsOfInkscapePasses) { fixturePasses("label-60x40-paths.svg", kPage); }

TEST(OtherDrawingsLong, BoxWithTightFilletsPassesByCoverage) {
  for (const double r_mm : {0.1, 0.05}) {
    const ScratchFolder scratch;
    EXPECT_THAT(passingChecks(svg(fingered(r_mm), "", scratch), kPage, scratch), Contains("coverage"));
  }
}

/// A tray with cuts that are not closed and begin with 0.28 mm askew, in the order in which they are drawn.
TEST(OtherDrawingsLong, OpenCutsWithShortFirstLinesPassByGateLag) {
  const ScratchFolder scratch;
  const fs::path tray =
      svg("M0 9.8l.2 .2H10V0H50V10H59.8l.2 -.2M60 30.2l-.2 -.2H50V40H10V30H.2l-.2 .2M0 9.8V30.2M60 9.8V30.2",
          "M10 10H50M10 30H50M10 10V30M50 10V30", scratch);
  const std::string keys = std::string(kPage) + "belt: {speed_mm_s: 40}\nplanner: {order: drawn}\n";
  EXPECT_THAT(passingChecks(tray, keys, scratch), Contains("gate_lag"));
}

/// The folding carton, written again as CF2 or PDF by a script that has nothing of the readers.
fs::path redrawnCarton(const std::string& name, const std::string& options, const ScratchFolder& scratch) {
  const fs::path path = scratch.path() / name;
  const ProgramRun run =
      program("/usr/bin/python3",
              fmt::format("'{}/tests/hil/dieline/redraw.py' '{}' '{}' {}", KERFBENCH_SOURCE_DIR,
                          fixture("dielines/tuck-end-carton.dxf").string(), path.string(), options));
  EXPECT_EQ(run.exit_code, 0) << run.output;
  return path;
}

/// Runs the carton's job with this drawing. Returns its pins.
fs::path pinsOfCarton(const fs::path& drawing, const std::string& keys, const ScratchFolder& scratch) {
  const fs::path scenario =
      scenarioWith("native/carton-on-belt.yaml",
                   fmt::format("name: carton\ndieline: '{}'\n{}", drawing.string(), keys), scratch);
  const ProgramRun run = fastRunOf(scenario, scratch);
  EXPECT_EQ(run.exit_code, 0) << run.output;
  const std::vector<std::string> passing = checksThat(verdictOf(scratch.path() / "carton"), "PASS");
  for (const char* check : {"path", "coverage", "stray", "depth"}) EXPECT_THAT(passing, Contains(check));
  return scratch.path() / "carton" / "latest" / "pins.vcd";
}

/// Half as large, so that the page lies within the field: its origin is a corner of the page.
TEST(OtherDrawings, CartonAsPdfWithProcessingStepsPasses) {
  const ScratchFolder scratch;
  pinsOfCarton(redrawnCarton("carton.pdf", "0.5 76 38 steps", scratch),
               "print:\n  marks:\n    - {x_mm: 10, y_mm: 1, diameter_mm: 3}\n    - {x_mm: 10, y_mm: 75, "
               "diameter_mm: 3}\n"
               "    - {x_mm: 70, y_mm: 1, diameter_mm: 3}\n    - {x_mm: 70, y_mm: 75, diameter_mm: 3}\n"
               "    - {x_mm: 60, y_mm: 75, diameter_mm: 3}\n",
               scratch);
}

/// Planner and judge read a drawing alike, so what was cut by the CF2 is judged by the DXF, too.
TEST(OtherDrawingsLong, CartonAsCf2IsTheCartonOfTheDxf) {
  for (const auto& [options, exit_code] : {std::pair{"sub", 0}, std::pair{"1 0.2 0", 1}}) {
    const ScratchFolder scratch;
    const fs::path pins = pinsOfCarton(redrawnCarton("carton.cf2", options, scratch), "", scratch);
    const ProgramRun replay = kerfbench(
        fmt::format("replay '{}' --scenario '{}' --twin fast --no-pictures --results-dir '{}'", pins.string(),
                    fixture("scenarios/native/carton-on-belt.yaml").string(), scratch.path().string()));
    EXPECT_EQ(replay.exit_code, exit_code) << options << "\n" << replay.output;
  }
}

}  // namespace
}  // namespace kerfbench::test
