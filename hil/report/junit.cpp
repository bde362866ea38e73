// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <sstream>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "hil/base/utf8.h"
#include "hil/report/headline.h"
#include "hil/report/html_text.h"
#include "hil/report/run_report.h"

namespace kerfbench::report {
namespace {

void addOutcome(pugi::xml_node test_case, inspect::Verdict verdict, const std::string& message,
                const std::string& text) {
  if (verdict == inspect::Verdict::kPass) return;
  pugi::xml_node node = test_case.append_child(verdict == inspect::Verdict::kInvalid ? "error" : "failure");
  node.append_attribute("type") = verdict == inspect::Verdict::kInvalid     ? "Invalid"
                                  : verdict == inspect::Verdict::kNotProven ? "NotProven"
                                                                            : "Failure";
  node.append_attribute("message") = base::markupText(message).c_str();
  node.text() = base::markupText(text).c_str();
}

void addProperties(const RunReport& report, const Digests& digests, pugi::xml_node suite) {
  pugi::xml_node properties = suite.append_child("properties");
  const auto property = [&](const char* key, const std::string& value) {
    pugi::xml_node node = properties.append_child("property");
    node.append_attribute("name") = key;
    node.append_attribute("value") = base::markupText(value).c_str();
  };
  property("verdict", std::string(inspect::verdictName(report.result.verdict)));
  property("digest", digests.results);
  property("inputs_digest", digests.inputs);
  property("firmware", report.firmware);
  property("machine", report.machine);
  if (!report.serial_number.empty()) property("serial_number", report.serial_number);
  property("seed", std::to_string(report.seed));
  property("imperfections", report.model.imperfections);
  property("twin", report.model.twin);
  if (!report.model.lost_steps.empty()) property("lost_steps", lostStepsSentence(report.model));
  if (const std::string but = reservationsLine(report); !but.empty()) property("reservations", but);
  property("repeat_command", report.repeat_command);
}

}  // namespace

std::string junitXml(const RunReport& report, const Digests& digests) {
  const inspect::InspectionResult& result = report.result;
  const auto count = [&](auto... verdicts) {
    return std::count_if(result.checks.begin(), result.checks.end(),
                         [&](const inspect::Check& c) { return ((c.verdict == verdicts) || ...); });
  };
  // Broken evidence has its own test case: no check alone shows it.
  const auto skipped = static_cast<long long>(result.unjudged.size());
  const auto tests = static_cast<long long>(result.checks.size()) + skipped + 1;
  const bool sound = result.problems.empty() && !result.checks.empty();
  const auto failures = static_cast<long long>(count(inspect::Verdict::kFail, inspect::Verdict::kNotProven));
  const auto errors = static_cast<long long>(count(inspect::Verdict::kInvalid)) + (sound ? 0 : 1);

  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  pugi::xml_node suites = document.append_child("testsuites");
  pugi::xml_node suite = suites.append_child("testsuite");
  const std::string name = report.scenario.empty() ? "kerfbench" : base::markupText(report.scenario);
  for (pugi::xml_node node : {suites, suite}) {
    node.append_attribute("name") = name.c_str();
    node.append_attribute("tests") = tests;
    node.append_attribute("failures") = failures;
    node.append_attribute("errors") = errors;
    if (node == suite) node.append_attribute("skipped") = skipped;
    node.append_attribute("time") = fmt::format("{:.6f}", report.virtual_s).c_str();
  }
  addProperties(report, digests, suite);

  const auto testCase = [&](const std::string& case_name) {
    pugi::xml_node node = suite.append_child("testcase");
    node.append_attribute("classname") = name.c_str();
    node.append_attribute("name") = case_name.c_str();
    return node;
  };
  std::string problems;
  for (const std::string& problem : result.problems) problems += problem + "\n";
  if (result.problems.empty() && result.checks.empty()) problems = "No check was made.\n";
  addOutcome(testCase("evidence"), sound ? inspect::Verdict::kPass : inspect::Verdict::kInvalid,
             problems.substr(0, problems.find('\n')), problems);
  for (const inspect::Check& check : result.checks) {
    const std::string when = whenOf(check.where);
    const std::string message =
        fmt::format("{}: {}{} {} (limit {}, U {}, guard {}){}", inspect::verdictName(check.verdict),
                    check.at_least ? "at least " : "", checkNumber(check, check.value), whereOf(check),
                    checkNumber(check, check.limit), checkNumber(check, check.u),
                    checkNumber(check, check.guard), when.empty() ? "" : " at " + when);
    addOutcome(testCase(check.name), check.verdict, message, check.explanation);
  }
  for (const inspect::Unjudged& unjudged : result.unjudged) {
    const std::string reason =
        fmt::format("{}: {}", unjudged.applies ? "not judged" : "not applicable", unjudged.reason);
    testCase(unjudged.name).append_child("skipped").append_attribute("message") =
        base::markupText(reason).c_str();
  }
  std::ostringstream out;
  document.save(out, "  ");
  return out.str();
}

}  // namespace kerfbench::report
