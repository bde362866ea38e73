// SPDX-License-Identifier: Apache-2.0
// `lint --witness` and `dieline: {witness: required}`: where the readers agree nothing changes but what is
// told; where they part, or there is no second reader, nothing runs.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A copy of the program with a second reader of the test's own beside it: a script of Python.
class OtherReader {
 public:
  OtherReader(const ScratchFolder& scratch, const std::string& script) : root_(scratch.path() / "other") {
    fs::create_directories(root_ / "bin");
    fs::create_directories(root_ / "witness");
    fs::copy_file(fs::path(KERFBENCH_BINARY_DIR) / "bin/kerfbench", root_ / "bin/kerfbench",
                  fs::copy_options::skip_existing);
    fs::create_directory_symlink(fs::path(KERFBENCH_BINARY_DIR) / "firmware", root_ / "firmware");
    std::ofstream(root_ / "witness/second_reader.py") << script;
  }
  [[nodiscard]] ProgramRun run(const std::string& arguments) const {
    return program((root_ / "bin/kerfbench").string(), arguments);
  }

 private:
  fs::path root_;
};

class WitnessDemanded : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("/usr/bin/python3 -c 'import ezdxf, svgelements' 2>/dev/null") != 0)
      GTEST_SKIP() << "python3-ezdxf or python3-svgelements is not installed";
  }
  [[nodiscard]] std::string label() const { return fixture("dielines/label-60x40.dxf").string(); }
  [[nodiscard]] fs::path demanding(const std::string& drawing) const {
    const fs::path path = scratch_.path() / "demanding.yaml";
    std::ofstream(path) << fmt::format(
        "extends: {}\nname: demanding\ndieline: {{file: {}, witness: required}}\n",
        fixture("scenarios/label-on-belt.yaml").string(), drawing);
    return path;
  }
  [[nodiscard]] std::string into() const {
    return fmt::format("--results-dir '{}'", scratch_.path().string());
  }
  /// A drawing with a selector that the second reader does not follow.
  [[nodiscard]] fs::path unfollowed() const {
    const fs::path path = scratch_.path() / "unfollowed.svg";
    std::ofstream(path)
        << "<svg xmlns='http://www.w3.org/2000/svg' width='60mm' height='40mm' viewBox='0 0 60 40'>"
           "<style>g > rect {stroke: red; fill: none}</style><g><rect x='5' y='5' width='50' "
           "height='30'/></g></svg>";
    return path;
  }
  ScratchFolder scratch_;
};

TEST_F(WitnessDemanded, AgreementIsToldWithFigures) {
  const auto result = kerfbench(fmt::format("lint --witness '{}'", label()));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, AllOf(HasSubstr("note: the second reader (ezdxf"),
                                   HasSubstr("agrees on 1 layer, 210.558 mm"), HasSubstr("good")));
  EXPECT_THAT(kerfbench(fmt::format("lint '{}'", label())).output, Not(HasSubstr("second reader")));
  // A scenario that demands it is linted with it.
  const auto of_scenario = kerfbench(fmt::format("lint '{}'", demanding(label()).string()));
  EXPECT_EQ(of_scenario.exit_code, 0) << of_scenario.output;
  EXPECT_THAT(of_scenario.output, HasSubstr("agrees on 1 layer"));
}

TEST_F(WitnessDemanded, PartingReadersAreBadInput) {
  const auto result = kerfbench(fmt::format("lint --witness -q '{}'", unfollowed().string()));
  EXPECT_EQ(result.exit_code, 65) << result.output;
  EXPECT_THAT(result.output,
              AllOf(HasSubstr("unfollowed.svg: error: layer '#ff0000' (cut): this reader finds 4 lines"),
                    HasSubstr("nothing says which is right"), Not(HasSubstr("good"))));
  // The drawing itself is good.
  EXPECT_EQ(kerfbench(fmt::format("lint -q '{}'", unfollowed().string())).exit_code, 0);
}

TEST_F(WitnessDemanded, WhereThereIsNoneItIsSaid) {
  const OtherReader without(scratch_, "print('{\"missing\": \"python3-ezdxf\"}')");
  auto result = without.run(fmt::format("lint --witness '{}'", label()));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, AllOf(HasSubstr("apt-get install python3-ezdxf"), Not(HasSubstr("good"))));
  result = without.run(fmt::format("run '{}' {}", demanding(label()).string(), into()));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output,
              HasSubstr("dieline.witness is required, and the second reader needs the package"));
  EXPECT_FALSE(fs::exists(scratch_.path() / "demanding"));
  result = without.run(fmt::format("doctor '{}'", demanding(label()).string()));
  EXPECT_EQ(result.exit_code, 1) << result.output;
  EXPECT_THAT(result.output, HasSubstr("apt-get install python3-ezdxf"));
  // Options of drawings are for drawings.
  result = kerfbench(fmt::format("lint --witness '{}'", fixture("machines/two-mirror.yaml").string()));
  EXPECT_EQ(result.exit_code, 65);
  EXPECT_THAT(result.output, HasSubstr("--witness is for drawings"));
}

/// Nothing of the digest depends on the witness, and the report says what it found.
TEST_F(WitnessDemanded, AgreementChangesNoResult) {
  // One unit of the four.
  const fs::path demand = demanding(label());
  std::ofstream(demand, std::ios::app) << "print: {units: 1}\n";
  const auto with = fastRunOf(demand, scratch_);
  ASSERT_EQ(with.exit_code, 0) << with.output;
  EXPECT_THAT(with.output, HasSubstr("the second reader (ezdxf"));
  const auto without =
      fastRunOf(scenarioWith("label-on-belt.yaml", "name: plain\nprint: {units: 1}\n", scratch_), scratch_);
  ASSERT_EQ(without.exit_code, 0) << without.output;
  const auto demanded = verdictOf(scratch_.path() / "demanding");
  const auto plain = verdictOf(scratch_.path() / "plain");
  EXPECT_EQ(demanded.at("digest"), plain.at("digest"));
  EXPECT_THAT(demanded.at("versions").at("drawing").get<std::string>(), HasSubstr("agrees on 1 layer"));
  EXPECT_FALSE(plain.at("versions").contains("drawing"));
  EXPECT_THAT(textOf(scratch_.path() / "demanding/latest/report.html"),
              HasSubstr("agrees on 1 layer, 210.558 mm"));
}

/// A reading that parts is evidence that cannot be trusted: INVALID, and nothing runs.
TEST_F(WitnessDemanded, PartingReadersAreInvalidBeforeAnythingRuns) {
  const auto result =
      kerfbench(fmt::format("run '{}' {}", demanding(unfollowed().string()).string(), into()));
  EXPECT_EQ(result.exit_code, 3) << result.output;
  EXPECT_THAT(result.output, AllOf(HasSubstr("INVALID: drawing unfollowed.svg: layer '#ff0000' (cut)"),
                                   HasSubstr("demanding: INVALID"), Not(HasSubstr("units,"))));
  const auto verdict = verdictOf(scratch_.path() / "demanding");
  EXPECT_EQ(verdict.at("verdict"), "INVALID");
  EXPECT_THAT(verdict.at("problems").dump(), HasSubstr("nothing says which is right"));
  EXPECT_FALSE(fs::exists(scratch_.path() / "demanding/latest/pins.vcd"));
  EXPECT_THAT(textOf(scratch_.path() / "demanding/latest/report.html"),
              HasSubstr("nothing says which is right"));
  EXPECT_THAT(textOf(scratch_.path() / "demanding/latest/junit.xml"),
              HasSubstr("nothing says which is right"));
}

TEST_F(WitnessDemanded, AWitnessThatLiesOrBreaksStopsTheRun) {
  const auto scenario = demanding(label());
  const OtherReader lying(scratch_,
                          R"(print('{"reader": "liar", "mm_per_unit": 1, "groups": [{"names": ["CUT"], '
      '"colours": ["7"], "linetype": "continuous", "plotted": true, "count": 9, "length_mm": 210.56, '
      '"box_mm": [-60, -20, 0, 20]}], "unread": [], "remarks": []}'))");
  auto result = lying.run(fmt::format("run '{}' {}", scenario.string(), into()));
  EXPECT_EQ(result.exit_code, 3) << result.output;
  EXPECT_THAT(result.output, HasSubstr("the second one 210.560000 mm"));
  std::ofstream(scratch_.path() / "other/witness/second_reader.py") << "print('cut')";
  result = lying.run(fmt::format("run '{}' {}", scenario.string(), into()));
  EXPECT_EQ(result.exit_code, 2) << result.output;
  EXPECT_THAT(result.output, HasSubstr("the second reader's answer is no JSON"));
}

TEST_F(WitnessDemanded, OnlyRequiredOrNoneMayBeWritten) {
  const fs::path path = scratch_.path() / "s.yaml";
  std::ofstream(path) << fmt::format("extends: {}\nname: s\ndieline: {{file: {}, witness: maybe}}\n",
                                     fixture("scenarios/label-on-belt.yaml").string(), label());
  const auto result = kerfbench(fmt::format("lint '{}'", path.string()));
  EXPECT_EQ(result.exit_code, 65);
  EXPECT_THAT(result.output, HasSubstr("s.yaml:3: dieline.witness"));
}

}  // namespace
}  // namespace kerfbench::test
