// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/record.h"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/input_error.h"

namespace kerfbench::campaign {
namespace {

using testing::HasSubstr;
using testing::Not;

Record fullRecord() {
  Record r;
  r.run = 12;
  r.base = "label";
  r.factors = {{"speed", "33.3", std::nullopt}, {"fault", "scale \"x\"", 0.1}};
  r.seed = 999'999'999;
  r.outcome = "NOT PROVEN";
  r.checks = {{"path", "NOT PROVEN", "mm", 0.1 + 0.2, 1e-17, 0.05, false},
              {"edge", "INVALID", "", std::nullopt, 0.0, std::nullopt, true}};
  r.digest = "ab";
  return r;
}

TEST(CampaignRecord, ALineComesBackAsItWas) {
  const Record r = fullRecord();
  const std::string line = lineOf(r);
  EXPECT_THAT(line, Not(HasSubstr("\n")));
  EXPECT_EQ(recordFrom(line), r);
  EXPECT_EQ(lineOf(recordFrom(line)), line);
  Record refused;
  refused.outcome = kRefused;
  refused.reason = "line\nbreak";
  EXPECT_EQ(recordFrom(lineOf(refused)), refused);
}

TEST(CampaignRecord, WhatIsNoRecordIsRefused) {
  EXPECT_THROW((void)recordFrom(""), base::InputError);
  EXPECT_THROW((void)recordFrom("[]"), base::InputError);
  std::string line = lineOf(fullRecord());
  EXPECT_THROW((void)recordFrom(line.replace(line.find("\"run\""), 5, "\"ran\"")), base::InputError);
}

TEST(CampaignRecord, AVerdictGivesChecksWithTheirUncertainty) {
  compare::RunFigures figures;
  figures.verdict = "FAIL";
  figures.digest = "cd";
  figures.checks["path"] = {"FAIL", "E0", 0.05, "mm"};
  figures.checks["coverage"] = {"INVALID", "", std::nan(""), ""};
  figures.figures = {
      {compare::Figure::Of::kEntity, "path", "worst_mm", "mm", 9.0, 9.0, compare::Better::kNearZero},
      {compare::Figure::Of::kCheck, "path", "value", "mm", 0.07, 0.002, compare::Better::kLarger}};
  Record r;
  addVerdict(r, figures);
  EXPECT_EQ(r.outcome, "FAIL");
  ASSERT_EQ(r.checks.size(), 2U);
  EXPECT_EQ(r.checks[1], (CheckRecord{"path", "FAIL", "mm", 0.07, 0.004, 0.05, true}));
  EXPECT_EQ(r.checks[0], (CheckRecord{"coverage", "INVALID", "", std::nullopt, 0.0, std::nullopt, false}));
}

}  // namespace
}  // namespace kerfbench::campaign
