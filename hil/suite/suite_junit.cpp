// SPDX-License-Identifier: Apache-2.0
#include <sstream>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pugixml.hpp>

#include "hil/base/text.h"
#include "hil/suite/suite_report.h"

namespace kerfbench::suite {
namespace {

namespace fs = std::filesystem;

/// Text that XML 1.0 can hold: lines of printable characters. Control characters have no place in it, not
/// even as references.
std::string lines(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    out += base::printable(text.substr(0, end), text.size());
    if (end == std::string_view::npos) break;
    out += '\n';
    text.remove_prefix(end + 1);
  }
  return out;
}

void put(pugi::xml_node node, const char* name, const std::string& value) {
  node.append_attribute(name) = lines(value).c_str();
}

/// Path of the report for the page of a CI: from the current folder, if the report is below it.
std::string attachment(const SuiteRow& row, const fs::path& folder) {
  std::error_code error;
  const fs::path path =
      fs::absolute(folder / reportLink(row)).lexically_normal().lexically_relative(fs::current_path(error));
  if (error || path.empty() || *path.begin() == "..") return {};
  return fmt::format("[[ATTACHMENT|{}]]\n", path.generic_string());
}

std::string systemOut(const SuiteRow& row, const fs::path& folder) {
  std::string text = fmt::format("scenario {}\nexpected {}\n{}\n", row.run.scenario_as_written,
                                 describe(row.run.expect), outcomeName(row.outcome));
  if (!row.verdict) return text + row.why + "\n";
  const RunVerdict& verdict = *row.verdict;
  text += fmt::format("{}: {}\n", verdict.verdict, verdict.summary);
  for (const inspect::Check& check : verdict.checks)
    text += fmt::format("{:<10} {:<14} {} {}\n", inspect::verdictName(check.verdict), check.name,
                        figuresOf(check), check.subject);
  for (const std::string& problem : verdict.problems) text += "INVALID: " + problem + "\n";
  for (const std::string& reservation : verdict.reservations) text += "mind: " + reservation + "\n";
  text += fmt::format("seed {}, imperfections {}, twin {}\nfirmware {} sha256 {}\ndigest {}\nreport {}\n",
                      verdict.seed, verdict.imperfections, verdict.twin, verdict.firmware,
                      verdict.firmware_sha256, verdict.digest, reportLink(row));
  return text + attachment(row, folder);
}

void addOutcome(pugi::xml_node test_case, const SuiteRow& row) {
  if (row.outcome == Outcome::kAsExpected) return;
  if (row.outcome == Outcome::kNotRun) {
    put(test_case.append_child("skipped"), "message", row.why.empty() ? "not run" : row.why);
    return;
  }
  const bool invalid = row.verdict && row.verdict->verdict == "INVALID";
  pugi::xml_node node =
      test_case.append_child(row.outcome == Outcome::kBroken || invalid ? "error" : "failure");
  put(node, "type", row.outcome == Outcome::kBroken ? "Broken" : invalid ? "Invalid" : "NotAsExpected");
  put(node, "message", row.why);
}

}  // namespace

std::string junitXml(const SuiteResult& result, const fs::path& folder) {
  std::size_t errors = 0;
  std::size_t failures = 0;
  double virtual_s = 0.0;
  for (const SuiteRow& row : result.rows) {
    const bool invalid = row.verdict && row.verdict->verdict == "INVALID";
    const bool is_error =
        row.outcome == Outcome::kBroken || (row.outcome == Outcome::kNotAsExpected && invalid);
    errors += is_error ? 1U : 0U;
    failures += row.outcome == Outcome::kNotAsExpected && !is_error ? 1U : 0U;
    virtual_s += row.verdict ? row.verdict->virtual_s : 0.0;
  }
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  pugi::xml_node suites = document.append_child("testsuites");
  pugi::xml_node suite = suites.append_child("testsuite");
  for (pugi::xml_node node : {suites, suite}) {
    put(node, "name", result.name);
    put(node, "tests", std::to_string(result.rows.size()));
    put(node, "failures", std::to_string(failures));
    put(node, "errors", std::to_string(errors));
    if (node == suite) put(node, "skipped", std::to_string(result.count(Outcome::kNotRun)));
    put(node, "time", fmt::format("{:.6f}", virtual_s));
  }
  pugi::xml_node properties = suite.append_child("properties");
  const auto property = [&](const char* name, const std::string& value) {
    if (value.empty()) return;
    pugi::xml_node node = properties.append_child("property");
    put(node, "name", name);
    put(node, "value", value);
  };
  property("title", result.title);
  property("summary", headline(result));
  property("image", result.image);
  property("image_sha256", result.image_sha256);
  property("kerfbench", result.bench_version);
  property("part", result.part);
  for (const SuiteRow& row : result.rows) {
    pugi::xml_node node = suite.append_child("testcase");
    put(node, "classname", result.name);
    put(node, "name", row.run.name);
    put(node, "time", fmt::format("{:.6f}", row.verdict ? row.verdict->virtual_s : 0.0));
    addOutcome(node, row);
    node.append_child("system-out").text() = lines(systemOut(row, folder)).c_str();
  }
  std::ostringstream out;
  document.save(out, "  ");
  return out.str();
}

}  // namespace kerfbench::suite
