// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/head_service/head_figures.h"
#include "hil/head_service/head_report.h"
#include "hil/report/html_text.h"

namespace kerfbench::head_service {
namespace {

using Eigen::Vector2d;

constexpr std::string_view kCss = R"css(
svg.headmap{background:var(--card);border-radius:6px;max-height:600px}
.wantedgrid,.drawngrid,.way,.scalebar,.headmap line{fill:none;vector-effect:non-scaling-stroke}
.wantedgrid{stroke:var(--nom);stroke-width:.7;opacity:.55}.drawngrid{stroke:var(--acc);stroke-width:1.3}
.way{stroke:var(--fail);stroke-width:1.4}.mark{fill:var(--fail)}.scalebar{stroke:var(--fg);stroke-width:2.5}
.headmap line{stroke-width:1.5;stroke-linecap:round}
.f0{stroke:var(--b0);fill:var(--b0)}.f1{stroke:var(--b1);fill:var(--b1)}.f2{stroke:var(--b2);fill:var(--b2)}
.f3{stroke:var(--b3);fill:var(--b3)}.f4{stroke:var(--b4);fill:var(--b4)}.headmap circle{stroke:none}
.circle{fill:none;stroke:var(--fail);stroke-dasharray:4 3}tr.best td{font-weight:650}
table.iterations td,table.iterations th{padding:6px 5px}
details{margin:8px 0}td.words{color:var(--mute)}
)css";

std::string micrometres(double mm) { return fmt::format("{:.{}f}", 1e3 * mm, mm < 0.1 ? 1 : 0); }

std::string ofLargest(const calibrate::LargestError& largest) {
  return fmt::format("{} ± {}", lengthText(largest.value_mm), lengthText(largest.U_mm));
}

/// The verdict in one plain sentence or two.
std::string sentence(const HeadCalibration& result, const HeadPlan& plan) {
  const HeadIteration& best = result.iterations.at(result.best);
  const std::string before = lengthText(result.iterations.front().before.max_mm);
  const std::string limit = lengthText(plan.limit_mm);
  if (result.end == HeadEnd::kNotVerified) {
    return fmt::format(
        "A table was fitted to marks that are off by up to {}. By the fit it should leave {} at most "
        "anywhere in "
        "the field (k = 2), the limit is {}; nothing was cut with it yet to see.{}",
        before, ofLargest(best.table.largest), limit,
        result.good() ? "" : " That proves nothing: mark more, or verify it.");
  }
  const std::string left = fmt::format(
      "anywhere in the field the beam is off by {} at most (k = 2), the limit is {}; at {} places that were "
      "never "
      "marked {} at most were measured, {} RMS",
      ofLargest(best.table.largest), limit, best.after.marks, lengthText(best.after.max_mm),
      lengthText(best.after.rms_mm));
  if (result.good())
    return fmt::format("The table is good: {}. Before, marks were off by up to {}.", left, before);
  const std::string_view why =
      result.end == HeadEnd::kNoBetter ? "and a denser grid no longer improves it" : "after the last grid";
  if (result.verdict == inspect::Verdict::kNotProven)
    return fmt::format("The table is near its limit, and it is not proven on which side, {}: {}.", why, left);
  return fmt::format("The table is not good enough, {}: {}.", why, left);
}

std::string header(const HeadCalibration& result, const HeadPlan& plan, const HeadFacts& facts) {
  const inspect::Verdict shown =
      result.end == HeadEnd::kNotVerified ? inspect::Verdict::kNotProven : result.verdict;
  const Vector2d size_mm = facts.field_W_mm.sizes();
  return fmt::format("<header class={}><div class=big>{}</div><p>{}</p><div class=facts>{}</div></header>\n",
                     report::verdictClass(shown), result.verdictName(),
                     report::escapeHtml(sentence(result, plan)),
                     report::htmlFacts({{"Machine", facts.machine},
                                        {"Field", fmt::format("{:g} × {:g} mm", size_mm.x(), size_mm.y())},
                                        {"Kerf camera", facts.camera},
                                        {"Date", plan.date},
                                        {"Marks", fmt::format("{:g} mm", facts.mark_size_mm)},
                                        {"Pictures", facts.source},
                                        {"Kerfbench", facts.version}}));
}

std::vector<PlaceError> errorsIn(std::span<const MeasuredSheet> sheets) {
  std::vector<PlaceError> errors;
  for (const MeasuredSheet& sheet : sheets) {
    for (const MeasuredMark& mark : sheet.marks) errors.push_back({mark.wanted.p_W_mm, mark.error_mm()});
  }
  return errors;
}

std::string maps(const HeadCalibration& result, const HeadPlan& plan, const HeadFacts& facts) {
  const HeadIteration& best = result.iterations.at(result.best);
  const auto error = [&](const Vector2d& p_W_mm) -> std::optional<Vector2d> {
    const auto d_mm = facts.table ? facts.table->at_mm(p_W_mm) : std::optional(Vector2d(0.0, 0.0));
    if (!d_mm) return std::nullopt;
    const auto spot = best.head.fit.spotOf(p_W_mm + *d_mm);
    if (!spot) return std::nullopt;
    return spot->p_W_mm - p_W_mm;
  };
  std::string html = "<div class=panels>";
  html += deformedGrid(facts.field_W_mm, error, errorsIn({&result.iterations.front().marks, 1}));
  html += errorArrows(facts.field_W_mm, errorsIn(best.verified), plan.limit_mm) + "</div>";
  if (best.verified.empty()) {
    return html + "<p class=note>No table was verified, so there is no picture of what is left.</p>";
  }
  return html + "<div class=legend>" + report::limitLegend(plan.limit_mm) + "</div>";
}

/// What is stated of the table, and how the places that verify bear it out.
std::string statedWords(const HeadIteration& best) {
  const calibrate::VerifiedTable& table = best.table;
  const calibrate::CoverBand band = calibrate::coverBand(table.marks);
  std::string html = fmt::format(
      "<p class=note>{} of {} places ({:.1f} %) lie within the ellipse in which the fit and all other places "
      "expect 95 % of them; {} to {} do so by chance{}.",
      table.covered, table.marks,
      100.0 * static_cast<double>(table.covered) / static_cast<double>(table.marks), band.least, band.most,
      table.coverHolds() ? "" : ": <b>what is stated does not fit the places</b>");
  if (table.disagreeing > 0)
    html += fmt::format(" {} of them disagree with all others and count by their own error alone.",
                        table.disagreeing);
  return html +
         fmt::format(
             " The largest error is that anywhere in the field the controller uses, rim included: what "
             "fit and places together let expect, ± U (k = 2). Before anything was verified the fit alone "
             "stated more or less of it, by tolerances and data sheets: {} places lie within its 95 %, and "
             "RMS they are off {:.2f} times as far as it states; chance reaches {:.2f}{}.</p>",
             best.spread.covered, best.spread.ratio, best.spread.most_ratio,
             best.spread.holds() ? "" : ": <b>what the fit states is too small</b>");
}

std::string residuals(const HeadCalibration& result, const HeadPlan& plan) {
  const HeadIteration& best = result.iterations.at(result.best);
  const std::vector<PlaceError> errors = errorsIn(best.verified);
  if (errors.empty()) return {};
  return fmt::format("<p>{}</p><div class=figs>{}{}</div>{}", report::gaugeSvg(best.check(plan.limit_mm)),
                     errorHistogram(errors, plan.limit_mm), errorScatter(errors, plan.limit_mm),
                     statedWords(best));
}

std::string iterationRow(const HeadIteration& iteration, std::size_t number, bool best, double limit_mm) {
  const MeasuredSheet& marks = iteration.marks;
  const calibrate::CorrectionTableResult& table = iteration.head.table;
  const std::string grid = iteration.grid > 0 ? fmt::format("{0} × {0}", iteration.grid) : "as cut";
  std::string html = fmt::format(
      "<tr{}><td class=num>{}<td class=num>{}<td class=num>{} of {}<td class=num>{}<td class=num>{}<td "
      "class=num>{} / {}<td "
      "class=num>{} × {}<td class=num>{}",
      best ? " class=best" : "", number, grid, marks.marks.size(),
      marks.marks.size() + static_cast<std::size_t>(marks.missing), marks.false_marks,
      iteration.head.fit.rejected(), micrometres(iteration.before.max_mm),
      micrometres(iteration.before.rms_mm), table.grid.x_mm().size(), table.grid.y_mm().size(),
      fmt::format("{} ± {}", micrometres(iteration.table.largest.value_mm),
                  micrometres(iteration.table.largest.U_mm)));
  if (iteration.verified.empty()) return html + "<td class=num>–<td class=num>–<td class=num>–</tr>";
  return html + fmt::format("<td class=num>{}, {}<td class='num{}'>{} / {}<td class='num{}'>{:.1f} %</tr>",
                            iteration.after.marks, iteration.verified.size(),
                            iteration.within(limit_mm) ? "" : " hit", micrometres(iteration.after.max_mm),
                            micrometres(iteration.after.rms_mm), iteration.spread.holds() ? "" : " hit",
                            100.0 * static_cast<double>(iteration.table.covered) /
                                static_cast<double>(std::max<std::size_t>(iteration.after.marks, 1)));
}

std::string iterations(const HeadCalibration& result, const HeadPlan& plan) {
  std::string html =
      "<table class=iterations><thead><tr><th class=num>#<th class=num>Grid<th class=num>Found<th "
      "class=num>False<th "
      "class=num>Rejected<th class=num>Off by, µm<br>max / RMS<th class=num>Table<br>nodes<th "
      "class=num>Anywhere, "
      "µm<br>at most<th "
      "class=num>Verified at<br>places, sheets<th class=num>Left, µm<br>max / RMS<th class=num>In the<br>95 "
      "%</tr></thead><tbody>";
  for (std::size_t i = 0; i < result.iterations.size(); ++i)
    html += iterationRow(result.iterations[i], i + 1, i == result.best, plan.limit_mm);
  html +=
      "</tbody></table><p class=note>Each grid is cut with the table of the iteration before, the first with "
      "none or "
      "the one that was at work. Anywhere: the largest error of the beam in the whole field with the new "
      "table, "
      "± U (k = 2); with U it must be within the limit. In bold: the iteration whose table is the best. Red: "
      "beyond the limit, or not proven to be within it; in the last column: the places are farther off than "
      "the "
      "fit states, so a denser grid follows if there is one.</p>";
  std::string remarks;
  for (const HeadIteration& iteration : result.iterations) {
    for (const std::string& remark : iteration.marks.remarks) remarks += "<li>" + report::escapeHtml(remark);
    for (const MeasuredSheet& sheet : iteration.verified)
      for (const std::string& remark : sheet.remarks) remarks += "<li>" + report::escapeHtml(remark);
  }
  return remarks.empty() ? html : html + "<h3>What the sheets showed besides</h3><ul>" + remarks + "</ul>";
}

std::string parameterRow(const calibrate::HeadParameterFinding& finding) {
  const calibrate::HeadParameterText text = calibrate::textOf(finding.which);
  const bool angle = text.unit == "rad";
  const double scale = angle ? 1e3 : 1.0;
  std::string words = "held";
  if (!finding.held) {
    words = finding.mixed_with ? fmt::format("not told from: {}", calibrate::textOf(*finding.mixed_with).name)
                               : std::string("not held: the marks tell little more than the tolerance");
  }
  const double U = 2.0 * scale * finding.sigma;
  // As many digits as U has, which has two.
  const int digits = U > 0.0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(U))), 0, 9) : 9;
  return fmt::format(
      "<tr><td>{}<td class=num>{:+.{}f}<td class=num>{:.{}f}<td class=num>{:.2g}<td>{}<td "
      "class=words>{}</tr>",
      report::escapeHtml(text.name), scale * finding.value, digits, U, digits,
      2.0 * scale * finding.prior_sigma, report::escapeHtml(angle ? "mrad" : text.unit),
      report::escapeHtml(words));
}

std::string parameterTable(const calibrate::HeadFit& fit, bool held) {
  std::string html =
      "<table><thead><tr><th>Departure from the drawing<th class=num>Value<th class=num>± U (k = 2)<th "
      "class=num>Tolerance before<th>Unit<th>What the marks say</tr></thead><tbody>";
  for (const calibrate::HeadParameterFinding& finding : fit.parameters())
    if (finding.held == held) html += parameterRow(finding);
  return html + "</tbody></table>";
}

std::string parameters(const calibrate::HeadFit& fit) {
  const auto held = static_cast<std::size_t>(
      std::ranges::count_if(fit.parameters(), &calibrate::HeadParameterFinding::held));
  std::string html;
  if (held > 0) html = parameterTable(fit, true);
  html += fmt::format(
      "<details><summary>{} of {} that the marks do not hold</summary>{}</details><p class=note>Held: known "
      "to less "
      "than a third of its tolerance. What is not held is one of several explanations of the same marks; the "
      "table is "
      "as good as stated all the same, the value alone is not.",
      fit.parameters().size() - held, fit.parameters().size(), parameterTable(fit, false));
  html += fmt::format(" Marks scatter by {:.2f} of what was stated of them{}.", fit.noiseRatio(),
                      fit.noiseScaled() ? "; all uncertainties were raised by that" : "");
  if (const auto& surface = fit.surface())
    html += fmt::format(" Over the model lies a smooth surface of degree {}.", surface->basis.degree());
  return html + "</p>";
}

std::string files(const HeadFacts& facts) {
  std::string html;
  for (const HeadFile& file : facts.files) {
    const std::string path = report::escapeHtml(file.path);
    const bool beside = !std::filesystem::path(file.path).is_absolute();
    const std::string shown =
        beside ? fmt::format("<a href='{0}'>{0}</a>", path) : fmt::format("<code>{}</code>", path);
    html += fmt::format("<tr><td>{}<td>{}</tr>", shown, report::escapeHtml(file.what));
  }
  return html.empty() ? html : "<table><tbody>" + html + "</tbody></table>";
}

std::string made(const HeadPlan& plan, const HeadFacts& facts) {
  return "<table><tbody>" + report::htmlRow("Repeat with", facts.command, true) +
         report::htmlRow("Machine", facts.machine) + report::htmlRow("Pictures", facts.source) +
         report::htmlRow("Grids", fmt::format("{}", fmt::join(plan.grids, ", "))) +
         report::htmlRow("Places that verify", std::to_string(plan.verify)) +
         report::htmlRow("Limit", fmt::format("{:g} mm", plan.limit_mm)) +
         report::htmlRow("Seed", std::to_string(plan.seed)) + report::htmlRow("Kerf camera", facts.camera) +
         report::htmlRow("Date", plan.date) + report::htmlRow("Kerfbench", facts.version) +
         "</tbody></table><p class=note>Same input, same bytes. docs/how-to/calibrate-a-head.md says how to "
         "read this "
         "page.</p>";
}

}  // namespace

std::string headHtml(const HeadCalibration& result, const HeadPlan& plan, const HeadFacts& facts) {
  const HeadIteration& best = result.iterations.at(result.best);
  std::string page =
      report::htmlPageHead(fmt::format("{} – head of {}", result.verdictName(), facts.machine), kCss);
  page += header(result, plan, facts);
  page += report::htmlSection("The field", maps(result, plan, facts));
  page += report::htmlSection("What is left", residuals(result, plan));
  page += report::htmlSection("Iterations", iterations(result, plan));
  page += report::htmlSection("What the marks tell of the head", parameters(best.head.fit));
  page += report::htmlSection("Files", files(facts));
  page += report::htmlSection("How it was made", made(plan, facts));
  return page.append(report::kHtmlPageEnd);
}

}  // namespace kerfbench::head_service
