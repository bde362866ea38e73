// SPDX-License-Identifier: Apache-2.0
// The report answers first: what failed, with what it brings along, and what to do where nothing is proven.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "hil/report/causes.h"
#include "hil/report/diagnosis_section.h"
#include "hil/report/headline.h"
#include "hil/report/html_answer.h"
#include "hil/report/html_text.h"
#include "tests/hil/inspect/synthetic_run.h"
#include "tests/hil/report/page_checks.h"
#include "tests/hil/report/sample_report.h"

namespace kerfbench::report {
namespace {

using inspect::Check;
using inspect::Verdict;
using test::badRun;
using test::htmlOf;
using test::jsonOf;
using test::junitOf;
using test::reportOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

Check checkNamed(const std::string& name, Verdict verdict = Verdict::kFail) {
  Check check{.name = name, .title = name, .unit = "mm", .value = 1.0, .limit = 0.5};
  check.verdict = verdict;
  return check;
}

std::vector<std::string> namesOf(const std::vector<const Check*>& checks) {
  std::vector<std::string> names;
  for (const Check* check : checks) names.push_back(check->name);
  return names;
}

TEST(CheckFactsTest, KnowEachCheckOfTheSchemaAndNoOther) {
  std::ifstream file(std::filesystem::path(KERFBENCH_SOURCE_DIR) / "docs/reference/verdict.schema.json");
  const auto schema = nlohmann::json::parse(file);
  const auto& listed =
      schema.at("properties").at("checks").at("items").at("properties").at("name").at("enum");
  std::set<std::string> known;
  for (const CheckFacts& facts : checkFacts()) {
    EXPECT_TRUE(known.emplace(facts.name).second) << facts.name << " twice";
    EXPECT_FALSE(facts.failing.empty()) << facts.name;
    EXPECT_FALSE(facts.failing.ends_with('.')) << facts.name;
  }
  EXPECT_EQ(known, std::set<std::string>(listed.begin(), listed.end()));
}

TEST(CheckFactsTest, LeadComeBeforeThoseThatFollow) {
  std::set<std::string_view> before;
  for (const CheckFacts& facts : checkFacts()) {
    for (const std::string_view leader : facts.follows)
      EXPECT_TRUE(before.contains(leader)) << facts.name << " follows " << leader;
    before.insert(facts.name);
  }
}

TEST(FailureGroups, PutConsequencesUnderTheirCauseAndTheGreatestCauseFirst) {
  const std::vector<Check> checks{
      checkNamed("path", Verdict::kPass), checkNamed("joints"),    checkNamed("coverage"),
      checkNamed("laser_timing"),         checkNamed("interlock"), checkNamed("gate_lag")};
  const auto groups = failureGroups(checks, Verdict::kFail);
  ASSERT_EQ(groups.size(), 2U);
  EXPECT_EQ(groups[0].primary->name, "gate_lag");
  EXPECT_THAT(namesOf(groups[0].followers), ElementsAre("laser_timing", "joints", "coverage"));
  EXPECT_EQ(groups[1].primary->name, "interlock");
  EXPECT_THAT(groups[1].followers, IsEmpty());
}

TEST(FailureGroups, FollowTheCauseOfTheirCause) {
  // The cut lies off since the spot does, and the spot does since pulses are too short for the drives.
  const std::vector<Check> checks{checkNamed("path"), checkNamed("spot_path"), checkNamed("pulse_timing"),
                                  checkNamed("stray")};
  const auto groups = failureGroups(checks, Verdict::kFail);
  ASSERT_EQ(groups.size(), 1U);
  EXPECT_EQ(groups[0].primary->name, "pulse_timing");
  EXPECT_THAT(namesOf(groups[0].followers), ElementsAre("spot_path", "path", "stray"));
}

// One line of a program that is off explains a little as a scale, too: that must not lead.
TEST(Headline, DoesNotLeadWithACauseThatExplainsLittle) {
  RunReport report = reportOf(badRun());
  report.diagnosis.arises = report.diagnosis.sentence = "No known cause explains most of it.";
  report.diagnosis.causes = {
      {.key = "program_scale_x", .share = 0.26, .sentence = "The program is too small."}};
  EXPECT_EQ(headlineOf(report).cause, "No known cause explains most of it.");
  EXPECT_THAT(diagnosisLines(report),
              ElementsAre("No known cause explains most of it.", "A part of it: The program is too small."));
  EXPECT_THAT(diagnosisSection(report), HasSubstr("<p>No known cause explains most of it.</p>"));
  report.diagnosis.causes.front().share = 0.6;
  EXPECT_EQ(headlineOf(report).cause, "The program is too small.");
  EXPECT_THAT(diagnosisLines(report), ElementsAre("Likely cause: The program is too small."));
  EXPECT_THAT(diagnosisSection(report), Not(HasSubstr("<p>")));
}

TEST(FailureGroups, TakeAlongWhatIsNotProvenBecauseOfAFailure) {
  const std::vector<Check> checks{checkNamed("spot_path"), checkNamed("laser_timing", Verdict::kNotProven),
                                  checkNamed("finish", Verdict::kInvalid)};
  const auto failed = failureGroups(checks, Verdict::kFail);
  ASSERT_EQ(failed.size(), 1U);
  EXPECT_THAT(namesOf(failed[0].followers), ElementsAre("laser_timing"));
  EXPECT_THAT(failureGroups(checks, Verdict::kNotProven), IsEmpty()) << "told once";
  ASSERT_EQ(failureGroups(checks, Verdict::kInvalid).size(), 1U) << "nothing brings that along";
}

TEST(FailureGroups, OfACauseThatPassedIsNone) {
  const std::vector<Check> checks{checkNamed("gate_lag", Verdict::kPass), checkNamed("laser_timing")};
  const auto groups = failureGroups(checks, Verdict::kFail);
  ASSERT_EQ(groups.size(), 1U);
  EXPECT_EQ(groups[0].primary->name, "laser_timing");
}

TEST(FailureGroups, KeepACheckThatNobodyKnows) {
  const std::vector<Check> checks{checkNamed("novel")};
  const auto groups = failureGroups(checks, Verdict::kFail);
  ASSERT_EQ(groups.size(), 1U);
  EXPECT_EQ(failingPhrase(groups[0].primary->name), "novel");
}

TEST(HeadlineTest, SaysWhatHowMuchWhereAndWhen) {
  const RunReport report = reportOf(badRun());
  const Headline headline = headlineOf(report);
  const Check& check = inspect::testing::checkOf(report.result, headline.check);
  EXPECT_EQ(check.verdict, Verdict::kFail);
  EXPECT_EQ(headline.what, failingPhrase(check.name));
  EXPECT_THAT(headline.how_much, HasSubstr(checkNumber(check, check.value)));
  EXPECT_THAT(headline.how_much, HasSubstr(checkNumber(check, check.limit)));
  const auto json = nlohmann::json::parse(jsonOf(report));
  EXPECT_EQ(json.at("headline").at("what"), headline.what);
  EXPECT_THAT(htmlOf(report), HasSubstr("<h1>" + escapeHtml(headline.what)));
}

TEST(HeadlineTest, SaysThatAValueIsABoundInEachFile) {
  RunReport report = reportOf(badRun());
  for (Check& check : report.result.checks) {
    if (check.name != "path") continue;
    check.value = 1.0;
    check.u = check.guard = 0.0;
    check.at_least = true;
    EXPECT_EQ(howMuchOf(check), "at least 1.0000 mm, where 0.0500 mm is allowed");
  }
  const auto json = nlohmann::json::parse(jsonOf(report));
  std::size_t bounds = 0;
  for (const auto& check : json.at("checks")) bounds += check.at("value_is") == "at_least" ? 1 : 0;
  EXPECT_EQ(bounds, 1U);
  EXPECT_THAT(junitOf(report), HasSubstr("FAIL: at least 1.0000 mm"));
  EXPECT_THAT(htmlOf(report), HasSubstr("at least 1.0000 mm"));
}

TEST(HeadlineTest, OfAPassNamesNoCheck) {
  const Headline headline = headlineOf(reportOf(inspect::testing::SyntheticRun()));
  EXPECT_EQ(headline.check, "");
  EXPECT_EQ(headline.what, "");
}

TEST(HeadlineTest, OfAPassSaysHowMuchRoomIsLeftAndWhatWasNotJudged) {
  RunReport report = reportOf(inspect::testing::SyntheticRun());
  report.result.verdict = Verdict::kPass;
  report.result.checks = {checkNamed("path", Verdict::kPass), checkNamed("joints", Verdict::kPass),
                          checkNamed("repeat", Verdict::kPass), checkNamed("stray", Verdict::kPass)};
  const std::vector<double> values{0.01, 0.04, 0.02, 0.03};
  for (std::size_t i = 0; i < values.size(); ++i) {
    report.result.checks[i].value = values[i];
    report.result.checks[i].limit = 0.05;
  }
  report.result.unjudged = {{"gate_lag", "", true, "Too few frames."},
                            {"perforation", "", false, "None is drawn."}};
  const std::string list = headlineList(report);
  const auto at = [&](const char* name) { return list.find(name); };
  EXPECT_LT(at("joints"), at("stray"));
  EXPECT_LT(at("stray"), at("repeat"));
  EXPECT_EQ(at("path"), std::string::npos) << "three are named";
  EXPECT_THAT(list, HasSubstr("<dt>Not judged<dd>gate_lag</dl>")) << "what is not drawn is not missing";
}

TEST(WhenTest, TellsWhatTheTimeIsThatOf) {
  inspect::Whereabouts where;
  EXPECT_EQ(whenOf(where), "");
  where.time_s = 1.25;
  where.time = inspect::Whereabouts::Time::kPins;
  EXPECT_EQ(whenOf(where), "1.250000 s, by the pins");
  where.time = inspect::Whereabouts::Time::kPassing;
  where.within_s = 5e-4;
  EXPECT_EQ(whenOf(where), "1.2500 s ± 0.5 ms, when the beam passed that place");
}

TEST(HtmlAnswer, HasTheFailingChecksBeforeAllElseAndThePassesFolded) {
  const RunReport report = reportOf(badRun());
  const std::string html = htmlOf(report);
  const auto failures = html.find("<h2>What did not pass");
  const auto checks = html.find("<h2>Checks");
  ASSERT_NE(failures, std::string::npos);
  ASSERT_NE(checks, std::string::npos);
  EXPECT_LT(failures, checks);
  const auto fold = html.find("<input type=checkbox class=fold id='fold-passes'>", checks);
  ASSERT_NE(fold, std::string::npos);
  const auto fold_end = html.find("<section", fold);
  for (const Check& check : report.result.checks) {
    const std::string row = "<small>" + check.name + "</small><span class=why>";
    const auto at = html.find(row, checks);
    ASSERT_NE(at, std::string::npos) << check.name;
    EXPECT_EQ(check.verdict == Verdict::kPass, at > fold && at < fold_end) << check.name;
    EXPECT_EQ(check.verdict != Verdict::kPass, test::hasAnchor(html, "check-" + check.name)) << check.name;
  }
  // The fold is a matter of the screen alone: paper shows all.
  const auto rule = html.find(".folded:not(:has(:target)){display:none}");
  ASSERT_NE(rule, std::string::npos);
  EXPECT_EQ(html.rfind("@media", rule), html.rfind("@media screen{", rule));
}

TEST(HtmlAnswer, LeadsFromTheContentsToEachSection) {
  const std::string html = htmlOf(reportOf(badRun()));
  std::size_t sections = 0;
  for (std::size_t at = html.find("<section id='"); at != std::string::npos;
       at = html.find("<section id='", at + 1)) {
    const std::size_t from = at + 13;
    const std::string id = html.substr(from, html.find('\'', from) - from);
    EXPECT_THAT(html, HasSubstr("<li><a href='#" + id + "'>")) << id;
    ++sections;
  }
  EXPECT_GE(sections, 9U);
}

TEST(HtmlAnswer, ShowsThePictureOfTheFailingPlaceAndThePlaceOnTheDrawing) {
  const RunReport report = reportOf(badRun());
  const Check& path = inspect::testing::checkOf(report.result, "path");
  ASSERT_TRUE(path.where.hasPlace());
  EXPECT_EQ(path.where.unit, 1);
  EXPECT_EQ(path.where.entity, inspect::testing::kRight);
  // The picture at (60, 20) shows it; that of unit 0 does not.
  EXPECT_EQ(placeNear(report, path.where), 0U);
  inspect::Whereabouts far = path.where;
  far.y_mm += 5.0;
  EXPECT_EQ(placeNear(report, far), std::nullopt);
  EXPECT_THAT(htmlOf(report), HasSubstr("<circle class=spot cx=60.00"));
}

TEST(NextSteps, AreNoneOfAVerdictThatProves) {
  EXPECT_THAT(nextSteps(reportOf(badRun())), IsEmpty());
  EXPECT_THAT(nextSteps(reportOf(inspect::testing::SyntheticRun())), IsEmpty());
}

/// Steps after one problem of the evidence.
std::string stepAfter(const std::string& problem) {
  RunReport report;
  report.result.problems = {problem};
  const auto steps = nextSteps(report);
  return steps.size() == 1 ? steps.front() : "";
}

TEST(NextSteps, FitTheProblem) {
  EXPECT_THAT(stepAfter("the time limit of 2 s was reached before the head was at rest"),
              HasSubstr("time_limit_s"));
  EXPECT_THAT(stepAfter("the laser gate was never opened: nothing was cut"), HasSubstr("laser.gate_low"));
  EXPECT_THAT(stepAfter("There is no calibration of the spot camera."), HasSubstr("Calibrate"));
  EXPECT_THAT(
      stepAfter("In 3 frames the spot lies outside the area that the spot camera's calibration covers."),
      HasSubstr("over the whole area"));
  EXPECT_THAT(stepAfter("The spot camera lost 4 frames around cuts, the first is number 7."),
              HasSubstr("keeps pace"));
  EXPECT_THAT(stepAfter("The web moves at 60 mm/s, and the recording holds no edge of its encoder."),
              HasSubstr("belt's encoder"));
  EXPECT_THAT(stepAfter("Something that nobody has foreseen."),
              HasSubstr("INVALID says nothing of the release"));
}

TEST(NextSteps, StandOnThePageBeforeTheProblems) {
  inspect::testing::SyntheticRun run;
  run.evidence.kerf_calibration.reset();
  const RunReport report = reportOf(run);
  ASSERT_EQ(report.result.verdict, Verdict::kInvalid);
  const std::string html = htmlOf(report);
  const auto steps = html.find("<h2>What to do next");
  ASSERT_NE(steps, std::string::npos);
  EXPECT_LT(steps, html.find("<h2>Problems of the evidence"));
  EXPECT_FALSE(nlohmann::json::parse(jsonOf(report)).at("next_steps").empty());
}

TEST(NextSteps, SayHowFineAMeasurementWouldHaveToBe) {
  RunReport report;
  report.result.verdict = Verdict::kNotProven;
  Check within = checkNamed("path", Verdict::kNotProven);
  within.value = 0.046;
  within.limit = 0.05;
  within.u = within.guard = 0.006;
  Check beyond = within;
  beyond.name = "joints";
  beyond.value = 0.053;
  report.result.checks = {within, beyond};
  const auto steps = nextSteps(report);
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_THAT(steps[0], HasSubstr("U below 0.0040 mm would prove it good"));
  EXPECT_THAT(steps[1], HasSubstr("better by 0.0090 mm would be proven good"));
  EXPECT_THAT(steps[1], HasSubstr("U below 0.0030 mm would prove this one bad"));
}

TEST(RecordToSign, BindsReleaseCalibrationsMachineAndLimits) {
  RunReport report = reportOf(inspect::testing::SyntheticRun());
  report.versions.emplace_back("firmware sha256", "0123abcd");
  report.versions.emplace_back("kerf camera", "calibration kc-1 of 2024-05-01");
  report.inputs = {{"machine.yaml", "fedc"}};
  const std::string html = htmlOf(report);
  const std::string record = html.substr(html.find("<section id='record-to-sign'>"));
  for (const char* bound : {"0123abcd", "kc-1", "machine.yaml", "fedc", "two-mirror-160",
                            "<th scope=row>path_mm<td>0.05 mm", "Operator, name", "Signature"})
    EXPECT_THAT(record, HasSubstr(bound));
  EXPECT_THAT(record, HasSubstr(digestOf(report)));
  EXPECT_THAT(html, HasSubstr(".record{break-before:page}"));
}

}  // namespace
}  // namespace kerfbench::report
