// SPDX-License-Identifier: Apache-2.0
// A controller that stops before the job is done.
#include "hil/inspect/verdict/controller_end.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/hil/inspect/not_numbers.h"
#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::inspect {
namespace {

using namespace testing;
using Said = ControllerEnd::Said;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// The stop is later than all events of a SyntheticRun.
ControllerEnd stopped() { return {Said::kStopped, 100.0, "belt-fast", "the belt is too fast", true, 99.9}; }

Verdict finishOf(const ControllerEnd& end) { return checks::finishCheck(end, {{98.0, 99.8}}).verdict; }

TEST(Finish, AStopOfItsOwnFailsAWholeRunAndTellsWhy) {
  SyntheticRun run;
  run.evidence.end = stopped();
  const auto result = run.inspected();
  EXPECT_EQ(result.verdict, Verdict::kFail);
  const Check& check = checkOf(result, "finish");
  EXPECT_EQ(check.verdict, Verdict::kFail);
  EXPECT_EQ(check.value, 1.0) << "one stop";
  EXPECT_EQ(check.subject, "belt-fast");
  EXPECT_THAT(check.explanation, HasSubstr("stopped before the job was done: the belt is too fast"));
}

TEST(Finish, TellsWhenTheLaserWasLastOn) {
  EXPECT_THAT(checks::finishCheck(stopped(), {{0.2, 0.5}}).explanation,
              HasSubstr("Its laser was last on at 0.500 s"));
}

TEST(Finish, DoneIsAPass) {
  SyntheticRun run;
  run.evidence.end = stopped();
  run.evidence.end->said = Said::kDone;
  EXPECT_EQ(run.inspected().verdict, Verdict::kPass);
  EXPECT_EQ(checkOf(run.inspected(), "finish").value, 0.0);
}

TEST(Finish, SilenceIsInvalid) {
  ControllerEnd end;
  EXPECT_EQ(finishOf(end), Verdict::kInvalid);
}

TEST(Finish, WhatIsNoMatterOfTheReleaseIsInvalid) {
  ControllerEnd end = stopped();
  end.of_release = false;
  EXPECT_EQ(finishOf(end), Verdict::kInvalid);
}

TEST(Finish, PinsThatGoOnContradictTheWords) {
  for (const Said said : {Said::kStopped, Said::kDone}) {
    ControllerEnd end = stopped();
    end.said = said;
    EXPECT_NE(finishOf(end), Verdict::kInvalid);
    end.last_pulse_s = 100.1;
    EXPECT_EQ(finishOf(end), Verdict::kInvalid);
    end = stopped();
    end.said = said;
    const std::vector<GateInterval> lit_later{{98.0, 99.0}, {100.2, 100.3}};
    const Check check = checks::finishCheck(end, lit_later);
    EXPECT_EQ(check.verdict, Verdict::kInvalid);
    EXPECT_THAT(check.explanation, HasSubstr("its pins went on until 100.300 s"));
    EXPECT_FALSE(stoppedByItself(end, lit_later));
  }
}

TEST(Finish, NoNumberProvesNothing) {
  for (double ControllerEnd::*field : {&ControllerEnd::time_s, &ControllerEnd::last_pulse_s}) {
    SyntheticRun run;
    run.evidence.end = stopped();
    (*run.evidence.end).*field = kNan;
    EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
    run.evidence.gates.clear();
    EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
  }
}

TEST(Finish, AStopBeforeTheFirstCutNeedsNoCamera) {
  SyntheticRun run;
  run.evidence.gates.clear();
  run.evidence.spot = {};
  run.evidence.kerf = {};
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
  run.evidence.end = stopped();
  const auto result = run.inspected();
  EXPECT_EQ(result.verdict, Verdict::kFail);
  EXPECT_TRUE(hasCheck(result, "pulse_timing"));
  EXPECT_THAT(checkOf(result, "finish").explanation, HasSubstr("laser was never on"));
  run.evidence.problems = {"pin events were lost"};
  EXPECT_EQ(run.inspected().verdict, Verdict::kInvalid);
}

}  // namespace
}  // namespace kerfbench::inspect
