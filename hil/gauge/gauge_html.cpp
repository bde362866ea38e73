// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "hil/gauge/gauge_report.h"
#include "hil/report/html_text.h"

namespace kerfbench::gauge {
namespace {

constexpr std::string_view kCss = R"css(
.band{fill:var(--acc);opacity:.13}.dots.miss{stroke:var(--fail)}
.dots.big{stroke-width:4}.way{fill:none;stroke:var(--nom);stroke-width:.8}.curve{fill:none;stroke:var(--fg);stroke-width:1.2}
.oc{fill:currentColor;opacity:.85}.cell{fill:var(--acc)}.root{fill:var(--mute)}
.arrow{stroke:var(--fail);stroke-width:.35;stroke-linecap:round}.goal{fill:var(--pass);opacity:.16}
.ci{stroke:var(--mute);stroke-width:1.4}.hold{fill:var(--pass)}.off{fill:var(--fail)}.warn{fill:var(--fail)!important}
svg.field{background:var(--card);border-radius:6px}.open{color:var(--np)}
details{margin:8px 0}summary{cursor:pointer;color:var(--mute)}
.claims td{padding:4px 8px;font-size:13px}h3{font-size:16px;margin:22px 0 6px}
)css";

std::string_view stateClass(Claim::State state) {
  return state == Claim::State::kHolds ? "pass" : state == Claim::State::kFails ? "fail" : "open";
}
std::string_view stateText(Claim::State state) {
  return state == Claim::State::kHolds ? "holds" : state == Claim::State::kFails ? "fails" : "open";
}

std::size_t countOf(const std::vector<Claim>& claims, Claim::State state) {
  return static_cast<std::size_t>(
      std::ranges::count_if(claims, [&](const Claim& c) { return c.state == state; }));
}

std::string header(const GaugeResult& result, const GaugeOptions& options, const GaugeFacts& facts) {
  const std::size_t fails = countOf(result.claims, Claim::State::kFails);
  const std::size_t open = countOf(result.claims, Claim::State::kOpen);
  std::string html =
      fmt::format("<header class={}><div class=big>{}</div><p>{} of {} claims hold, {} do not{}.</p>",
                  fails == 0 ? "pass" : "fail", fails == 0 ? "HOLDS" : "DOES NOT HOLD",
                  countOf(result.claims, Claim::State::kHolds), result.claims.size(), fails,
                  open == 0 ? "" : fmt::format("; {} need more cases to be told", open));
  html += fmt::format(
      "<div class=facts>Machine {}; {} artefacts cut and photographed, {} runs of three cuts watched; seed "
      "{}; Kerfbench {}"
      "<br>Kerf camera {}<br>Spot camera {}</div></header>",
      report::escapeHtml(facts.machine), result.kerf_cases, result.still_cases, options.seed,
      report::escapeHtml(facts.version), report::escapeHtml(facts.kerf_camera),
      report::escapeHtml(facts.spot_camera));
  return html;
}

/// One row for each claim, one pair of columns for each preset.
struct ClaimRow {
  std::string what, limit;
  std::vector<const Claim*> of_preset;
  [[nodiscard]] bool fails() const {
    return std::ranges::any_of(of_preset,
                               [](const Claim* c) { return c && c->state == Claim::State::kFails; });
  }
};

std::vector<ClaimRow> rowsOf(const GaugeResult& result) {
  std::vector<ClaimRow> rows;
  for (std::size_t s = 0; s < result.sections.size(); ++s) {
    for (const Claim& claim : result.claims) {
      if (claim.preset != result.sections[s].preset) continue;
      auto row = std::ranges::find(rows, claim.what, &ClaimRow::what);
      if (row == rows.end()) row = rows.insert(rows.end(), {claim.what, claim.limit, {}});
      row->of_preset.resize(result.sections.size());
      row->of_preset[s] = &claim;
    }
  }
  return rows;
}

std::string claimTable(const std::vector<ClaimRow>& rows, const GaugeResult& result, bool failing) {
  std::string html = "<table class=claims><thead><tr><th>Claim<th>Limit";
  for (const GaugeSection& s : result.sections)
    html += fmt::format("<th>{} machines<th>&nbsp;", report::escapeHtml(s.preset));
  html += "</tr></thead><tbody>";
  for (const ClaimRow& row : rows) {
    if (row.fails() != failing) continue;
    html += fmt::format("<tr><td>{}<td>{}", report::escapeHtml(row.what), report::escapeHtml(row.limit));
    for (const Claim* c : row.of_preset) {
      html += c == nullptr ? std::string("<td>–<td>")
                           : fmt::format("<td>{}<td class='v {}'>{}", report::escapeHtml(c->measured),
                                         stateClass(c->state), stateText(c->state));
    }
    html += "</tr>";
  }
  return html + "</tbody></table>";
}

/// What does not hold first.
std::string claimSection(const GaugeResult& result) {
  const std::vector<ClaimRow> rows = rowsOf(result);
  std::string html = "<h2>Claims</h2>";
  const bool some_fail = std::ranges::any_of(rows, &ClaimRow::fails);
  if (some_fail) html += "<h3>That do not hold</h3>" + claimTable(rows, result, true) + "<h3>The others</h3>";
  html += claimTable(rows, result, false);
  return html +
         "<p class=note>Open: the cases run are too few to tell; the confidence interval is in brackets.</p>";
}

std::string kindTable(const GaugeSection& s) {
  std::string html =
      "<table><thead><tr><th>Fault<th class=num>bad: FAIL<th class=num>NOT PROVEN<th class=num>PASS<th "
      "class=num>INVALID"
      "<th class=num>good: PASS<th class=num>NOT PROVEN<th class=num>FAIL<th "
      "class=num>INVALID</tr></thead><tbody>";
  const auto cell = [](const std::map<inspect::Verdict, std::size_t>& counts, inspect::Verdict v,
                       bool wrong) {
    const auto at = counts.find(v);
    const std::size_t n = at == counts.end() ? 0 : at->second;
    return fmt::format("<td class='num{}'>{}", wrong && n > 0 ? " hit" : "", n);
  };
  for (const KindResult& k : s.kinds) {
    html += fmt::format("<tr><td>{}", faultName(k.kind));
    html += cell(k.bad, inspect::Verdict::kFail, false) + cell(k.bad, inspect::Verdict::kNotProven, false) +
            cell(k.bad, inspect::Verdict::kPass, true) + cell(k.bad, inspect::Verdict::kInvalid, true);
    html += cell(k.good, inspect::Verdict::kPass, false) + cell(k.good, inspect::Verdict::kNotProven, true) +
            cell(k.good, inspect::Verdict::kFail, true) + cell(k.good, inspect::Verdict::kInvalid, true) +
            "</tr>";
  }
  return html + "</tbody></table>";
}

std::string wrongList(const GaugeSection& s) {
  if (s.wrong.empty()) return "<p class=note>No verdict was wrong, none open, none INVALID.</p>";
  std::string html = fmt::format(
      "<details><summary>{} verdicts that are wrong, open on a good cut, or INVALID; repeat "
      "one with <code>kerfbench gauge --case NAME</code></summary><ul>",
      s.wrong.size());
  for (const std::string& wrong : s.wrong) html += "<li>" + report::escapeHtml(wrong);
  return html + "</ul></details>";
}

std::string budgetTable(const GaugeSection& s) {
  std::string html =
      "<table><thead><tr><th>Budget against simulation<th class=num>Cases<th class=num>Budget / Monte-Carlo, "
      "median<th "
      "class=num>within 10 %<th class=num>95 % differ by less than<th class=num>RMS error / "
      "stated</tr></thead><tbody>";
  const auto row = [&](const char* name, const BudgetCheck& b) {
    if (b.cases == 0) return;
    html += fmt::format(
        "<tr><td>{}<td class=num>{}<td class=num>{:.3f}<td class=num>{:.1f} %<td class=num>{:.1f} %<td "
        "class=num>{:.2f}</tr>",
        name, b.cases, b.median_ratio, 100.0 * b.within_10_percent, 100.0 * b.p95_departure,
        b.observed_ratio);
  };
  row("worst deviation of all lines", s.budget);
  row("largest drift of all cuts", s.drift_budget);
  return html +
         "</tbody></table><p class=note>The last column is 1 where what is stated is what is seen, more "
         "where the "
         "stated uncertainty is too small.</p>";
}

std::string grrTable(const std::optional<Grr>& g) {
  if (!g) return {};
  return fmt::format(
      "<table><thead><tr><th>{} parts × {} placements × {} repeats<th class=num>EV, µm<th class=num>AV, "
      "µm<th class=num>GRR, "
      "µm<th class=num>PV, µm<th class=num>%GRR of tolerance<th class=num>of study<th "
      "class=num>ndc</tr></thead><tbody><tr>"
      "<td>Worst deviation of all lines (ANOVA, AIAG MSA)<td class=num>{:.3f}<td class=num>{:.3f}<td "
      "class=num>{:.3f}<td "
      "class=num>{:.1f}<td class=num>{:.2f} %<td class=num>{:.2f} %<td class=num>{:.0f}</tr></tbody></table>",
      kGrrParts, kGrrPlacements, kGrrRepeats, 1e3 * g->repeatability, 1e3 * g->reproducibility, 1e3 * g->grr,
      1e3 * g->part, g->percent_of_tolerance, g->percent_of_study, g->ndc);
}

std::vector<GaugePoint> linesOnly(const std::vector<GaugePoint>& points) {
  std::vector<GaugePoint> lines;
  std::ranges::copy_if(points, std::back_inserter(lines), [](const GaugePoint& p) {
    return p.kind != FaultKind::kCorner && p.kind != FaultKind::kEnd;
  });
  return lines;
}

std::string sectionHtml(const GaugeSection& s) {
  std::string html =
      fmt::format("<h2>Machines: {}</h2><h3>How often the interval holds the truth</h3>", s.preset);
  html += coveragePlot(s.coverage);
  html +=
      "<p class=note>Share of cases whose truth lies within the stated value ± U, with its 95 % confidence "
      "interval "
      "(Clopper and Pearson); green: 94 to 96.8 %. Left of 70 %: less. Median U.</p>";
  html += "<h3>Worst deviation of the lines</h3><div class=figs>" + biasPlot(s.worst, s.linearity) +
          zPlot(s.worst) + runChart(s.repeat_mm, "Repeats, as it lies") +
          runChart(s.relay_mm, "Repeats, laid anew") + fieldPlot(s.field) + detectablePlot(s.kinds) +
          "</div>";
  html += grrTable(s.grr) + budgetTable(s);
  html += "<h3>Verdicts</h3><div class=figs>" +
          verdictPlot(linesOnly(s.worst), "Faults of lines: verdict of the path") +
          verdictPlot(s.joints, "Faults of corners and ends: verdict") + "</div>" + kindTable(s) +
          wrongList(s);
  html += "<h3>Largest drift along x</h3><div class=figs>" + biasPlot(s.drift, s.drift_linearity) +
          zPlot(s.drift) + runChart(s.drift_repeat_mm, "Drift, repeats") +
          verdictPlot(s.drift, "Verdict of stillness") + "</div>";
  return html;
}

}  // namespace

std::string gaugeHtml(const GaugeResult& result, const GaugeOptions& options, const GaugeFacts& facts) {
  std::string html = report::htmlPageHead("gauge: " + facts.machine, kCss);
  html += header(result, options, facts) + claimSection(result);
  for (const GaugeSection& s : result.sections) html += sectionHtml(s);
  html += fmt::format(
      "<h2>Again</h2><p><code>{}</code></p><p class=note>Same input, same bytes. "
      "docs/explanation/what-it-is-worth.md says how "
      "to read this page.</p>",
      report::escapeHtml(facts.command));
  return html.append(report::kHtmlPageEnd);
}

}  // namespace kerfbench::gauge
