// SPDX-License-Identifier: Apache-2.0
// The table of entities, the worst first.
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/report/html_text.h"

namespace kerfbench::report {
namespace {

constexpr std::size_t kMaxEntityRows = 300;

/// How far off an entity is, in units of what is allowed.
double badnessOf(const RunReport& report, const inspect::EntityResult& e) {
  const double offset = std::isfinite(e.worst_mm) ? std::abs(e.worst_mm) / report.limits.path_mm : 0.0;
  return std::max(offset, 10.0 * (1.0 - e.coverage));
}

std::string number(double value, double scale, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", scale * value, digits) : std::string("–");
}
std::string entityWithU(double value, double U) {
  return std::isfinite(value) ? number(value, 1e3, 1) + " ± " + number(U, 1e3, 1) : std::string("–");
}

/// Links to where else the page shows this entity.
std::string whereShown(const RunReport& report, const inspect::EntityResult& e) {
  std::string html;
  for (std::size_t i = 0; i < report.kerf.patches.size(); ++i) {
    const vision::KerfPatch& patch = report.kerf.patches[i];
    if (patch.unit == e.unit && patch.entity == e.entity)
      html += fmt::format(" <a href='#place-{0}'>place {0}</a>", i + 1);
  }
  for (const inspect::Check& check : report.result.checks) {
    if (check.verdict != inspect::Verdict::kPass && check.where.unit == e.unit &&
        check.where.entity == e.entity)
      html += fmt::format(" <a href='#check-{0}'>{0}</a>", escapeHtml(check.name));
  }
  return html;
}

std::string entityRow(const RunReport& report, const inspect::EntityResult& e) {
  const auto index = static_cast<std::size_t>(e.entity);
  const dieline::Entity* entity =
      index < report.dieline->entities.size() ? &report.dieline->entities[index] : nullptr;
  const bool uncut = entity != nullptr && entity->process != dieline::Process::kPerforation &&
                     e.uncut_mm > report.limits.uncut_mm;
  return fmt::format(
      "<tr id='{}'><th scope=row>unit {}, E{}{}<td>{}<td>{} <small>{}</small><td class='num{}'>{}<td "
      "class=num>{}<td class='num{}'>{}<td class=num>{}<td class=num>{}<td class='num{}'>{}</tr>",
      entityAnchor(e.unit, e.entity), e.unit, e.entity, whereShown(report, e),
      entity != nullptr ? dieline::processName(entity->process) : "",
      entity != nullptr ? escapeHtml(entity->origin) : std::string(),
      entity != nullptr ? escapeHtml(entity->layer) : std::string(),
      std::abs(e.worst_mm) > report.limits.path_mm ? " hit" : "", entityWithU(e.worst_mm, e.worst_U_mm),
      entityWithU(e.rms_mm, e.rms_U_mm), uncut ? " hit" : "", number(e.coverage, 100.0, 1),
      entityWithU(e.width_mm, e.width_U_mm), entityWithU(e.circularity_mm, e.circularity_U_mm),
      e.passes > report.limits.passes ? " hit" : "", number(e.passes, 1.0, 2));
}

}  // namespace

std::string entityAnchor(int unit, int entity) { return fmt::format("e-{}-{}", unit, entity); }

bool hasEntityRow(const RunReport& report, int unit, int entity) {
  const auto& all = report.result.entities;
  const auto own = std::ranges::find_if(
      all, [&](const inspect::EntityResult& e) { return e.unit == unit && e.entity == entity; });
  if (own == all.end()) return false;
  if (all.size() <= kMaxEntityRows) return true;
  const double badness = badnessOf(report, *own);
  std::size_t before = 0;
  for (auto e = all.begin(); e != all.end(); ++e) {
    const double other = badnessOf(report, *e);
    if (other > badness || (other == badness && e < own)) ++before;
  }
  return before < kMaxEntityRows;
}

std::string entityTable(const RunReport& report) {
  if (report.result.entities.empty()) return {};
  std::vector<const inspect::EntityResult*> rows;
  for (const inspect::EntityResult& e : report.result.entities) rows.push_back(&e);
  std::stable_sort(rows.begin(), rows.end(), [&](const auto* a, const auto* b) {
    return badnessOf(report, *a) > badnessOf(report, *b);
  });
  std::string html =
      "<table class=sortable><thead><tr><th scope=col>Entity<th scope=col>Process<th scope=col>Origin<th "
      "scope=col class=num>Worst, µm<th scope=col class=num>RMS, µm<th scope=col class=num>Coverage, %<th "
      "scope=col class=num>Width, µm<th scope=col class=num>Circularity, µm<th scope=col "
      "class=num>Passes</tr></thead><tbody>";
  for (std::size_t i = 0; i < std::min(rows.size(), kMaxEntityRows); ++i) html += entityRow(report, *rows[i]);
  html = scrolled("Entities", html + "</tbody></table>");
  if (rows.size() > kMaxEntityRows) {
    html += fmt::format("<p class=note>The worst {} of {} entities; all are in verdict.json.</p>",
                        kMaxEntityRows, rows.size());
  }
  return html;
}

}  // namespace kerfbench::report
