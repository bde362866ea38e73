// SPDX-License-Identifier: Apache-2.0
// Errors that users make: a clear message, the right exit code, no file left half-written.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::HasSubstr;

class BadInput : public testing::Test {
 protected:
  // Scenario that extends the label job, with these lines of its own.
  std::filesystem::path scenario(const std::string& lines) const {
    const auto path = scratch_.path() / "bad.yaml";
    std::ofstream(path) << "extends: " << fixture("scenarios/label-on-belt.yaml").string() << "\nname: bad\n"
                        << lines;
    return path;
  }
  std::filesystem::path file(const std::string& name, const std::string& content) const {
    std::ofstream(scratch_.path() / name) << content;
    return scratch_.path() / name;
  }
  ProgramRun run(const std::filesystem::path& path, const std::string& options = "") const {
    return kerfbench(fmt::format("run '{}' --no-pictures --results-dir '{}/results' {}", path.string(),
                                 scratch_.path().string(), options));
  }
  void expectNothingWritten() const {
    const auto results = scratch_.path() / "results";
    EXPECT_TRUE(!std::filesystem::exists(results) || std::filesystem::is_empty(results));
  }
  ScratchFolder scratch_;
};

TEST_F(BadInput, WrongCommandLineIs64) {
  EXPECT_EQ(kerfbench("").exit_code, 64);
  EXPECT_EQ(kerfbench("run").exit_code, 64);
  EXPECT_EQ(kerfbench("frobnicate").exit_code, 64);
  EXPECT_EQ(kerfbench("run x.yaml --jobs 0").exit_code, 64);
  EXPECT_EQ(kerfbench("--help").exit_code, 0);
}

TEST_F(BadInput, MissingScenarioIs65) {
  const auto result = run("/nonexistent.yaml");
  EXPECT_EQ(result.exit_code, 65);
  EXPECT_THAT(result.output, HasSubstr("/nonexistent.yaml: no such file"));
  expectNothingWritten();
}

TEST_F(BadInput, EveryFaultOfAScenarioIsNamedWithItsLine) {
  const auto path = scenario("belt: {speed_mm_s: fast, sped: 3}\ndieline: none.dxf\n");
  const auto result = run(path);
  EXPECT_EQ(result.exit_code, 65);
  EXPECT_THAT(result.output, HasSubstr("bad.yaml:3: belt.speed_mm_s: 'fast' is not a number"));
  EXPECT_THAT(result.output, HasSubstr("bad.yaml:3: belt.sped: unknown key"));
  EXPECT_THAT(result.output, HasSubstr("bad.yaml:4: dieline: no such file 'none.dxf'"));
  expectNothingWritten();
}

TEST_F(BadInput, MalformedFilesAre65) {
  EXPECT_EQ(run(file("broken.yaml", "a: [1, 2\n")).exit_code, 65);
  file("broken.dxf", "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\nCUT\n10\nnot a number\n");
  EXPECT_EQ(run(scenario("dieline: broken.dxf\n")).exit_code, 65);
  file("broken-machine.yaml", "version: 1\nname: x\nbogus: 1\n");
  const auto machine = run(scenario("machine: broken-machine.yaml\n"));
  EXPECT_EQ(machine.exit_code, 65);
  EXPECT_THAT(machine.output, HasSubstr("bogus"));
  file("broken.hex", ":10000000ZZ\n");
  const auto image = run(scenario("firmware: {image: broken.hex}\n"));
  EXPECT_EQ(image.exit_code, 65) << image.output;
  EXPECT_THAT(image.output, HasSubstr("broken.hex"));
  EXPECT_EQ(run(scenario("firmware: {image: none.hex}\n")).exit_code, 65);
  expectNothingWritten();
}

TEST_F(BadInput, AMessageNamesItsFile) {
  const auto gcode = file("bad.nc", "G00 X0 Y0\nG01 X\n");
  for (const char* command : {"check '{}'", "preview '{}' -o -", "program '{}' -o -"}) {
    const ProgramRun run = program("kerfplan", fmt::format(fmt::runtime(command), gcode.string()));
    EXPECT_EQ(run.exit_code, 65) << command;
    EXPECT_THAT(run.output, HasSubstr(gcode.string() + ": G-code line 2: X has no number")) << command;
  }
  const auto list = file("list.yaml", "- a\n- b\n");
  const ProgramRun edited = kerfbench(fmt::format("edit '{}' --set belt.speed_mm_s=30", list.string()));
  EXPECT_EQ(edited.exit_code, 65);
  EXPECT_THAT(edited.output, HasSubstr(list.string() + ": "));
}

TEST_F(BadInput, ALoopOfLinksIsNoTrace) {
  const auto loop = scratch_.path() / "loop.mcap";
  std::filesystem::create_symlink(loop.filename(), loop);
  EXPECT_EQ(kerfbench(fmt::format("trace info '{}'", loop.string())).exit_code, 65);
  EXPECT_EQ(kerfbench(fmt::format("trace recover '{}' --out '{}/whole.mcap'", loop.string(),
                                  scratch_.path().string()))
                .exit_code,
            65);
  const std::string lint =
      fmt::format("lint {} --image '{}'", fixture("scenarios/native/button.yaml").string(), loop.string());
  EXPECT_EQ(kerfbench(lint).exit_code, 65);
}

TEST_F(BadInput, AJobLargerThanTheFieldIs65) {
  const auto result = run(scenario("dieline: " + fixture("dielines/strip-crosscut.dxf").string() + "\n"));
  EXPECT_EQ(result.exit_code, 65);
  EXPECT_THAT(result.output, HasSubstr("field"));
  expectNothingWritten();
}

TEST_F(BadInput, ABeltTooFastIs65AndTheHighestSpeedIsNamed) {
  const auto result = run(scenario("belt: {speed_mm_s: 400}\n"));
  EXPECT_EQ(result.exit_code, 65);
  EXPECT_THAT(result.output, HasSubstr("400"));
  EXPECT_THAT(result.output, HasSubstr("mm/s"));
  expectNothingWritten();
}

struct BadFirmware {
  const char* image;  // Image in tests/hil/source/firmware.
  const char* words;
};

TEST_F(BadInput, FirmwareThatDoesNotWorkIsInvalidWithinTheTimeLimit) {
  for (const BadFirmware& bad : {BadFirmware{"hang", "does not answer"}, BadFirmware{"halt", "halted"},
                                 BadFirmware{"bad_opcode", "crashed"}, BadFirmware{"flood", "floods"}}) {
    const auto result = run(scenario(fmt::format("firmware: {{image: {}/{}-atmega2560.hex}}\n",
                                                 KERFBENCH_CONFORMANCE_IMAGES, bad.image)),
                            "--time-limit 5");
    EXPECT_EQ(result.exit_code, 3) << bad.image << "\n" << result.output;
    EXPECT_THAT(result.output, HasSubstr(bad.words)) << bad.image;
    EXPECT_EQ(verdictOf(scratch_.path() / "results" / "bad").at("verdict"), "INVALID") << bad.image;
  }
}

TEST_F(BadInput, TheTimeLimitMakesARunInvalid) {
  const auto result = run(scenario(""), "--time-limit 1.5");
  EXPECT_EQ(result.exit_code, 3) << result.output;
  EXPECT_THAT(result.output, HasSubstr("time limit"));
}

}  // namespace
}  // namespace kerfbench::test
