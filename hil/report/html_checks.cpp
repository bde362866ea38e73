// SPDX-License-Identifier: Apache-2.0
// All checks with their numbers.
#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "hil/report/html_answer.h"
#include "hil/report/html_text.h"

namespace kerfbench::report {
namespace {

using inspect::Check;
using inspect::Verdict;

std::string checkRow(const Check& c) {
  return fmt::format(
      "<tr><th scope=row><b>{}</b> <small>{}</small><span class=why>{}</span><td class='v {}'>{}<td "
      "class=num>{}{}<td class=num>{} {}<td class=num>{}<td class=num>{}<td>{}</tr>",
      escapeHtml(c.title), escapeHtml(c.name), escapeHtml(c.explanation), verdictClass(c.verdict),
      inspect::verdictName(c.verdict), c.at_least ? "≥ " : "", checkNumber(c, c.value), c.upper ? "≤" : "≥",
      checkNumber(c, c.limit), c.u > 0.0 ? checkNumber(c, c.u) : "–",
      c.guard > 0.0 ? checkNumber(c, c.guard) : "–", gaugeSvg(c));
}

std::string tableOf(const std::vector<const Check*>& checks, std::string_view label) {
  if (checks.empty()) return {};
  std::string html =
      "<table class='checks sortable'><thead><tr><th scope=col>Check<th scope=col>Verdict<th scope=col "
      "class=num>Value<th scope=col class=num>Limit<th scope=col class=num>U (k = 2)<th scope=col "
      "class=num>Guard w<th scope=col>Against limit</tr></thead><tbody>";
  for (const Check* check : checks) html += checkRow(*check);
  return scrolled(label, html + "</tbody></table>");
}

std::string unjudgedTable(const std::vector<inspect::Unjudged>& unjudged) {
  if (unjudged.empty()) return {};
  std::string html = "<table class=checks><tbody>";
  for (const inspect::Unjudged& u : unjudged) {
    html += fmt::format(
        "<tr><th scope=row><b>{}</b> <small>{}</small><span class=why>{}</span><td class='v mute'>{}</tr>",
        escapeHtml(u.title), escapeHtml(u.name), escapeHtml(u.reason),
        u.applies ? "not judged" : "not applicable");
  }
  return html + "</tbody></table>";
}

}  // namespace

std::string checksSection(const RunReport& report) {
  std::vector<const Check*> others;
  std::vector<const Check*> passed;
  for (const Check& check : report.result.checks)
    (check.verdict == Verdict::kPass ? passed : others).push_back(&check);
  // Worst first: FAIL, INVALID, NOT PROVEN.
  std::ranges::stable_sort(others, {}, [](const Check* c) {
    return c->verdict == Verdict::kFail ? 0 : c->verdict == Verdict::kInvalid ? 1 : 2;
  });
  const std::string html =
      tableOf(others, "Checks that did not pass") +
      htmlFold("passes",
               passed.size() == 1 ? "Show the check that passes"
                                  : fmt::format("Show the {} checks that pass", passed.size()),
               tableOf(passed, "Checks that pass")) +
      htmlFold("unjudged", fmt::format("Show what was not judged ({})", report.result.unjudged.size()),
               unjudgedTable(report.result.unjudged));
  if (html.empty()) return html;
  return html +
         "<p class=note>Rule (JCGM 106): PASS if the value is inside limit − w, FAIL if it is outside limit "
         "+ "
         "w, NOT PROVEN between, INVALID if it could not be measured. The value of a worst-of-many check is "
         "corrected for being an extreme of noisy readings, and its U belongs to that value.</p>";
}

}  // namespace kerfbench::report
