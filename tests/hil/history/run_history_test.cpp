// SPDX-License-Identifier: Apache-2.0
#include "hil/history/run_history.h"

#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/input_error.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/compare/kept_verdict.h"

namespace kerfbench::history {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

/// Runs of a scenario: a verdict and a firmware each, a second apart.
class History : public testing::Test {
 protected:
  fs::path keep(const std::string& verdict, const std::string& firmware, double path_mm = 0.01) {
    nlohmann::json json = compare::plainVerdict();
    json["verdict"] = verdict;
    json["versions"]["firmware sha256"] = firmware;
    json["checks"][0]["value"] = path_mm;
    return compare::keep(json, temp_.path(), seconds_++);
  }
  [[nodiscard]] fs::path folder() const { return temp_.path() / "label"; }

  const base::TempFolder temp_;
  int seconds_{};
};

TEST_F(History, RunsAreListedOldestFirst) {
  const fs::path first = keep("PASS", "a"), second = keep("FAIL", "b");
  fs::create_directories(folder() / "notes");
  const std::vector<KeptRun> runs = runsIn(folder());
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[0].folder.filename(), first.filename());
  EXPECT_EQ(runs[0].date, "2026-11-28 00:00:00");
  EXPECT_TRUE(holdsRuns(folder()));
  EXPECT_FALSE(holdsRuns(first));
  EXPECT_EQ(runMeantBy(folder()).filename(), second.filename());
  EXPECT_EQ(runMeantBy(first), first);
  EXPECT_THROW((void)runMeantBy(temp_.path() / "nothing"), base::InputError);
  EXPECT_THROW((void)runMeantBy(folder() / "notes"), base::InputError);
}

TEST_F(History, TellsWhatWasTested) {
  nlohmann::json json = compare::plainVerdict();
  json["serial_number"] = "K-7 <b>";
  (void)compare::keep(json, temp_.path(), seconds_++);
  (void)keep("PASS", "a");
  std::vector<std::string> problems;
  const std::vector<HistoryRow> rows = readHistory(folder(), problems);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_THAT(historyLines(rows)[0], HasSubstr("serial number K-7 <b>  "));
  EXPECT_THAT(historyLines(rows)[1], testing::Not(HasSubstr("serial number")));
  EXPECT_THAT(historyPage(rows), HasSubstr("<td>K-7 &lt;b&gt;</td>"));
}

TEST_F(History, ADamagedRunIsLeftOutAndTold) {
  (void)keep("PASS", "a");
  std::ofstream(keep("PASS", "b") / "verdict.json") << "{";
  std::vector<std::string> problems;
  EXPECT_EQ(readHistory(folder(), problems).size(), 1U);
  EXPECT_THAT(problems, ElementsAre(HasSubstr("is no verdict")));
}

TEST_F(History, TableAndPageTellVerdictsAndTrends) {
  (void)keep("PASS", "aaaaaaaa11", 0.012);
  (void)keep("FAIL", "bbbbbbbb22", 0.061);
  std::vector<std::string> problems;
  const std::vector<HistoryRow> rows = readHistory(folder(), problems);
  EXPECT_THAT(historyLines(rows),
              ElementsAre(HasSubstr("firmware aaaaaaaa"), HasSubstr("path 0.0610 ± 0.0040 mm of 0.05")));
  const std::string page = historyPage(rows);
  EXPECT_THAT(page, HasSubstr("<svg"));
  EXPECT_THAT(page, HasSubstr("</html>"));
}

TEST_F(History, PruneKeepsTheNewestTheBadAndWhatIsForeign) {
  const fs::path old_pass = keep("PASS", "a"), old_fail = keep("FAIL", "a"), with_notes = keep("PASS", "a");
  std::ofstream(with_notes / "notes.txt") << "mine";
  const fs::path newer = keep("PASS", "b"), newest = keep("PASS", "b");
  const Pruned would = prune(folder(), {.keep = 1, .dry = true});
  EXPECT_EQ(would.removed.size(), 2U);
  EXPECT_TRUE(fs::exists(old_pass));
  const Pruned done = prune(folder(), {.keep = 1});
  EXPECT_THAT(done.kept, ElementsAre(HasSubstr("notes.txt")));
  EXPECT_FALSE(fs::exists(old_pass) || fs::exists(newer));
  EXPECT_TRUE(fs::exists(old_fail) && fs::exists(with_notes) && fs::exists(newest));
  EXPECT_EQ(prune(folder(), {.keep = 0, .keep_worst = false}).removed.size(), 1U);
  EXPECT_TRUE(fs::exists(newest)) << "the latest always stays";
}

}  // namespace
}  // namespace kerfbench::history
