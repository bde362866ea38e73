// SPDX-License-Identifier: Apache-2.0
// What did not pass, and why: before anything else.
#include "hil/report/html_answer.h"

#include <algorithm>
#include <optional>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "hil/report/causes.h"
#include "hil/report/headline.h"
#include "hil/report/html_text.h"

namespace kerfbench::report {
namespace {

using inspect::Check;
using inspect::Verdict;

std::optional<std::size_t> momentOf(const RunReport& report, const std::string& check) {
  for (std::size_t i = 0; i < report.moments.size(); ++i)
    if (std::ranges::find(report.moments[i].checks, check) != report.moments[i].checks.end()) return i;
  return std::nullopt;
}

/// A link to the entity of a check, if its row is on the page.
std::string linkedWhere(const RunReport& report, const Check& check) {
  const std::string text = escapeHtml(whereOf(check));
  if (!hasEntityRow(report, check.where.unit, check.where.entity)) return text;
  return fmt::format("<a href='#{}'>{}</a>", entityAnchor(check.where.unit, check.where.entity), text);
}

std::string linkedWhen(const RunReport& report, const Check& check) {
  const std::string text = escapeHtml(whenOf(check.where));
  const auto moment = momentOf(report, check.name);
  return moment && !text.empty() ? fmt::format("<a href='#moment-{}'>{}</a>", *moment + 1, text) : text;
}

std::string factsOfCheck(const RunReport& report, const Check& check) {
  std::string html = "<dl>";
  const auto add = [&](std::string_view name, const std::string& value) {
    if (!value.empty()) html += fmt::format("<div><dt>{}<dd>{}</div>", name, value);
  };
  add("How much", escapeHtml(howMuchOf(check)));
  add("Where", linkedWhere(report, check));
  add("When", linkedWhen(report, check));
  return html + "</dl>";
}

/// The place on the drawing, and in the camera's picture where there is one.
std::string picturesOf(const RunReport& report, const Check& check) {
  std::string html = placeOnDieline(report, check.where);
  if (const auto place = placeNear(report, check.where)) html += placeFigure(report, *place, false);
  return html.empty() ? html : "<div class=seen>" + html + "</div>";
}

std::string phraseOf(const Check& check) {
  return check.verdict == Verdict::kFail ? failingPhrase(check.name) : check.title;
}

std::string followersOf(const RunReport& report, const FailureGroup& group) {
  if (group.followers.empty()) return {};
  std::string html =
      fmt::format("<div class=along><p>{} along with it, as a fault of that kind brings about:</p><ul>",
                  group.primary->verdict == Verdict::kFail ? "Fails" : "Not proven or measured");
  for (const Check* check : group.followers) {
    const std::string when = linkedWhen(report, *check);
    const bool is_as_primary = check->verdict == group.primary->verdict;
    html += fmt::format("<li id='check-{0}'><b>{1}</b> <small>{0}{6}</small>: {2}; {3}{4}{5}</li>",
                        escapeHtml(check->name), escapeHtml(phraseOf(*check)), escapeHtml(howMuchOf(*check)),
                        linkedWhere(report, *check), when.empty() ? "" : ", ", when,
                        is_as_primary ? "" : fmt::format(": {}", inspect::verdictName(check->verdict)));
  }
  return html + "</ul></div>";
}

/// The pins at the moment of a check, unless the page has shown them.
std::string waveformOf(const RunReport& report, const Check& check, std::set<std::size_t>& shown) {
  const auto moment = momentOf(report, check.name);
  return moment && shown.insert(*moment).second ? waveformFigure(report, *moment) : std::string();
}

/// Place, picture and pins of each check that another brought along.
std::string followersSeen(const RunReport& report, const FailureGroup& group, std::set<std::size_t>& shown) {
  std::string html;
  for (const Check* check : group.followers) {
    const std::string seen = picturesOf(report, *check) + waveformOf(report, *check, shown);
    html += fmt::format("<h4>{} <small>{}</small></h4><p>{}</p>", escapeHtml(phraseOf(*check)),
                        escapeHtml(check->name), escapeHtml(check->explanation)) +
            seen;
  }
  return htmlFold("along-" + group.primary->name, "Show place, picture and pins of each of these", html);
}

/// How to see the run at that moment. The page is read from a disk, and knows no server.
std::string motionOf(const RunReport& report, const Check& check) {
  if (report.trace.empty() || !check.where.hasTime()) return {};
  const auto moment = momentOf(report, check.name);
  const std::string page = moment ? report.moments[*moment].page : std::string();
  const std::string link =
      page.empty()
          ? std::string()
          : fmt::format("<a href='{}'>Open this moment</a>, 50 ms before and after. ", escapeHtml(page));
  return fmt::format(
      "<p class=motion>{}The whole run at this moment, from this folder: "
      "<code>kerfbench view {} --at {:.6f}</code></p>",
      link, escapeHtml(report.trace), check.where.time_s);
}

std::string articleOf(const RunReport& report, const FailureGroup& group, std::set<std::size_t>& shown) {
  const Check& check = *group.primary;
  return fmt::format("<article class={0} id='check-{1}'><h3>{2} <small>{1}: {3}</small></h3>{4}<p>{5}</p>",
                     verdictClass(check.verdict), escapeHtml(check.name), escapeHtml(phraseOf(check)),
                     inspect::verdictName(check.verdict), factsOfCheck(report, check),
                     escapeHtml(check.explanation)) +
         picturesOf(report, check) + waveformOf(report, check, shown) + motionOf(report, check) +
         followersOf(report, group) + followersSeen(report, group, shown) + "</article>\n";
}

/// The checks of a good run that have the least room, each with its figure.
std::string nearestToLimits(const RunReport& report) {
  constexpr std::size_t kTold = 3;
  std::vector<const Check*> all;
  for (const Check& check : report.result.checks)
    if (inspect::shareOfLimit(check) > 0.0) all.push_back(&check);
  std::ranges::stable_sort(all, std::ranges::greater(),
                           [](const Check* check) { return inspect::shareOfLimit(*check); });
  std::string text;
  for (std::size_t i = 0; i < std::min(kTold, all.size()); ++i)
    text += fmt::format("{}{} {}", i == 0 ? "" : "; ", all[i]->name, howMuchOf(*all[i]));
  return text;
}

/// What the job has, and nothing could tell.
std::string notJudgedOf(const RunReport& report) {
  std::string text;
  for (const inspect::Unjudged& unjudged : report.result.unjudged)
    if (unjudged.applies) text += (text.empty() ? "" : ", ") + unjudged.name;
  return text;
}

}  // namespace

std::string headlineSentence(const RunReport& report) {
  const Headline headline = headlineOf(report);
  if (report.result.verdict != Verdict::kFail || headline.what.empty()) return verdictSentence(report);
  return fmt::format("{}: {}.", headline.what, headline.how_much);
}

std::string headlineList(const RunReport& report) {
  std::string html;
  const auto add = [&](std::string_view name, const std::string& value) {
    if (!value.empty()) html += fmt::format("<dt>{}<dd>{}", name, escapeHtml(value));
  };
  if (report.result.verdict == Verdict::kPass) {
    add("Nearest to their limits", nearestToLimits(report));
    add("Not judged", notJudgedOf(report));
    return html.empty() ? html : "<dl class=answer>" + html + "</dl>";
  }
  if (report.result.verdict != Verdict::kFail) return {};
  const Headline headline = headlineOf(report);
  add("Where", headline.where);
  add("When", headline.when);
  add("Likely cause", headline.cause);
  add("Verdict", sentenceOfVerdict(report));
  return "<dl class=answer>" + html + "</dl>";
}

std::string nextStepsList(const RunReport& report) {
  std::string list;
  for (const std::string& step : nextSteps(report)) list += "<li>" + escapeHtml(step) + "</li>";
  return list.empty() ? list : "<ol class=steps>" + list + "</ol>";
}

std::string problemsList(const RunReport& report) {
  std::string list;
  for (const std::string& problem : report.result.problems) list += "<li>" + escapeHtml(problem) + "</li>";
  return list.empty() ? list : "<ul class=problems>" + list + "</ul>";
}

std::string failuresSection(const RunReport& report) {
  std::string html;
  std::set<std::size_t> shown;
  for (const Verdict verdict : {Verdict::kFail, Verdict::kInvalid, Verdict::kNotProven})
    for (const FailureGroup& group : failureGroups(report.result.checks, verdict))
      html += articleOf(report, group, shown);
  return html;
}

}  // namespace kerfbench::report
