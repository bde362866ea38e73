// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/check_history.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "hil/base/yaml_reader.h"
#include "hil/calibrate/files/day.h"
#include "hil/head_service/check_report.h"
#include "tests/hil/base/temp_folder.h"
#include "tests/hil/report/page_checks.h"
#include "twin/base/random.h"

namespace kerfbench::head_service {
namespace {

using testing::HasSubstr;

constexpr double kU_mm = 4e-4;
constexpr double kDaysPerMonth = 365.25 / 12.0;

/// A check each fortnight for five months, whose zero of x goes by `per_month`, read with noise.
std::vector<HeadCheckRecord> checks(double per_month, std::uint64_t seed, double noise_over_u = 1.0) {
  const CounterRandom random(seed, 1);
  std::vector<HeadCheckRecord> records;
  for (int i = 0; i < 11; ++i) {
    HeadCheckRecord record{calibrate::isoDay(20700 + 14 * i), "m", "c", std::to_string(i), true, 0.003, {}};
    for (std::size_t k = 0; k < kFollowedDrifts; ++k) record.drifts[k] = {0.0, k < 2 ? kU_mm : 1e-5};
    record.drifts[0].value = per_month * 14.0 * i / kDaysPerMonth +
                             0.5 * noise_over_u * kU_mm * random.normal(static_cast<std::uint64_t>(i));
    records.push_back(record);
  }
  return records;
}

TEST(CheckHistory, KeepsChecksByDateAndASheetOnce) {
  const base::TempFolder temp;
  const auto file = temp.path() / "checks.jsonl";
  EXPECT_TRUE(readCheckHistory(file).empty());
  const auto all = checks(1e-3, 1);
  for (const std::size_t i : {4U, 0U, 7U}) addToCheckHistory(file, all[i]);
  HeadCheckRecord again = all[4];
  again.off_mm = 0.004;
  const auto kept = addToCheckHistory(file, again);
  ASSERT_EQ(kept.size(), 3U);
  EXPECT_EQ(kept[0].date, all[0].date);
  EXPECT_EQ(kept[1].off_mm, 0.004);
  EXPECT_EQ(kept[2].drifts[0].value, all[7].drifts[0].value);
  const auto read = readCheckHistory(file);
  ASSERT_EQ(read.size(), 3U);
  EXPECT_EQ(read[2].sheet, "7");
  std::ofstream(file, std::ios::app) << "{\n\n{\"date\": \"today\"}\n";
  try {
    readCheckHistory(file);
    FAIL();
  } catch (const base::ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("checks.jsonl:4: is no check"));
    EXPECT_THAT(error.what(), HasSubstr("checks.jsonl:6: is no check"));
  }
}

TEST(CheckHistory, IsoDaysAreThoseOfDayNumbers) {
  for (const int day : {0, 59, 20700, 20789, 24837})
    EXPECT_EQ(calibrate::dayNumber(calibrate::isoDay(day)), day);
  EXPECT_EQ(calibrate::isoDay(0), "1970-01-01");
}

TEST(DriftTrend, ItsUncertaintyHoldsTheTrueDrift) {
  int within = 0, alarms = 0;
  constexpr int kHistories = 400;
  for (std::uint64_t seed = 1; seed <= kHistories; ++seed) {
    const DriftTrend trend = trendOf(checks(1.5e-3, seed), 0, 1.0, 0.010).value();
    within += std::abs(trend.per_month - 1.5e-3) <= trend.U_per_month ? 1 : 0;
    alarms += trendOf(checks(0.0, seed), 0, 1.0, 0.010)->drifts() ? 1 : 0;
  }
  // 95.45 % of 400, 99 % of chance; U is raised where values scatter, never lowered.
  EXPECT_GE(within, 370);
  EXPECT_LE(alarms, 30);
}

TEST(DriftTrend, ScatterBeyondWhatIsStatedWidensIt) {
  const DriftTrend quiet = trendOf(checks(1e-3, 3), 0, 1.0, 0.010).value();
  const DriftTrend wild = trendOf(checks(1e-3, 3, 8.0), 0, 1.0, 0.010).value();
  EXPECT_GT(wild.U_per_month, 4.0 * quiet.U_per_month);
}

TEST(DriftTrend, SaysWhenTheLimitIsReached) {
  const auto records = checks(2e-3, 5);
  const DriftTrend trend = trendOf(records, 0, 1.0, 0.013).value();
  EXPECT_TRUE(trend.drifts());
  const double months = 0.013 / 2e-3;
  ASSERT_TRUE(trend.likely_day && trend.may_day);
  EXPECT_NEAR(*trend.likely_day, 20700 + months * kDaysPerMonth, 12.0);
  EXPECT_LT(*trend.may_day, *trend.likely_day);
  EXPECT_FALSE(trendOf(records, 1, 1.0, 0.013)->likely_day);  // The other zero stays.
  EXPECT_FALSE(trendOf({records[0], records[1]}, 0, 1.0, 0.013));
  EXPECT_FALSE(trendOf({records[0], records[0], records[0]}, 0, 1.0, 0.013));
}

TEST(CheckReport, IsOnePageWithAPlotForEachDrift) {
  calibrate::QuickCheckResult result;
  for (std::size_t k = 0; k < result.drifts.size(); ++k)
    result.drifts[k] = {static_cast<calibrate::HeadDrift>(k), 1e-3, 1e-4, k == 0};
  result.words = "zero of x changed by +0.001 <mm>";
  MeasuredSheet sheet;
  sheet.marks = {{{1, {0.0, 0.0}}, {0.004, 0.0}, Eigen::Matrix2d::Identity()}};
  const CheckFacts facts{"m",
                         "kerf",
                         "2027-01-05",
                         "./bench calibrate check",
                         "1.0",
                         "results/head",
                         "t.csv",
                         0.010,
                         {Eigen::Vector2d(-50, -50), Eigen::Vector2d(50, 50)}};
  const std::string html = checkHtml(result, sheet, checks(1.5e-3, 2), facts);
  EXPECT_EQ(report::test::outsideReferences(html, "") + report::test::numberFaults(html) +
                report::test::unclosedElements(html),
            "");
  EXPECT_THAT(html, HasSubstr("<header class=fail><div class=big>DOES NOT HOLD</div>"));
  EXPECT_THAT(html, HasSubstr("zero of x changed by +0.001 &lt;mm&gt;"));
  EXPECT_THAT(html, HasSubstr("<b>drifts</b>"));
  EXPECT_THAT(html, HasSubstr("no drift is proven"));
  for (const char* drift : {"zero of x", "zero of y", "gain of x", "gain of y", "turn of the head"})
    EXPECT_THAT(html, HasSubstr(fmt::format("aria-label='{} over the checks'", drift)));
  result.holds = true;
  const std::string first = checkHtml(result, sheet, {checks(0.0, 2).front()}, facts);
  EXPECT_THAT(first, HasSubstr("A drift needs three checks on two days at least."));
  EXPECT_THAT(first, HasSubstr("<div class=big>HOLDS</div>"));
  HeadCheckRecord other = checks(0.0, 1).front();
  other.calibration = "another";
  EXPECT_EQ(comparable({other, checks(0.0, 1).back()}, checks(0.0, 1).front()).size(), 1U);
}

}  // namespace
}  // namespace kerfbench::head_service
