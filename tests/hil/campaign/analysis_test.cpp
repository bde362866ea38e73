// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/analysis.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace kerfbench::campaign {
namespace {

using testing::HasSubstr;
using testing::Not;

Record recordWith(std::size_t run, const std::string& speed, const std::string& outcome) {
  Record r;
  r.run = run;
  r.base = "label";
  r.factors = {{"speed", speed, std::nullopt}};
  r.outcome = outcome;
  return r;
}

TEST(CampaignAnalysis, RatesCountWhatWasJudged) {
  std::vector<Record> records;
  for (int i = 0; i < 10; ++i) records.push_back(recordWith(records.size(), "9", i < 5 ? "PASS" : "FAIL"));
  for (int i = 0; i < 10; ++i) records.push_back(recordWith(records.size(), "10", "PASS"));
  for (const char* other : {"NOT PROVEN", "INVALID", kRefused, kBroken})
    records.push_back(recordWith(records.size(), "11", other));
  const Analysis a = analyse(records);
  EXPECT_EQ(a.outcomes.all(), 24U);
  EXPECT_EQ(a.outcomes.judged(), 22U);
  ASSERT_EQ(a.rates.size(), 1U);
  const std::vector<RateRow>& rows = a.rates[0].rows;
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].value, "9");  // Values are in the order of numbers, not of letters.
  EXPECT_NEAR(rows[0].pass_rate->low, 0.1871, 5e-5);
  EXPECT_NEAR(rows[0].pass_rate->high, 0.8129, 5e-5);
  EXPECT_NEAR(rows[1].pass_rate->low, 0.6915, 5e-5);
  EXPECT_EQ(rows[2].outcomes.judged(), 2U);
  EXPECT_EQ(rows[2].outcomes.refused, 1U);
  EXPECT_EQ(rows[2].outcomes.broken, 1U);
}

TEST(CampaignAnalysis, ManyNumbersBecomeRangesOfAllRuns) {
  std::vector<Record> records;
  for (std::size_t i = 0; i < 100; ++i)
    records.push_back(recordWith(i, std::to_string(0.5 + static_cast<double>(i)), "PASS"));
  const std::vector<RateRow> rows = analyse(records).rates[0].rows;
  ASSERT_EQ(rows.size(), 6U);
  std::size_t all = 0;
  for (const RateRow& row : rows) {
    all += row.outcomes.all();
    EXPECT_NEAR(static_cast<double>(row.outcomes.all()), 16.7, 1.0);
    EXPECT_THAT(row.value, HasSubstr(" … "));
  }
  EXPECT_EQ(all, 100U);
}

TEST(CampaignAnalysis, AFaultIsFoundByFailOrByWhateverDoesNotPass) {
  std::vector<Record> records;
  const auto add = [&](const std::string& base, double size, const std::string& outcome) {
    Record r = recordWith(records.size(), "1", outcome);
    r.base = base;
    r.factors.push_back({"fault", "scale", size});
    records.push_back(r);
  };
  for (const char* base : {"label", "carton"}) {
    add(base, 1, "PASS");
    add(base, 2, "NOT PROVEN");
    add(base, 3, "PASS");
    add(base, 4, "FAIL");
    add(base, 5, kRefused);
  }
  Record none = recordWith(99, "1", "FAIL");
  none.factors.push_back({"fault", "none", std::nullopt});
  records.push_back(none);
  const Analysis a = analyse(records);
  ASSERT_EQ(a.detections.size(), 2U);
  EXPECT_EQ(a.detections[0].base, "carton");
  EXPECT_EQ(a.detections[0].by_fail.trials, 4U);
  EXPECT_EQ(a.detections[0].by_fail.found, 1U);
  EXPECT_EQ(a.detections[0].by_fail.largest_missed, 3.0);
  EXPECT_EQ(a.detections[0].by_no_pass.found, 2U);
  EXPECT_EQ(a.detections[0].by_no_pass.smallest_found, 2.0);
  // The scenario is a factor as soon as there are two.
  EXPECT_EQ(a.rates[0].factor, "scenario");
}

TEST(CampaignAnalysis, TheThinnestMarginComesFirst) {
  EXPECT_NEAR(*marginOf({"a", "PASS", "mm", 0.03, 0.01, 0.05, false}), 0.2, 1e-12);
  EXPECT_NEAR(*marginOf({"a", "PASS", "", 0.9, 0.02, 0.8, true}), 0.1, 1e-12);
  EXPECT_LT(*marginOf({"a", "PASS", "mm", 0.045, 0.01, 0.05, false}), 0.0);
  EXPECT_FALSE(marginOf({"a", "PASS", "", 0.0, 0.0, 0.0, false}));
  EXPECT_FALSE(marginOf({"a", "PASS", "", std::nullopt, 0.0, 1.0, false}));
  std::vector<Record> records;
  const std::vector<double> values{0.01, 0.04, 0.02};
  for (std::size_t i = 0; i < 3; ++i) {
    Record r = recordWith(i, std::to_string(i), "PASS");
    r.checks = {{"edge", "PASS", "mm", 0.01, 0.0, 0.05, false},
                {"path", "PASS", "mm", values[i], 0.005, 0.05, false}};
    records.push_back(r);
  }
  Record bad = recordWith(3, "3", "FAIL");
  bad.checks = {{"edge", "FAIL", "mm", 0.2, 0.0, 0.05, false}};
  bad.factors.push_back({"fault", "scale", 1.0});
  records.push_back(bad);
  const Analysis a = analyse(records);
  EXPECT_TRUE(a.margins_of_good);
  ASSERT_EQ(a.margins.size(), 2U);
  EXPECT_EQ(a.margins[0].check, "path");
  EXPECT_EQ(a.margins[0].thinnest_run, 1U);
  EXPECT_NEAR(a.margins[0].least, 0.1, 1e-12);
  EXPECT_NEAR(a.margins[0].median, 0.5, 1e-12);
  EXPECT_EQ(a.margins[1].runs, 3U);
  // A good run that fails has the thinnest margin of all.
  records[3].factors.pop_back();
  EXPECT_NEAR(analyse(records).margins[0].least, -3.0, 1e-12);
  // Where all have a fault, those that passed are what there is.
  for (Record& r : records) r.factors.push_back({"fault", "scale", 1.0});
  EXPECT_FALSE(analyse(records).margins_of_good);
  EXPECT_EQ(analyse(records).margins[1].runs, 3U);
  ASSERT_EQ(a.counts.size(), 1U);
  EXPECT_EQ(a.counts[0].check, "edge");
  EXPECT_EQ(a.counts[0].fail, 1U);
}

/// All that a page can have.
std::vector<Record> manyRecords() {
  std::vector<Record> records;
  for (std::size_t i = 0; i < 60; ++i) {
    const double size = 0.01 * static_cast<double>(i + 1);
    const bool found = i > 40 || i % 7 == 3;
    Record r = recordWith(i, i % 2 == 0 ? "30" : "<45>", found ? "FAIL" : "PASS");
    r.factors.push_back({"load", std::to_string(size), std::nullopt});
    r.factors.push_back({"fault", i % 3 == 0 ? "late" : "scale & turn", size});
    r.checks = {{"path", r.outcome, "mm", 0.02 + 0.0004 * static_cast<double>(i), 0.002, 0.05, false}};
    records.push_back(r);
  }
  records[5].outcome = kRefused;
  records[5].reason = "too <fast>";
  return records;
}

TEST(CampaignAnalysis, ThePageHasAllPartsAndLoadsNothing) {
  const std::vector<Record> records = manyRecords();
  Analysis a = analyse(records);
  a.name = "c";
  a.title = "A & B";
  a.missing = {60, 61};
  const std::string page = analysisPage(a, records);
  for (const char* part : {"A &amp; B", "Pass rate", "Smallest fault found", "Margins",
                           "Checks that did not pass", "Runs without a verdict", "too &lt;fast&gt;",
                           "&lt;45&gt;", "scale &amp; turn", "2 are missing (60-61)", "<path class=curve"})
    EXPECT_THAT(page, HasSubstr(part));
  for (const char* foreign : {"http://", "https://", "src=", "@import", "too <fast>", "<45>", "nan", "inf "})
    EXPECT_THAT(page, Not(HasSubstr(foreign)));
  EXPECT_EQ(analysisPage(a, records), page);
}

TEST(CampaignAnalysis, TheJsonSaysTheSame) {
  const std::vector<Record> records = manyRecords();
  Analysis a = analyse(records);
  a.name = "c";
  const auto json = nlohmann::json::parse(analysisJson(a));
  EXPECT_EQ(json.at("outcomes").at("all"), 60);
  EXPECT_EQ(json.at("faults").size(), 2U);
  const auto& fit = json.at("faults")[1].at("found_is_fail").at("fit");
  ASSERT_TRUE(fit.is_object());
  EXPECT_EQ(fit.at("over"), "ln(size)");
  EXPECT_EQ(fit.at("half_found").at("size"), a.detections[1].by_fail.fit->half.size);
  EXPECT_EQ(json.at("factors")[0].at("values")[0].at("pass_rate_95").size(), 2U);
  EXPECT_EQ(json.at("margins")[0].at("check"), "path");
  EXPECT_THAT(analysisLines(a).at(0), HasSubstr("60 runs"));
}

TEST(CampaignAnalysis, NoRunsGiveAPageThatSaysSo) {
  const Analysis a = analyse({});
  EXPECT_THAT(analysisPage(a, {}), HasSubstr("0 PASS"));
  EXPECT_EQ(nlohmann::json::parse(analysisJson(a)).at("runs"), 0);
}

}  // namespace
}  // namespace kerfbench::campaign
