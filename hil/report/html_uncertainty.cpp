// SPDX-License-Identifier: Apache-2.0
// Tables of what the measurement is worth: budgets, layers, corners and ends.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "hil/inspect/evidence/places.h"
#include "hil/report/html_text.h"

namespace kerfbench::report {
namespace {

constexpr std::size_t kMaxJoints = 40;

std::string um(double value_mm, int digits = 2) {
  return std::isfinite(value_mm) ? fmt::format("{:.{}f}", 1e3 * value_mm, digits) : std::string("–");
}

std::string withU(const inspect::Quantity& q) {
  return std::isfinite(q.value) ? um(q.value, 1) + " ± " + um(q.U, 1) : std::string("–");
}

std::string budgetTable(const inspect::UncertaintyBudget& b) {
  std::string html = fmt::format(
      "<h3>{}</h3><table><thead><tr><th>Where it comes from<th class=num>Standard uncertainty, µm<th "
      "class=num>Correction, µm</tr></thead><tbody>",
      escapeHtml(b.quantity));
  for (const inspect::BudgetEntry& e : b.entries) {
    html += fmt::format("<tr><td>{}<td class=num>{}<td class=num>{}</tr>", escapeHtml(e.source), um(e.u),
                        um(-e.correction));
  }
  return html +
         fmt::format(
             "<tr><td><b>Budget (JCGM 100): {} µm as read, corrected {} µm</b><td class=num><b>U = {}</b>"
             "<td></tr><tr><td><b>{} simulated measurements (JCGM 101): {} µm</b><td class=num><b>U = "
             "{}</b><td></tr></tbody></table>",
             um(b.as_read), um(b.analytic_value), um(b.analytic_U), b.draws, um(b.monte_carlo_value),
             um(b.monte_carlo_U));
}

std::string layerTable(const std::vector<inspect::LayerResult>& layers) {
  if (layers.empty()) return {};
  std::string html =
      "<h3>Deviation by layer</h3><table><thead><tr><th>Layer<th class=num>Worst, µm<th class=num>RMS, "
      "µm</tr></thead><tbody>";
  for (const inspect::LayerResult& l : layers) {
    html += fmt::format("<tr><td>{}<td class=num>{}<td class=num>{}</tr>", escapeHtml(l.layer),
                        withU(l.worst_mm), withU(l.rms_mm));
  }
  return html + "</tbody></table>";
}

std::string_view plainName(inspect::JointResult::Kind kind) {
  switch (kind) {
    case inspect::JointResult::Kind::kCorner:
      return "corner off the dieline by";
    case inspect::JointResult::Kind::kRounding:
      return "corner rounded off by";
    case inspect::JointResult::Kind::kOvershoot:
      return "corner overshot by";
    case inspect::JointResult::Kind::kEndGap:
      return "line short of its end by";
    case inspect::JointResult::Kind::kClosure:
      break;
  }
  return "closed line open by";
}

std::string jointTable(const std::vector<inspect::JointResult>& joints) {
  std::vector<const inspect::JointResult*> rows;
  for (const inspect::JointResult& j : joints) {
    if (std::isfinite(j.mm.value)) rows.push_back(&j);
  }
  if (rows.empty()) return {};
  std::stable_sort(rows.begin(), rows.end(),
                   [](const inspect::JointResult* a, const inspect::JointResult* b) {
                     return std::abs(a->mm.value) > std::abs(b->mm.value);
                   });
  std::string html =
      "<h3>Corners and ends</h3><table><thead><tr><th>What<th>Where<th class=num>µm</tr></thead><tbody>";
  for (std::size_t i = 0; i < std::min(rows.size(), kMaxJoints); ++i) {
    const inspect::JointResult& j = *rows[i];
    html +=
        fmt::format("<tr><td>{}<td>unit {}, E{}{} at {}<td class=num>{}</tr>", plainName(j.kind), j.unit,
                    j.entity, j.entity_out != j.entity ? fmt::format(" to E{}", j.entity_out) : std::string(),
                    inspect::checks::placeOf(j.p_S_mm), withU(j.mm));
  }
  html += "</tbody></table>";
  if (rows.size() > kMaxJoints) {
    html +=
        fmt::format("<p class=note>The largest {} of {}; all are in verdict.json. Overlaps are negative.</p>",
                    kMaxJoints, rows.size());
  }
  return html;
}

}  // namespace

std::string uncertaintySection(const RunReport& report) {
  std::string html;
  for (const inspect::UncertaintyBudget& b : report.result.budgets) html += budgetTable(b);
  html += layerTable(report.result.layers);
  html += jointTable(report.result.joints);
  if (html.empty()) return {};
  return html +
         "<p class=note>± and U are expanded uncertainties (k = 2): the truth lies inside in 95 of 100 "
         "cases.</p>";
}

}  // namespace kerfbench::report
