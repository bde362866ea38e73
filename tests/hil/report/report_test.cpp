// SPDX-License-Identifier: Apache-2.0
#include "hil/report/run_report.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "hil/base/utf8.h"
#include "hil/dieline/geometry.h"
#include "hil/report/html_text.h"
#include "tests/hil/inspect/synthetic_run.h"
#include "tests/hil/report/page_checks.h"
#include "tests/hil/report/sample_report.h"

namespace kerfbench::report {
namespace {

using test::badRun;
using test::htmlOf;
using test::jsonOf;
using test::junitOf;
using test::reportOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(VerdictSentence, TellsWhyTheControllerStopped) {
  inspect::testing::SyntheticRun run;
  run.evidence.end = {inspect::ControllerEnd::Said::kStopped, 100.0, "dry", "its queue ran dry", true, 99.0};
  const RunReport report = reportOf(run);
  const std::string why = "At 100.000 s the controller stopped before the job was done: its queue ran dry.";
  EXPECT_THAT(verdictSentence(report), HasSubstr("This run is bad: proven by finish. " + why));
  EXPECT_THAT(stopSentence(report.result), HasSubstr(why));
  EXPECT_EQ(stopSentence(reportOf(inspect::testing::SyntheticRun()).result), "");
}

TEST(VerdictJson, HasTheKeysOfItsSchema) {
  const inspect::testing::SyntheticRun run;
  const auto json = nlohmann::json::parse(jsonOf(reportOf(run)));
  for (const char* key :
       {"schema_version", "verdict",        "exit_code", "summary", "digest",    "scenario",
        "machine",        "firmware",       "source",    "seed",    "virtual_s", "problems",
        "checks",         "entities",       "cuts",      "pulses",  "frames",    "mark_residual_mm",
        "versions",       "repeat_command", "model"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_EQ(json["schema_version"], 1);
  EXPECT_EQ(json["verdict"], "PASS");
  EXPECT_EQ(json["exit_code"], 0);
  for (const auto& check : json["checks"]) {
    for (const char* key : {"name", "title", "verdict", "value", "unit", "limit", "limit_is", "guard",
                            "expanded_uncertainty", "subject", "explanation"}) {
      EXPECT_TRUE(check.contains(key)) << key;
    }
  }
  EXPECT_EQ(json["entities"].size(), 14U);
  EXPECT_EQ(json["cuts"]["list"].size(), json["cuts"]["count"].get<std::size_t>());
}

TEST(SerialNumber, IsInEveryReportAndChangesNoDigest) {
  RunReport report = reportOf(inspect::testing::SyntheticRun());
  const std::string without = digestsOf(report).results;
  EXPECT_EQ(nlohmann::json::parse(jsonOf(report))["serial_number"], "");
  EXPECT_THAT(junitOf(report), Not(HasSubstr("serial_number")));
  report.serial_number = "K-7 <b>";
  EXPECT_EQ(digestsOf(report).results, without);
  EXPECT_EQ(nlohmann::json::parse(jsonOf(report))["serial_number"], "K-7 <b>");
  EXPECT_THAT(junitOf(report), HasSubstr("<property name=\"serial_number\" value=\"K-7 &lt;b"));
  const std::string page = htmlReport(report, digestsOf(report));
  EXPECT_THAT(page, HasSubstr("Serial number <b>K-7 &lt;b&gt;</b>"));
  EXPECT_THAT(page, Not(HasSubstr("K-7 <b>")));
}

TEST(VerdictJson, WritesNoNumberAsNull) {
  inspect::testing::SyntheticRun run;
  run.evidence.kerf_calibration.reset();
  const auto json = nlohmann::json::parse(jsonOf(reportOf(run)));
  EXPECT_TRUE(json["checks"][0]["value"].is_null());
  EXPECT_EQ(json["verdict"], "INVALID");
}

TEST(VerdictJson, SaysNothingOfWallTimeOrHost) {
  const inspect::testing::SyntheticRun run;
  RunReport a = reportOf(run);
  RunReport b = a;
  b.host = "bench-2";
  b.finished = "later";
  b.timing = {{"twin", 99.0}};
  EXPECT_EQ(jsonOf(a), jsonOf(b));
}

TEST(ModelFactsTest, LostStepsAreToldWithTimeAxisPlaceAndCountAndNotJudged) {
  const inspect::testing::SyntheticRun run;
  RunReport report = reportOf(run);
  EXPECT_EQ(lostStepsSentence(report.model), "");
  EXPECT_THAT(htmlOf(report), Not(HasSubstr("The machine lost steps")));
  report.model.lost_steps = {{"galvo_x", 1.25, 0.012345, "rad", 8}, {"galvo_y", 1.5, -0.01, "rad", -4}};
  const auto json = nlohmann::json::parse(jsonOf(report));
  EXPECT_EQ(json["verdict"], "PASS");
  EXPECT_EQ(json["exit_code"], 0);
  const auto& lost = json["model"]["lost_steps"];
  ASSERT_EQ(lost.size(), 2U);
  EXPECT_EQ(lost[0]["axis"], "galvo_x");
  EXPECT_EQ(lost[0]["time_s"], 1.25);
  EXPECT_EQ(lost[0]["place"], 0.012345);
  EXPECT_EQ(lost[1]["full_steps"], -4);
  const std::string html = htmlOf(report);
  const auto sentence =
      html.find("The machine lost steps: galvo_x 8 full steps at 1.250 s (the first of 2 times).");
  ASSERT_NE(sentence, std::string::npos);
  EXPECT_LT(sentence, html.find("<h2>Checks"));  // The sentence stands where everybody sees it.
  EXPECT_THAT(html,
              HasSubstr("<td>galvo_y<td class=num>1.50000<td class=num>-0.01<td>rad<td class='num hit'>-4"));
}

TEST(ModelFactsTest, WhatWasDrawnStandsWithItsUnitAndAllItsDigits) {
  RunReport report = reportOf(inspect::testing::SyntheticRun());
  const auto json = nlohmann::json::parse(jsonOf(report));
  EXPECT_EQ(json["model"]["imperfections"], "static");
  EXPECT_EQ(json["model"]["twin"], "reference");
  EXPECT_EQ(json["model"]["sampled"][0]["name"], "galvo_x.zero");
  EXPECT_EQ(json["model"]["sampled"][0]["value"], 4.5e-6);
  EXPECT_EQ(json["model"]["sampled"][0]["unit"], "rad");
  const std::string html = htmlOf(report);
  EXPECT_THAT(html, HasSubstr("Imperfections <b>static</b>, seed 42, model <b>reference</b>"));
  EXPECT_THAT(html, HasSubstr("<td>galvo_x.zero<td class=num>4.5e-06<td>rad"));
  EXPECT_THAT(html, HasSubstr("&lt;relative&gt;"));
}

TEST(JunitXml, IsWellFormedWhateverWordsItHas) {
  inspect::testing::SyntheticRun run = badRun();
  RunReport report = reportOf(run);
  const std::string hostile = "\x1b[31m\x01 \xff\xc0 ]]> <kb onkb='1'> &amp \xef\xbf\xbe";
  report.scenario += hostile;
  report.firmware = report.machine = report.repeat_command = hostile;
  report.result.problems = {hostile};
  for (inspect::Check& check : report.result.checks) check.explanation = hostile;
  for (inspect::Unjudged& unjudged : report.result.unjudged) unjudged.reason = hostile;
  const std::string text = junitOf(report);
  EXPECT_EQ(base::markupText(text), text);
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(text.c_str()));
  EXPECT_TRUE(document.select_nodes("//kb").empty());
  EXPECT_TRUE(document.select_nodes("//@onkb").empty());
  EXPECT_FALSE(digestsOf(report).results.empty());  // Bytes that are not UTF-8 break nothing there either.
}

TEST(JunitXml, CountsWhatItLists) {
  inspect::testing::SyntheticRun run = badRun();
  RunReport report = reportOf(run);
  report.result.checks[0].verdict = inspect::Verdict::kNotProven;
  report.result.checks[1].verdict = inspect::Verdict::kInvalid;
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(junitOf(report).c_str()));
  const auto suite = document.select_node("/testsuites/testsuite").node();
  EXPECT_EQ(suite.select_nodes("testcase").size(),
            report.result.checks.size() + report.result.unjudged.size() + 1);
  EXPECT_EQ(suite.attribute("skipped").as_uint(), report.result.unjudged.size());
  EXPECT_EQ(suite.select_nodes("testcase/skipped").size(), report.result.unjudged.size());
  EXPECT_EQ(suite.attribute("tests").as_uint(), suite.select_nodes("testcase").size());
  EXPECT_EQ(suite.attribute("failures").as_uint(), suite.select_nodes("testcase/failure").size());
  EXPECT_EQ(suite.attribute("errors").as_uint(), suite.select_nodes("testcase/error").size());
  const auto& checks = report.result.checks;
  const auto counted = [&](inspect::Verdict verdict) {
    return static_cast<std::size_t>(std::count_if(
        checks.begin(), checks.end(), [&](const inspect::Check& c) { return c.verdict == verdict; }));
  };
  EXPECT_GE(counted(inspect::Verdict::kNotProven), 1U);
  EXPECT_EQ(suite.select_nodes("testcase/failure[@type='NotProven']").size(),
            counted(inspect::Verdict::kNotProven));
  EXPECT_EQ(suite.select_nodes("testcase/error[@type='Invalid']").size(),
            counted(inspect::Verdict::kInvalid));
  EXPECT_EQ(suite.select_nodes("testcase[@name='pulse_timing']/failure[@type='Failure']").size(), 1U);
}

/// Kinds of the reservations of a report.
std::vector<std::string> kindsOf(const RunReport& report) {
  std::vector<std::string> kinds;
  for (const Reservation& reservation : reservationsOf(report)) kinds.push_back(reservation.kind);
  return kinds;
}

TEST(Reservations, AreNoneOfARunThatIsJudgedInFull) {
  inspect::testing::SyntheticRun run;
  run.dieline.entities.back().process = dieline::Process::kCut;
  RunReport report = reportOf(run);
  report.result.unjudged.clear();
  EXPECT_THAT(kindsOf(report), ::testing::IsEmpty());
}

TEST(Reservations, NameCornersThatCannotBeRead) {
  const inspect::testing::SyntheticRun run;
  RunReport report = reportOf(run);
  inspect::JointResult corner;
  corner.short_leg = true;
  report.result.joints = {corner, corner};
  EXPECT_THAT(reservationsLine(report), HasSubstr("2 corners have a leg too short to be read"));
}

TEST(Reservations, StandInTheSentenceOfAPassAndInEachFile) {
  inspect::testing::SyntheticRun run;
  run.evidence.words_expected = true;
  run.evidence.no_words = "The recording holds nothing that the controller said.";
  RunReport report = reportOf(run);
  ASSERT_EQ(report.result.verdict, inspect::Verdict::kPass);
  report.limits.path_mm = 10.0;
  report.model_pictures = true;
  report.calibrations_undated = true;
  report.unsealed = true;
  EXPECT_THAT(kindsOf(report),
              ::testing::ElementsAre("wide_limit", "not_judged", "part_not_judged", "model_pictures",
                                     "unsealed_recording", "calibration_undated"));
  const std::string sentence = verdictSentence(report);
  EXPECT_THAT(sentence, Not(HasSubstr("This run is good")));
  EXPECT_THAT(sentence, HasSubstr("path_mm 10 (default 0.05)"));
  EXPECT_THAT(sentence, HasSubstr("not judged: account, finish"));
  EXPECT_THAT(sentence, HasSubstr("1 of 8 entities of the drawing"));
  report.limits.ordered_width.limit_mm = 0.1;
  report.calibration_max_age_days = 365;
  EXPECT_THAT(verdictSentence(report), HasSubstr("ordered_width.limit_mm 0.1 (default 0.03)"));
  EXPECT_THAT(verdictSentence(report), HasSubstr("calibrations may be 365 days old (default 180)"));
  EXPECT_THAT(kindsOf(report), ::testing::IsSupersetOf({"calibration_age", "calibration_undated"}));
  report.calibration_max_age_days = 30;
  EXPECT_THAT(htmlOf(report), HasSubstr("path_mm 10 (default 0.05)"));
  EXPECT_THAT(junitOf(report), HasSubstr("path_mm 10 (default 0.05)"));
  const auto json = nlohmann::json::parse(jsonOf(report));
  EXPECT_EQ(json.at("reservations").size(), 6U);
  EXPECT_EQ(json.at("reservations").at(0).at("kind"), "wide_limit");
}

TEST(JunitXml, BrokenEvidenceIsAnErrorEvenIfEveryCheckPasses) {
  inspect::testing::SyntheticRun run;
  run.evidence.problems.emplace_back("Gap in the pin stream at 1.2 s.");
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(junitOf(reportOf(run)).c_str()));
  EXPECT_EQ(document.select_nodes("//testcase[@name='evidence']/error").size(), 1U);
  EXPECT_EQ(document.select_node("//testsuite").node().attribute("errors").as_int(), 1);
}

TEST(HtmlReport, NeedsNothingElse) {
  const std::string html = htmlOf(reportOf(badRun()));
  // Pictures are inside; the only links are to the files next to it.
  EXPECT_EQ(test::outsideReferences(html, "sheet-unit0.png"), "");
  EXPECT_EQ(test::numberFaults(html), "");
  EXPECT_EQ(test::unclosedElements(html), "");
}

TEST(HtmlReport, EscapesWhatOthersWrote) {
  RunReport report = reportOf(inspect::testing::SyntheticRun());
  report.scenario = "<b>&\"x'";
  const std::string html = htmlOf(report);
  EXPECT_THAT(html, Not(HasSubstr("<b>&\"x'")));
  EXPECT_THAT(html, HasSubstr("&lt;b&gt;&amp;&quot;x&#39;"));
  EXPECT_THAT(html, HasSubstr("controller-avr.hex &lt;atmega2560&gt;"));
}

TEST(HtmlReport, StaysSmallForALargeCarton) {
  RunReport report = reportOf(badRun());
  const std::vector<vision::EntityKerf> entities = report.kerf.entities;
  for (int k = 0; k < 20; ++k) {
    for (vision::EntityKerf kerf : entities) {
      kerf.unit += 2 * (k % 2);
      report.kerf.entities.push_back(std::move(kerf));
    }
  }
  std::size_t calipers = 0;
  for (const auto& kerf : report.kerf.entities) calipers += kerf.calipers.size();
  ASSERT_GT(calipers, 16000U);
  EXPECT_LT(htmlOf(report).size(), 5U << 20U);
}

TEST(HtmlReport, TellsEvenOfARunWithoutAnyMeasurement) {
  RunReport report;
  report.result.problems.emplace_back("The firmware crashed at 0.3 s.");
  EXPECT_THAT(htmlOf(report), HasSubstr("The firmware crashed at 0.3 s."));
  EXPECT_THAT(jsonOf(report), HasSubstr("\"INVALID\""));
}

TEST(WriteReports, WritesAllThree) {
  // The page is kept in the build folder for inspection.
  const auto folder = std::filesystem::path(KERFBENCH_BINARY_DIR) / "report-example";
  std::filesystem::create_directories(folder);
  const RunReport report = reportOf(badRun());
  writeReports(report, digestsOf(report), folder, 2);
  std::ostringstream text;
  text << std::ifstream(folder / "report.html").rdbuf();
  EXPECT_EQ(text.str(), htmlOf(report));
  EXPECT_TRUE(std::filesystem::exists(folder / "junit.xml"));
  EXPECT_TRUE(std::filesystem::exists(folder / "verdict.json"));
}

TEST(Base64, AgreesWithRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace kerfbench::report
