// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/safe_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace kerfbench::inspect {
namespace {

PulseTiming goodPulses() {
  PulseTiming timing;
  timing.axis = "galvo_x";
  timing.pulses = 100;
  timing.min_setup_s = timing.min_hold_s = timing.min_width_s = timing.min_space_s = 1e-3;
  return timing;
}

ControllerAccount goodAccount() {
  return {true, {{"galvo_x", 120, 120}, {"galvo_y", -3, -3}}, ControllerAccount::Belt{500, 490, 505}};
}

// Evidence of a guard that opens at 1 s: the laser is dark 50 us later, axes stand at once.
SafeStateEvidence good() {
  SafeStateEvidence evidence;
  evidence.demand = {"the guard was opened", 1.0, 0.0, 0.0016, 0.05, {"interlock"}};
  evidence.gates = {{0.2, 0.5}, {0.9, 1.00005}};
  evidence.last_pulse_s = 1.0003;
  evidence.end_s = 1.5;
  evidence.reports = {{0.1, false, "ok"}, {1.002, true, "interlock"}};
  evidence.pulses = {goodPulses()};
  evidence.account = goodAccount();
  return evidence;
}

Verdict verdictOf(const InspectionResult& result, const std::string& name) {
  for (const Check& check : result.checks) {
    if (check.name == name) return check.verdict;
  }
  ADD_FAILURE() << "no check " << name;
  return Verdict::kInvalid;
}

TEST(SafeState, ReachedInTimeIsAPass) {
  const auto result = inspectSafeState(good());
  EXPECT_EQ(result.verdict, Verdict::kPass);
  EXPECT_EQ(result.checks.size(), 5U);
}

TEST(SafeState, ALaserOnTooLongFails) {
  auto evidence = good();
  evidence.gates.back().off_s = 1.000101;
  EXPECT_EQ(verdictOf(inspectSafeState(evidence), "safe_state"), Verdict::kFail);
  evidence.gates.back().off_s = 1.0000999;
  EXPECT_EQ(verdictOf(inspectSafeState(evidence), "safe_state"), Verdict::kPass);
}

TEST(SafeState, ALaserThatComesOnAgainFails) {
  auto evidence = good();
  evidence.gates.push_back({1.3, 1.3001});
  const auto result = inspectSafeState(evidence);
  EXPECT_EQ(verdictOf(result, "safe_state"), Verdict::kFail);
  EXPECT_EQ(result.verdict, Verdict::kFail);
}

TEST(SafeState, TheWindowOfAnInferredCauseCounts) {
  auto evidence = good();
  evidence.demand.window_s = 0.01;
  evidence.gates.back().off_s = 1.01005;
  evidence.last_pulse_s = 1.0115;
  evidence.reports.back().time_s = 0.99;  // The controller's report may be before the bench's.
  EXPECT_EQ(inspectSafeState(evidence).verdict, Verdict::kPass);
  evidence.gates.back().off_s = 1.0102;
  EXPECT_EQ(verdictOf(inspectSafeState(evidence), "safe_state"), Verdict::kFail);
}

TEST(SafeState, ADarkLaserProvesNothing) {
  auto evidence = good();
  evidence.gates = {{0.2, 0.5}};
  const auto result = inspectSafeState(evidence);
  EXPECT_EQ(result.verdict, Verdict::kInvalid);
  EXPECT_THAT(result.problems, ::testing::ElementsAre(::testing::HasSubstr("dark")));
  // So does one that comes on at that very instant.
  evidence.gates.push_back({evidence.demand.cause_s, evidence.demand.cause_s + 5e-5});
  EXPECT_THAT(inspectSafeState(evidence).problems, ::testing::ElementsAre(::testing::HasSubstr("dark")));
}

TEST(SafeState, ACauseThatNeverCameIsInvalid) {
  auto evidence = good();
  evidence.demand.cause_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(inspectSafeState(evidence).verdict, Verdict::kInvalid);
}

TEST(SafeState, ARecordingThatEndsTooEarlyIsInvalid) {
  auto evidence = good();
  evidence.end_s = 1.04;
  EXPECT_EQ(inspectSafeState(evidence).verdict, Verdict::kInvalid);
}

TEST(SafeState, AnAxisThatGoesOnFails) {
  auto evidence = good();
  evidence.last_pulse_s = 1.0018;
  EXPECT_EQ(verdictOf(inspectSafeState(evidence), "safe_stop"), Verdict::kFail);
}

TEST(SafeState, TheReportMustComeBeRightAndStand) {
  auto wrong = good();
  wrong.reports.back().fault = "limit";
  EXPECT_EQ(verdictOf(inspectSafeState(wrong), "safe_report"), Verdict::kFail);
  auto none = good();
  none.reports.pop_back();
  EXPECT_EQ(verdictOf(inspectSafeState(none), "safe_report"), Verdict::kFail);
  auto before = good();
  before.reports.back().time_s = 0.9999;
  EXPECT_EQ(verdictOf(inspectSafeState(before), "safe_report"), Verdict::kFail);
  auto late = good();
  late.reports.back().time_s = 1.06;
  EXPECT_EQ(verdictOf(inspectSafeState(late), "safe_report"), Verdict::kFail);
  auto goes_on = good();
  goes_on.reports.push_back({1.2, false, "ok"});
  EXPECT_EQ(verdictOf(inspectSafeState(goes_on), "safe_report"), Verdict::kFail);
}

TEST(SafeState, AnEndWithoutProofOfAnythingIsNotAPass) {
  auto evidence = good();
  evidence.problems = {"pin events were lost"};
  EXPECT_EQ(inspectSafeState(evidence).verdict, Verdict::kInvalid);
}

TEST(Account, OneStepOffFails) {
  auto account = goodAccount();
  EXPECT_EQ(checks::accountCheck(account).verdict, Verdict::kPass);
  account.axes[1].told = -4;
  const Check check = checks::accountCheck(account);
  EXPECT_EQ(check.verdict, Verdict::kFail);
  EXPECT_EQ(check.subject, "galvo_y");
  EXPECT_EQ(check.value, 1.0);
}

TEST(Account, TheBeltMayDifferByWhatNobodyCanKnow) {
  auto account = goodAccount();
  for (const auto& [told, verdict] : {std::pair{509LL, Verdict::kPass},
                                      {510LL, Verdict::kFail},
                                      {486LL, Verdict::kPass},
                                      {485LL, Verdict::kFail}}) {
    account.belt->told = told;
    EXPECT_EQ(checks::accountCheck(account).verdict, verdict) << told;
  }
  account.belt.reset();
  EXPECT_EQ(checks::accountCheck(account).verdict, Verdict::kPass);
}

TEST(Account, SilenceIsInvalid) { EXPECT_EQ(checks::accountCheck({}).verdict, Verdict::kInvalid); }

}  // namespace
}  // namespace kerfbench::inspect
