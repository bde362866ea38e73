// SPDX-License-Identifier: Apache-2.0
// Results that were changed after the verdict, and recordings whose sensors are not the machine's.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

void write(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

std::string replacedIn(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// One label on the moving web, its good run, and what is done to it.
class Verify : public testing::Test {
 protected:
  void SetUp() override {
    write(scenario_, fmt::format("extends: {}\nname: label\ntwin: fast\nprint: {{units: 1}}\n",
                                 fixture("scenarios/native/label-on-belt.yaml").string()));
    const auto run =
        kerfbench(fmt::format("run '{}' -q --no-pictures --results-dir '{}'", scenario_.string(), folder()));
    ASSERT_EQ(run.exit_code, 0) << run.output;
  }
  [[nodiscard]] std::string folder() const { return scratch_.path().string(); }
  [[nodiscard]] ProgramRun verify(const std::string& options = {}) const {
    return kerfbench(fmt::format("verify '{}' {}", results_.string(), options));
  }
  [[nodiscard]] ProgramRun verifyAgain() const {
    return verify(fmt::format("--jobs 1 --scenario '{}'", scenario_.string()));
  }
  /// Edits a file of the results.
  void edit(const std::string& name, const std::string& from, const std::string& to) const {
    write(results_ / name, replacedIn(textOf(results_ / name), from, to));
  }
  /// Takes a file out of the list, as if the run had written another one.
  void forgeList(const std::string& name) const {
    const auto sum = program("/usr/bin/sha256sum", fmt::format("<'{}'", (results_ / name).string())).output;
    const std::string list = textOf(results_ / "kerfbench-results.txt");
    const std::size_t at = list.find("  " + name + "\n");
    ASSERT_NE(at, std::string::npos);
    write(results_ / "kerfbench-results.txt", std::string(list).replace(at - 64, 64, sum.substr(0, 64)));
  }
  /// Replays the pins after an edit of their text without Kerfbench's sum, which anybody can leave out.
  [[nodiscard]] nlohmann::json replayed(const std::function<std::string(const std::string&)>& change) const {
    std::string pins = replacedIn(textOf(results_ / "pins.vcd"), "$comment kerfbench sum sha256 $end\n", "");
    pins = change(pins.substr(0, pins.rfind("$comment kerfbench sum ")));
    write(scratch_.path() / "pins.vcd", pins);
    const auto replay =
        kerfbench(fmt::format("replay '{}/pins.vcd' --scenario '{}' -q --no-pictures --results-dir '{}'",
                              folder(), scenario_.string(), folder()));
    EXPECT_NE(replay.exit_code, 65) << replay.output;
    return verdictOf(scratch_.path() / "label-replay");
  }

  const ScratchFolder scratch_;
  const fs::path scenario_ = scratch_.path() / "label.yaml";
  const fs::path results_ = scratch_.path() / "label" / "latest";
};

TEST_F(Verify, ResultsOfARunAndOfItsReplayAreWhatTheyWere) {
  EXPECT_EQ(verify().exit_code, 0);
  const auto again = verifyAgain();
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_THAT(again.output, HasSubstr("its pins give its verdict"));
  const std::string digest = verdictOf(results_).at("digest");
  EXPECT_EQ(verify("--digest " + digest).exit_code, 0);
  const auto other = verify("--digest " + std::string(64, '0'));
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.output, HasSubstr("the digest is " + digest));
}

TEST_F(Verify, AnyFileThatWasChangedIsNamed) {
  edit("report.html", "PASS", "FAIL");
  fs::remove(results_ / "job.gcode");
  const auto changed = verify();
  EXPECT_EQ(changed.exit_code, 1);
  EXPECT_THAT(changed.output, HasSubstr("report.html is not what the run wrote"));
  EXPECT_THAT(changed.output, HasSubstr("job.gcode is missing"));
}

// Whoever changes a verdict can change its sum; the pins tell all the same.
TEST_F(Verify, AVerdictThatItsPinsDoNotGiveIsFoundWithoutSums) {
  edit("verdict.json", "\"verdict\": \"PASS\"", "\"verdict\": \"FAIL\"");
  forgeList("verdict.json");
  edit("junit.xml", "failures=\"0\"", "failures=\"1\"");
  forgeList("junit.xml");
  EXPECT_EQ(verify().exit_code, 0) << "its sums fit";
  const auto again = verifyAgain();
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.output, HasSubstr("verdict.json is not what its pins give: verdict"));
  EXPECT_THAT(again.output, HasSubstr("junit.xml is not what its pins give"));
}

TEST_F(Verify, PinsAndScenarioOfAnotherRunAreFoundWithoutSums) {
  edit("pins.vcd", "#625\n", "#1250\n");
  forgeList("pins.vcd");
  edit("scenario.yaml", "name: label", "name:  label");
  forgeList("scenario.yaml");
  const auto changed = verify();
  EXPECT_EQ(changed.exit_code, 1);
  EXPECT_THAT(changed.output, HasSubstr("pins.vcd does not end with a sum that fits it"));
  EXPECT_THAT(changed.output, HasSubstr("another scenario than scenario.yaml"));
}

TEST_F(Verify, AFolderThatIsNoneOfResultsIs65) {
  const auto none = kerfbench(fmt::format("verify '{}'", folder()));
  EXPECT_EQ(none.exit_code, 65);
  EXPECT_THAT(none.output, HasSubstr("is no results folder"));
}

TEST_F(Verify, ARecordingWithoutASumSaysSoInItsVerdict) {
  const auto verdict = replayed([](const std::string& pins) { return pins; });
  EXPECT_EQ(verdict.at("verdict"), "PASS");
  EXPECT_EQ(verdict.at("reservations").at(0).at("kind"), "unsealed_recording");
}

// The pictures are of a web that passed the sensor when the model's did.
TEST_F(Verify, SensorsThatTheMachineDidNotGiveMakeARecordingInvalid) {
  const auto verdict = replayed([](const std::string& pins) {
    const std::size_t up = pins.find("\n1/\n");  // The print mark comes.
    const std::size_t later = pins.find("\n#", up + 2'000);
    const std::size_t behind = pins.find('\n', later + 1);
    return pins.substr(0, up) + pins.substr(up + 3, behind - up - 3) + "\n1/" + pins.substr(behind);
  });
  EXPECT_EQ(verdict.at("verdict"), "INVALID");
  EXPECT_THAT(verdict.at("problems").dump(), HasSubstr("print_mark"));
}

TEST_F(Verify, MotionTellsWhereThePulsesOfTheRunLed) {
  const auto motion =
      kerfbench(fmt::format("motion '{}' --scenario '{}' --out '{}'", (results_ / "pins.vcd").string(),
                            scenario_.string(), (scratch_.path() / "motion").string()));
  ASSERT_EQ(motion.exit_code, 0) << motion.output;
  // Hole and outline are closed: the head has gone as far as the web, within two steps, and not across.
  std::istringstream lines(motion.output);
  std::string line;
  std::getline(lines, line);
  int cuts = 0;
  double from_s{}, to_s{}, x0{}, y0{}, x1{}, y1{}, over_x_mm{}, over_y_mm{}, vx{}, vy{};
  while (lines >> from_s >> to_s >> x0 >> y0 >> x1 >> y1 >> over_x_mm >> over_y_mm >> vx >> vy) {
    ++cuts;
    EXPECT_NEAR(over_x_mm, 0.0, 0.05) << line;
    EXPECT_NEAR(over_y_mm, 0.0, 0.02) << line;
    EXPECT_NEAR(vx, 60.0, 0.5);
  }
  EXPECT_EQ(cuts, 2);
  EXPECT_THAT(textOf(scratch_.path() / "motion" / "motion.csv"),
              HasSubstr("t_s,x_W_mm,y_W_mm,sheet_x_mm,gate,G_mm"));
  EXPECT_THAT(textOf(scratch_.path() / "motion" / "motion-sheet.svg"), HasSubstr("</svg>"));
}

}  // namespace
}  // namespace kerfbench::test
