// SPDX-License-Identifier: Apache-2.0
// Command `gauge`: the accuracy of the instrument, from pixels.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

class Gauge : public testing::Test {
 protected:
  [[nodiscard]] ProgramRun gauge(const std::string& options) const {
    return kerfbench(fmt::format("gauge '{}' --results-dir '{}' {}",
                                 fixture("machines/two-mirror.yaml").string(), scratch_.path().string(),
                                 options));
  }
  [[nodiscard]] nlohmann::json json() const {
    return nlohmann::json::parse(textOf(scratch_.path() / "gauge" / "gauge.json"));
  }
  ScratchFolder scratch_;
};

/// One of the long proofs.
class GaugeLong : public Gauge {};

/// Claims with these words that do not hold.
std::string failing(const nlohmann::json& json, const std::vector<std::string>& words) {
  std::string text;
  std::size_t seen = 0;
  for (const auto& claim : json.at("claims")) {
    const auto what = claim.at("claim").get<std::string>();
    for (const std::string& word : words) {
      if (what.find(word) == std::string::npos) continue;
      ++seen;
      if (claim.at("state") == "fails") text += claim.dump() + "\n";
    }
  }
  // A word that no claim has would check nothing.
  return seen < words.size() * json.at("sections").size() ? "claims are missing\n" + text : text;
}

const std::vector<std::string> kNoBadCutPasses{"bad cuts that PASS: offset", "bad cuts that PASS: bump",
                                               "bad cuts that PASS: corner", "bad cuts that PASS: end",
                                               "bad cuts that PASS: scale",  "bad cuts that PASS: rotation",
                                               "bad cuts that PASS: wave",   "bad cuts that PASS: entity"};

TEST_F(GaugeLong, QuickShowsWhatTheInstrumentIsWorth) {
  const ProgramRun run = gauge("--quick --quiet");
  ASSERT_TRUE(run.exit_code == 0 || run.exit_code == 1) << run.output;
  const auto result = json();
  EXPECT_EQ(failing(result, {"U (k = 2) of 95 % of cases: worst of an entity",
                             "U (k = 2) of 95 % of cases: largest drift", "σ of repeats", ": Cg", ": Cgk",
                             "%GRR", "ndc", "largest drift: budget and Monte-Carlo"}),
            "")
      << run.output;
  EXPECT_EQ(failing(result, kNoBadCutPasses), "") << run.output;
  EXPECT_EQ(failing(result, {"good cuts that FAIL", "good cuts NOT PROVEN", "could not be measured"}), "")
      << run.output;
  EXPECT_EQ(failing(result, {"hold the truth: largest drift", "hold the truth: drift of a cut"}), "")
      << run.output;
  std::size_t good = 0;
  std::size_t bad = 0;
  for (const auto& section : result.at("sections")) {
    for (const auto& fault : section.at("faults")) {
      for (const auto& [verdict, count] : fault.at("bad").items()) bad += count.get<std::size_t>();
      for (const auto& [verdict, count] : fault.at("good").items()) good += count.get<std::size_t>();
    }
  }
  EXPECT_EQ(bad, 300U);
  EXPECT_EQ(good, 300U);
  EXPECT_EQ(run.exit_code == 0, result.at("holds").get<bool>());
  EXPECT_THAT(textOf(scratch_.path() / "gauge" / "gauge.html"), HasSubstr("</html>"));
}

// The long proof has 6000 cuts: docs/explanation/what-it-is-worth.md.
TEST_F(Gauge, InWorldsThatAreNotItsOwnNoBadCutPassesAndNoGoodOneFails) {
  const ProgramRun run =
      gauge("--mismatch --studies verdicts --bad 24 --good 8 --imperfections static --seed 2026 --quiet");
  ASSERT_TRUE(run.exit_code == 0 || run.exit_code == 1) << run.output;
  EXPECT_EQ(failing(json(), kNoBadCutPasses), "") << run.output;
  EXPECT_EQ(failing(json(), {"good cuts that FAIL"}), "") << run.output;
}

// Legs that stop short of each other explain a corner of 120 degrees that was cut off almost as well as an
// arc does: what was 60 um off was read as 33, with a U of a few. U holds both: one case in twenty may still
// miss by a little.
TEST_F(Gauge, ACutOffCornerThatMayBeShortLegsIsNotProven) {
  const ProgramRun run =
      gauge("--mismatch --studies verdicts --imperfections static --seed 90 --case static-bad-170");
  EXPECT_THAT(run.output, HasSubstr("true deviation 59.71"));
  EXPECT_THAT(run.output, Not(HasSubstr("static-bad-170: PASS")));
  EXPECT_THAT(run.output, ContainsRegex("corner off the dieline +[0-9.]+ +[2-9][0-9]\\.[0-9]+ "))
      << run.output;
}

TEST_F(Gauge, GivesTheSameBytesAtAnyNumberOfJobs) {
  const std::string few =
      "--quiet --studies verdicts,coverage,stillness --bad 8 --good 8 --cases 6 --imperfections dynamic "
      "--seed 5 --jobs ";
  std::string before;
  for (const char* jobs : {"1", "3"}) {
    (void)gauge(few + jobs);
    auto result = json();
    result.erase("command");
    if (before.empty()) {
      before = result.dump();
    } else {
      EXPECT_EQ(result.dump(), before);
    }
  }
}

TEST_F(Gauge, RepeatsASingleCase) {
  const ProgramRun run = gauge("--case static-bad-0");
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output, HasSubstr("static-bad-0: FAIL, true deviation"));
  EXPECT_THAT(run.output, HasSubstr("worst of all lines"));
  EXPECT_TRUE(fs::exists(scratch_.path() / "static-bad-0.png"));
  EXPECT_EQ(gauge("--case static-still-1").exit_code, 0);
}

TEST_F(Gauge, RefusesWhatItCannotDo) {
  EXPECT_EQ(gauge("--case nonsense").exit_code, 64);
  EXPECT_EQ(gauge("--imperfections much").exit_code, 64);
  EXPECT_EQ(kerfbench("gauge no-such-machine.yaml").exit_code, 65);
  std::ofstream(scratch_.path() / "m.yaml") << "extends: " << fixture("machines/two-mirror.yaml").string()
                                            << "\nname: m\ncameras: {kerf: {calibration: none.yaml}}\n";
  const ProgramRun run = kerfbench(fmt::format("gauge '{}'", (scratch_.path() / "m.yaml").string()));
  EXPECT_EQ(run.exit_code, 65);
  EXPECT_THAT(run.output, HasSubstr("its calibration"));
  EXPECT_THAT(run.output, HasSubstr("is missing"));
}

}  // namespace
}  // namespace kerfbench::test
