// SPDX-License-Identifier: Apache-2.0
// Procedure of `calibrate head` and its page, with marks that are computed in place of cut ones.
#include "hil/head_service/head_procedure.h"

#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/head_service/head_report.h"
#include "tests/hil/calibrate/head/simulated_head.h"
#include "tests/hil/report/page_checks.h"
#include "twin/base/random.h"

namespace kerfbench::head_service {
namespace {

using Eigen::Vector2d;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr double kMark_mm = 1e-4;

class HeadProcedure : public testing::Test {
 protected:
  HeadProcedure() {
    setup_.name = "m <300> & co";
    setup_.nominal = head_.nominal();
    setup_.nominal.mirror_step_rad = 0.0;
    setup_.design = head_.design();
    setup_.field_W_mm = head_.field_W_mm();
    setup_.controller_W_mm = {Vector2d::Constant(-157), Vector2d::Constant(157)};
    setup_.mark_size_mm = 7.0;
    setup_.off_mm = 13.0;
    plan_.date = "2026-11-22";
  }

  /// A sheet as this head cuts it, measured to a tenth of a micrometre; the first grid lacks a mark.
  MeasuredSheet cut(const SheetOrder& order) {
    names_.push_back(order.job.name);
    rounds_.push_back(order.round);
    MeasuredSheet sheet;
    const CounterRandom noise(static_cast<std::uint64_t>(order.sheet), 1);
    for (const calibrate::WantedMark& mark : order.job.marks) {
      const Vector2d& p = mark.p_W_mm;
      const Vector2d d = order.table ? order.table->at_mm(p).value() : Vector2d(0.0, 0.0);
      const Vector2d aside(order.job.name.starts_with("1-verify") ? first_aside_mm_ : 0.0, 0.0);
      const auto index = 2 * sheet.marks.size();
      const Vector2d off = kMark_mm * Vector2d(noise.normal(index), noise.normal(index + 1));
      sheet.marks.push_back({mark, head_.spotFor(p + d, false) + aside + off,
                             kMark_mm * kMark_mm * Eigen::Matrix2d::Identity()});
    }
    if (order.sheet == 0) {
      sheet.marks.pop_back();
      sheet.missing = 1;
      sheet.remarks = {"mark 8 is <missing>"};
    }
    return sheet;
  }

  HeadCalibration calibrated() {
    return calibrateHead(
        setup_, plan_, [this](const SheetOrder& order) { return cut(order); }, [](const HeadIteration&) {});
  }

  [[nodiscard]] HeadFacts facts() const {
    HeadFacts facts;
    facts.machine = setup_.name;
    facts.command = "./bench calibrate head --machine 'm'";
    facts.version = "0.1.0";
    facts.camera = "kerf & co";
    facts.field_W_mm = setup_.field_W_mm;
    facts.files = {{"correction.csv", "the table"}, {"/elsewhere/out.csv", "another"}};
    return facts;
  }

  calibrate::test::SimulatedHead head_{calibrate::test::HeadKind::kTwoMirror300,
                                       calibrate::test::Beyond::kNothing, 3};
  HeadSetup setup_;
  HeadPlan plan_;
  double first_aside_mm_{};  ///< Displacement of the sheets that verify the first table.
  std::vector<std::string> names_;
  std::vector<int> rounds_;
};

TEST_F(HeadProcedure, GoesFromGridToGridUntilEveryPlaceThatVerifiesIsWithinTheLimit) {
  plan_.limit_mm = 0.0005;
  const HeadCalibration result = calibrated();
  EXPECT_EQ(result.end, HeadEnd::kGood);
  ASSERT_GE(result.iterations.size(), 2U);
  EXPECT_GT(result.iterations[0].before.max_mm, 1.0);
  EXPECT_GT(result.iterations[0].after.max_mm, plan_.limit_mm);
  EXPECT_LE(result.iterations.back().after.max_mm, plan_.limit_mm);
  EXPECT_EQ(result.verdictName(), "GOOD");
  EXPECT_EQ(result.iterations.back().after.marks, 400U);
  EXPECT_EQ(result.best, result.iterations.size() - 1);
  EXPECT_EQ(names_[0], "1-grid");
  EXPECT_EQ(names_[1], "1-verify-1");
  EXPECT_EQ(rounds_[0], 0);
  EXPECT_EQ(rounds_[1], 1);
}

TEST_F(HeadProcedure, VerifiesOnSeveralSheetsAtPlacesThatWereNotMarkedForTheFit) {
  setup_.mark_size_mm = 14.0;  // The marks are as many as there is room for on one sheet: fewer.
  plan_.grids = {9};
  const HeadCalibration result = calibrated();
  const HeadIteration& only = result.iterations.at(0);
  EXPECT_GT(only.verified.size(), 2U);
  EXPECT_THAT(rounds_, testing::Contains(1).Times(only.verified.size()));
  std::set<std::pair<double, double>> places;
  for (const MeasuredSheet& sheet : only.verified) {
    for (const MeasuredMark& mark : sheet.marks) {
      const Vector2d& p = mark.wanted.p_W_mm;
      EXPECT_TRUE(places.emplace(p.x(), p.y()).second);
      for (const MeasuredMark& marked : only.marks.marks)
        ASSERT_GE(calibrate::marksApart_mm(p, marked.wanted.p_W_mm), 0.25 * setup_.mark_size_mm);
    }
  }
  EXPECT_EQ(places.size(), 400U);
}

TEST_F(HeadProcedure, EndsAfterTheLastGridWhenItIsNotGoodEnough) {
  plan_.grids = {3};
  plan_.verify = 20;
  plan_.limit_mm = 1e-6;
  const HeadCalibration result = calibrated();
  EXPECT_EQ(result.end, HeadEnd::kGridsUsed);
  EXPECT_FALSE(result.good());
  EXPECT_THAT(names_, ElementsAre("1-grid", "1-verify-1"));
}

// Tolerances let the fit to nine marks leave a doubt beyond the limit, however good the places that
// verify are: with them it is settled what the table is worth.
TEST_F(HeadProcedure, IsGoodOnlyIfItsUncertaintyIsWithinTheLimitToo) {
  plan_.grids = {3};
  for (const double limit_mm : {0.005, 0.010, 0.020}) {
    plan_.limit_mm = limit_mm;
    const HeadCalibration result = calibrated();
    const HeadIteration& best = result.iterations.at(result.best);
    EXPECT_GT(2.0 * best.head.table.largest_sigma_mm, 0.010);
    const calibrate::LargestError& largest = best.table.largest;
    EXPECT_LT(largest.U_mm, 0.001);
    EXPECT_EQ(result.good(), largest.value_mm + largest.U_mm <= limit_mm) << result.endWords(plan_);
    EXPECT_GE(largest.value_mm + largest.U_mm, best.after.max_mm - 0.0005);
    EXPECT_TRUE(best.table.coverHolds()) << best.table.covered;
  }
}

TEST_F(HeadProcedure, IsNotProvenWithinItsUncertaintyOfTheLimit) {
  plan_.grids = {3};
  const calibrate::LargestError largest = calibrated().iterations.at(0).table.largest;
  plan_.limit_mm = largest.value_mm + 0.5 * largest.U_mm;
  const HeadCalibration near = calibrated();
  EXPECT_EQ(near.verdict, inspect::Verdict::kNotProven);
  EXPECT_EQ(near.verdictName(), "NOT PROVEN");
  EXPECT_THAT(
      headHtml(near, plan_, facts()),
      HasSubstr("<header class=notproven><div class=big>NOT PROVEN</div><p>The table is near its limit"));
  EXPECT_THAT(headJson(near, plan_, facts()), HasSubstr("\"verdict\": \"NOT PROVEN\""));
  plan_.limit_mm = largest.value_mm - 1.1 * largest.U_mm;
  EXPECT_EQ(calibrated().verdict, inspect::Verdict::kFail);
  plan_.limit_mm = largest.value_mm + 1.1 * largest.U_mm;
  EXPECT_EQ(calibrated().verdictName(), "GOOD");
}

/// A procedure in which the sheets that verify the first table lie farther off than their stated uncertainty.
class HeadNotAsStated : public HeadProcedure {
 protected:
  HeadNotAsStated() {
    first_aside_mm_ = 0.05;
    setup_.unmodelled_share = 1e-6;
    plan_.verify = 40;
    plan_.limit_mm = 0.5;
  }
};

TEST_F(HeadNotAsStated, IsMarkedOnceMoreThoughItsTableIsWithinTheLimit) {
  const HeadCalibration result = calibrated();
  EXPECT_EQ(result.end, HeadEnd::kGood);
  ASSERT_EQ(result.iterations.size(), 2U);
  EXPECT_LT(result.iterations[0].after.max_mm, plan_.limit_mm);
  EXPECT_FALSE(result.iterations[0].spread.holds());
  EXPECT_TRUE(result.iterations[1].spread.holds());
  EXPECT_EQ(result.best, 1U);
  EXPECT_EQ(result.endWords(plan_).find("as stated"), std::string::npos);
}

TEST_F(HeadNotAsStated, IsGoodAndToldIfThereIsNoOtherGrid) {
  plan_.grids = {3};
  const HeadCalibration result = calibrated();
  EXPECT_TRUE(result.good());
  EXPECT_THAT(result.endWords(plan_), HasSubstr("; by what the fit alone states they are off "));
  EXPECT_THAT(headHtml(result, plan_, facts()), HasSubstr("<b>what the fit states is too small</b>"));
  EXPECT_THAT(headHtml(result, plan_, facts()), HasSubstr("<td class='num hit'>"));
}

TEST_F(HeadProcedure, HasAPageThatNeedsNothingElseAndEscapesWhatOthersWrote) {
  plan_.limit_mm = 0.0005;
  const HeadCalibration result = calibrated();
  const std::string html = headHtml(result, plan_, facts());
  EXPECT_EQ(report::test::outsideReferences(html, "correction.csv"), "");
  EXPECT_EQ(report::test::numberFaults(html), "");
  EXPECT_EQ(report::test::unclosedElements(html), "");
  EXPECT_LT(html.size(), 1U << 20U);
  EXPECT_EQ(headHtml(result, plan_, facts()), html);
  EXPECT_THAT(
      html,
      HasSubstr("<header class=pass><div class=big>GOOD</div><p>The table is good: anywhere in the field"));
  EXPECT_THAT(html, HasSubstr("m &lt;300&gt; &amp; co"));
  EXPECT_THAT(html, HasSubstr("mark 8 is &lt;missing&gt;"));
  EXPECT_THAT(html, Not(HasSubstr("<300>")));
  EXPECT_THAT(html, HasSubstr("8 of 9"));
  EXPECT_THAT(html, HasSubstr("<code>/elsewhere/out.csv</code>"));
  EXPECT_THAT(html, HasSubstr("<b>Before</b>, errors × "));
  EXPECT_THAT(html, HasSubstr("<b>After</b>, errors × "));
}

TEST_F(HeadProcedure, ItsPageTellsTheVerdictHoweverItEnded) {
  plan_.grids = {3};
  plan_.verify = 20;
  plan_.limit_mm = 1e-6;
  HeadCalibration result = calibrated();
  EXPECT_THAT(
      headHtml(result, plan_, facts()),
      HasSubstr("<header class=fail><div class=big>NOT GOOD</div><p>The table is not good enough, after"));
  result.end = HeadEnd::kNoBetter;
  EXPECT_THAT(headHtml(result, plan_, facts()), HasSubstr("a denser grid no longer improves it"));

  const HeadCalibration once = calibrateHeadOnce(setup_, plan_, result.iterations[0].marks);
  EXPECT_FALSE(once.good());  // The fit alone states that.
  EXPECT_THAT(once.endWords(plan_), testing::StartsWith("NOT GOOD: fitted and not verified"));
  plan_.limit_mm = 0.2;
  const HeadCalibration wide = calibrateHeadOnce(setup_, plan_, result.iterations[0].marks);
  EXPECT_TRUE(wide.good());
  const std::string html = headHtml(wide, plan_, facts());
  EXPECT_THAT(html, HasSubstr("<header class=notproven><div class=big>NOT VERIFIED</div>"));
  EXPECT_THAT(html, Not(HasSubstr("<b>After</b>")));
  EXPECT_EQ(report::test::outsideReferences(html, "correction.csv") + report::test::numberFaults(html) +
                report::test::unclosedElements(html),
            "");
}

}  // namespace
}  // namespace kerfbench::head_service
