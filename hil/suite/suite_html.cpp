// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/batch/job_folder.h"
#include "hil/report/html_text.h"
#include "hil/suite/suite_report.h"

namespace kerfbench::suite {
namespace {

using report::escapeHtml;

std::string_view classOf(const std::string& verdict) {
  if (verdict == "PASS") return "pass";
  if (verdict == "FAIL") return "fail";
  return verdict == "NOT PROVEN" ? "notproven" : "invalid";
}

/// What the plan has chosen for a run, in words.
std::string choicesOf(const PlannedRun& run) {
  std::vector<std::string> words;
  const RunChoices& choices = run.choices;
  if (choices.seed) words.push_back(fmt::format("seed {}", *choices.seed));
  if (choices.imperfections) words.push_back(*choices.imperfections);
  if (choices.twin) words.push_back("twin " + *choices.twin);
  if (choices.time_limit_s) words.push_back(fmt::format("time limit {} s", *choices.time_limit_s));
  for (const auto& [key, value] : choices.limits) words.push_back(fmt::format("{} {}", key, value));
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string checkList(const SuiteRow& row) {
  std::string rows;
  for (const inspect::Check& check : row.verdict->checks) {
    rows += fmt::format("<tr><td class='v {}'>{}<td>{}<td>{}<td>{}</tr>\n",
                        classOf(std::string(inspect::verdictName(check.verdict))),
                        inspect::verdictName(check.verdict), escapeHtml(check.name),
                        escapeHtml(figuresOf(check)), escapeHtml(check.subject));
  }
  return fmt::format("<details><summary>{} checks</summary><table>{}</table></details>",
                     row.verdict->checks.size(), rows);
}

std::string nameCell(const SuiteRow& row) {
  const std::string name = escapeHtml(row.run.name);
  const std::string link =
      row.verdict ? fmt::format("<a href='{}'>{}</a>", escapeHtml(reportLink(row)), name) : name;
  return fmt::format("<td>{}<span class=why>{}</span><span class=why>{}</span>", link,
                     escapeHtml(row.run.title), escapeHtml(choicesOf(row.run)));
}

std::string lastCell(const SuiteRow& row) {
  std::string html;
  if (!row.why.empty()) html += fmt::format("<span class=hit>{}</span> ", escapeHtml(row.why));
  if (row.outcome == Outcome::kBroken)
    html += fmt::format("<a href='{}'>log</a> ",
                        escapeHtml((jobFolder({}, row.run) / batch::kJobLog).generic_string()));
  if (row.earlier_tries > 0)
    html += fmt::format("<small>{} earlier tries are kept beside it</small> ", row.earlier_tries);
  if (!row.verdict) return html;
  if (const inspect::Check* nearest = nearestToLimit(*row.verdict))
    html += fmt::format("nearest to its limit: {} {}", escapeHtml(nearest->name),
                        escapeHtml(figuresOf(*nearest)));
  for (const std::string& reservation : row.verdict->reservations)
    html += fmt::format("<span class=why>mind: {}</span>", escapeHtml(reservation));
  return html + checkList(row);
}

std::string rowHtml(const SuiteRow& row) {
  const std::string verdict = row.verdict ? row.verdict->verdict : outcomeName(row.outcome);
  const std::string_view verdict_class = row.verdict                       ? classOf(verdict)
                                         : row.outcome == Outcome::kBroken ? "invalid"
                                                                           : "mute";
  const bool is_run = row.outcome != Outcome::kNotRun;
  return fmt::format(
      "<tr>{}<td>{}<td class='v {}'>{}<td class='{}'>{}<span class=why>expected: {}</span><td "
      "class=num>{}<td>{}"
      "</tr>\n",
      nameCell(row), escapeHtml(fmt::format("{}", fmt::join(row.run.tags, ", "))), verdict_class, verdict,
      row.outcome == Outcome::kAsExpected ? "pass"
      : is_run                            ? "hit"
                                          : "mute",
      outcomeName(row.outcome), escapeHtml(describe(row.run.expect)),
      is_run ? fmt::format("{:.1f} s", row.wall_s) : "–", lastCell(row));
}

}  // namespace

std::string indexPage(const SuiteResult& result) {
  const int code = result.exitCode();
  const bool complete = result.count(Outcome::kNotRun) == 0;
  const char* const page_class = code != 0 ? "fail" : complete ? "pass" : "notproven";
  std::string html = report::htmlPageHead(result.name + ": release test");
  html += fmt::format(
      "<header class={}><div class=big>{}</div><p>{}{}</p><div class=facts>{}</div></header>\n", page_class,
      code != 0  ? "NOT GOOD"
      : complete ? "GOOD"
                 : "NOT COMPLETE",
      escapeHtml(headline(result)), result.title.empty() ? "" : "<br>" + escapeHtml(result.title),
      report::htmlFacts({{"Suite", result.name},
                         {"Release", result.image},
                         {"SHA-256", result.image_sha256},
                         {"Part", result.part},
                         {"Kerfbench", result.bench_version}}));
  html +=
      "<table><thead><tr><th>Run<th>Tags<th>Verdict<th>Outcome<th class=num>Took<th>Why, figures</tr></thead>"
      "<tbody>\n";
  for (const SuiteRow& row : result.rows) html += rowHtml(row);
  html += "</tbody></table>\n";
  html += report::kHtmlPageEnd;
  return html;
}

}  // namespace kerfbench::suite
