// SPDX-License-Identifier: Apache-2.0
#include "hil/suite/suite_report.h"

#include <cmath>
#include <cstdio>
#include <string>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/hil/base/temp_folder.h"

namespace kerfbench::suite {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kHostile = "<script>alert('&')</script>\x01\xff \"]]>";

/// Four runs: as expected, not, broken, not run; whatever is free text is hostile.
SuiteResult hostileResult() {
  SuiteResult result;
  result.name = "release";
  result.title = kHostile;
  result.image = kHostile;
  result.part = kHostile;
  for (const Outcome outcome :
       {Outcome::kAsExpected, Outcome::kNotAsExpected, Outcome::kBroken, Outcome::kNotRun}) {
    SuiteRow row;
    row.run.name = "run-" + std::to_string(result.rows.size());
    row.run.title = kHostile;
    row.run.tags = {kHostile};
    row.run.scenario_as_written = kHostile;
    row.run.choices.limits = {{kHostile, kHostile}};
    row.outcome = outcome;
    if (outcome != Outcome::kAsExpected) row.why = kHostile;
    if (outcome == Outcome::kAsExpected || outcome == Outcome::kNotAsExpected) {
      row.verdict.emplace();
      row.verdict->verdict = outcome == Outcome::kAsExpected ? "PASS" : "FAIL";
      row.verdict->summary = row.verdict->firmware = kHostile;
      row.verdict->problems = row.verdict->reservations = {kHostile};
      row.verdict->virtual_s = 1.25;
      inspect::Check check;
      check.name = "path";
      check.unit = "mm";
      check.value = 0.03;
      check.u = 0.004;
      check.limit = 0.05;
      check.subject = kHostile;
      check.verdict = inspect::Verdict::kPass;
      row.verdict->checks = {check};
    }
    result.rows.push_back(row);
  }
  return result;
}

/// What Python's parser (expat), which takes nothing that XML 1.0 does not allow, reads of a file.
std::string readByExpat(const std::string& xml) {
  const base::TempFolder temp;
  const auto file = temp.write("junit.xml", xml);
  const auto script = temp.write("read.py", R"(import sys, xml.etree.ElementTree as tree
suite = tree.parse(sys.argv[1]).getroot().find('testsuite')
print(*(suite.get(key) for key in ('name', 'tests', 'failures', 'errors', 'skipped', 'time')))
for case in suite.iter('testcase'):
    marks = [child.tag for child in case if child.tag != 'system-out']
    print(case.get('name'), *marks, 'alert' in case.find('system-out').text, '0.0300 mm' in case.find('system-out').text)
)");
  const std::string command = "python3 -B '" + script.string() + "' '" + file.string() + "' 2>&1";
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return "popen failed";
  std::string output;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) output += static_cast<char>(c);
  EXPECT_EQ(::pclose(pipe), 0) << output;
  return output;
}

TEST(SuiteReport, JUnitIsXmlWhateverTheNamesAre) {
  EXPECT_EQ(readByExpat(junitXml(hostileResult(), "results")),
            "release 4 1 1 1 2.500000\n"
            "run-0 True True\n"
            "run-1 failure True True\n"
            "run-2 error True False\n"
            "run-3 skipped True False\n");
}

TEST(SuiteReport, JUnitHasLinksThatACiFinds) {
  EXPECT_THAT(junitXml(hostileResult(), "results/release/1"),
              HasSubstr("[[ATTACHMENT|results/release/1/runs/run-0/results/report.html]]"));
  EXPECT_THAT(junitXml(hostileResult(), "/elsewhere"), Not(HasSubstr("ATTACHMENT")));
}

TEST(SuiteReport, APageShowsHostileNamesAsText) {
  const std::string page = indexPage(hostileResult());
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, HasSubstr("&lt;script&gt;alert("));
  EXPECT_THAT(page, HasSubstr("<a href='runs/run-0/results/report.html'>run-0</a>"));
  EXPECT_THAT(page, HasSubstr("<a href='runs/run-2/log.txt'>log</a>"));
  EXPECT_THAT(page, HasSubstr("</html>"));
}

TEST(SuiteReport, ATerminalGetsNoControlCharacters) {
  for (const std::string& line : tableLines(hostileResult()))
    EXPECT_THAT(line, Not(HasSubstr("\x01"))) << line;
}

TEST(SuiteReport, ASummaryIsJsonWhateverTheNamesAre) {
  const auto json = nlohmann::json::parse(summaryJson(hostileResult()));
  EXPECT_EQ(json.at("counts").at("not as expected"), 1);
  EXPECT_EQ(json.at("runs").size(), 4U);
  EXPECT_EQ(json.at("runs")[3].at("result"), nullptr);
}

TEST(SuiteReport, FiguresSayOnWhichSideTheirLimitIs) {
  inspect::Check check;
  check.unit = "us";
  check.value = 4.5;
  check.limit = 2.5;
  check.upper = false;
  EXPECT_EQ(figuresOf(check), "4.50 µs (limit ≥ 2.50 µs)");
  check.upper = true;
  check.u = 0.25;
  EXPECT_EQ(figuresOf(check), "4.50 µs ± 0.25 µs (limit 2.50 µs)");
}

TEST(SuiteReport, TheNearestCheckIsThatWithTheLargestShareOfItsLimit) {
  RunVerdict verdict;
  for (const auto& [name, value, limit, upper] : {std::tuple{"small", 0.4, 0.5, true},
                                                  {"large", 9.0, 100.0, true},
                                                  {"counted", 3.0, 0.0, true},
                                                  {"least", 5.0, 1.0, false},
                                                  {"unknown", std::nan(""), 1.0, true}}) {
    inspect::Check check;
    check.name = name;
    check.value = value;
    check.limit = limit;
    check.upper = upper;
    verdict.checks.push_back(check);
  }
  ASSERT_NE(nearestToLimit(verdict), nullptr);
  EXPECT_EQ(nearestToLimit(verdict)->name, "small");
  EXPECT_EQ(nearestToLimit({}), nullptr);
}

TEST(SuiteReport, TheSummarysDigestCoversTheRuns) {
  SuiteResult result = hostileResult();
  const auto digest = [&] { return nlohmann::json::parse(summaryJson(result)).at("digest"); };
  const auto before = digest();
  result.rows[0].wall_s = 77.0;
  EXPECT_EQ(digest(), before);
  result.rows[0].verdict->checks[0].value = 0.031;
  EXPECT_NE(digest(), before);
}

}  // namespace
}  // namespace kerfbench::suite
