// SPDX-License-Identifier: Apache-2.0
#include "hil/compare/write_comparison.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/base/atomic_file.h"
#include "hil/report/html_text.h"

namespace kerfbench::compare {
namespace {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;
using report::escapeHtml;

constexpr std::size_t kMostOfAQuantity = 3;  // Lines of a terminal for cuts that all tell the same.

std::string kindName(Figure::Of of) {
  constexpr std::array<const char*, 4> kNames{"check", "entity", "cut", "joint"};
  return kNames.at(static_cast<std::size_t>(of));
}

std::string withUnit(double value, const std::string& unit) {
  return fmt::format("{:.4f}{}{}", value + 0.0, unit.empty() ? "" : " ", unit);
}

std::string judgementOf(const Difference& d) {
  if (d.worse) return "worse";
  if (d.better) return "better";
  if (d.significant) return "differs";
  return d.u == 0.0 && d.difference != 0.0 ? "differs, no uncertainty is stated" : "";
}

std::string titleOf(const Difference& d) {
  return d.of == Figure::Of::kCheck ? "check " + d.place
                                    : fmt::format("{} {} of {}", kindName(d.of), d.quantity, d.place);
}

std::string lineOf(const Difference& d) {
  return fmt::format("  {:<8} {}: {} -> {}, by {:+.4f} ± {:.4f} {}", judgementOf(d), titleOf(d),
                     withUnit(d.old_value, d.unit), withUnit(d.new_value, d.unit), d.difference, d.u, d.unit);
}

std::string lineOf(const VerdictChange& change) {
  return fmt::format("  {:<8} check {}: {} -> {}{}", change.worse ? "worse" : "verdict", change.check,
                     change.old_verdict, change.new_verdict, change.why.empty() ? "" : ": " + change.why);
}

std::string describe(const RunSet& release) {
  const RunFigures& run = release.runs.front();
  std::string seeds;
  for (const RunFigures& r : release.runs) seeds += fmt::format("{}{}", seeds.empty() ? "" : ", ", r.seed);
  return fmt::format("{}: {}, sha256 {}, seed{} {}", release.name, run.firmware,
                     run.firmware_sha256.substr(0, 12), release.runs.size() == 1 ? "" : "s", seeds);
}

OrderedJson releaseJson(const RunSet& release) {
  OrderedJson runs = OrderedJson::array();
  for (const RunFigures& run : release.runs) {
    runs.push_back({{"folder", run.folder.string()},
                    {"verdict", run.verdict},
                    {"seed", run.seed},
                    {"digest", run.digest},
                    {"inputs_digest", run.inputs_digest}});
  }
  const RunFigures& run = release.runs.front();
  return {{"name", release.name},
          {"firmware", run.firmware},
          {"firmware_sha256", run.firmware_sha256},
          {"firmware_version", run.firmware_version},
          {"kerfbench", run.bench_version},
          {"runs", runs}};
}

double rounded(double value) { return std::round(value * 1e6) / 1e6 + 0.0; }

OrderedJson differenceJson(const Difference& d) {
  return {{"of", kindName(d.of)},
          {"place", d.place},
          {"quantity", d.quantity},
          {"unit", d.unit},
          {"old", rounded(d.old_value)},
          {"new", rounded(d.new_value)},
          {"difference", rounded(d.difference)},
          {"U", rounded(d.u)},
          {"z", std::round(d.z * 100.0) / 100.0},
          {"significant", d.significant},
          {"worse", d.worse},
          {"better", d.better}};
}

std::string rowOf(const Difference& d) {
  const char* row_class = d.worse ? " class=\"fail\"" : d.better ? " class=\"pass\"" : "";
  return fmt::format(
      "<tr{}><td>{}</td><td>{}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td "
      "class=\"n\">{:+.4f} ± {:.4f}</td><td>{}</td></tr>\n",
      row_class, kindName(d.of), escapeHtml(d.place), escapeHtml(d.quantity),
      escapeHtml(withUnit(d.old_value, d.unit)), escapeHtml(withUnit(d.new_value, d.unit)),
      d.difference + 0.0, d.u, judgementOf(d));
}

template <typename Wanted>
std::string tableOf(const Comparison& comparison, const Wanted& wanted) {
  std::string rows;
  for (const Difference& d : comparison.differences)
    if (wanted(d)) rows += rowOf(d);
  if (rows.empty()) return {};
  return "<table><thead><tr><th>of</th><th>where</th><th>figure</th><th>old</th><th>new</th><th>new − old ± "
         "U</th><th></th></tr></thead><tbody>\n" +
         rows + "</tbody></table>\n";
}

std::string verdictTable(const Comparison& comparison) {
  if (comparison.verdicts.empty()) return {};
  std::string html =
      "<table><thead><tr><th>check</th><th>old</th><th>new</th><th></th></tr></thead><tbody>\n";
  for (const VerdictChange& change : comparison.verdicts) {
    html += fmt::format("<tr{}><td>{}</td><td>{}</td><td>{}</td><td>{}{}</td></tr>\n",
                        change.worse ? " class=\"fail\"" : "", escapeHtml(change.check),
                        escapeHtml(change.old_verdict), escapeHtml(change.new_verdict),
                        change.worse ? "worse. " : "", escapeHtml(change.why));
  }
  return html + "</tbody></table>\n";
}

std::string list(const std::vector<std::string>& items) {
  std::string html;
  for (const std::string& item : items) html += "<li>" + escapeHtml(item) + "</li>\n";
  return html.empty() ? html : "<ul>" + html + "</ul>\n";
}

std::string figuresOfOne(const Comparison& comparison) {
  return list(comparison.only_old).empty() && comparison.only_new.empty()
             ? std::string()
             : (comparison.only_old.empty()
                    ? std::string()
                    : "<p>Only the old release has:</p>" + list(comparison.only_old)) +
                   (comparison.only_new.empty()
                        ? std::string()
                        : "<p>Only the new release has:</p>" + list(comparison.only_new));
}

}  // namespace

std::string comparisonSummary(const Comparison& comparison) {
  const auto count = [&](bool Difference::*which) {
    return std::ranges::count_if(comparison.differences, which);
  };
  const auto worse = count(&Difference::worse), better = count(&Difference::better),
             all = count(&Difference::significant);
  const auto verdicts = std::ranges::count_if(comparison.verdicts, &VerdictChange::worse);
  const auto same = static_cast<long>(comparison.differences.size()) - all;
  if (!comparison.told_apart)
    return fmt::format("no figure is held against the release: {}", comparison.cautions.back());
  return fmt::format(
      "{} figure{} worse, {} better, {} otherwise different, {} the same within U; {} verdict{} worse", worse,
      worse == 1 ? "" : "s", better, all - worse - better, same, verdicts, verdicts == 1 ? "" : "s");
}

std::vector<std::string> comparisonLines(const ComparedReleases& compared) {
  const Comparison& comparison = compared.comparison;
  std::vector<std::string> lines{"old  " + describe(compared.old_release),
                                 "new  " + describe(compared.new_release)};
  for (const std::string& caution : comparison.cautions) lines.push_back("  note     " + caution);
  for (const VerdictChange& change : comparison.verdicts) lines.push_back(lineOf(change));
  std::map<std::pair<Figure::Of, std::string>, std::size_t> told;
  for (const Difference& d : comparison.differences)
    if (d.significant && d.of == Figure::Of::kCheck) lines.push_back(lineOf(d));
  for (const Difference& d : comparison.differences) {
    if (d.significant && d.of != Figure::Of::kCheck && ++told[{d.of, d.quantity}] <= kMostOfAQuantity)
      lines.push_back(lineOf(d));
  }
  for (const auto& [quantity, count] : told) {
    if (count > kMostOfAQuantity)
      lines.push_back(fmt::format("           and {} more of {} {}", count - kMostOfAQuantity,
                                  kindName(quantity.first), quantity.second));
  }
  lines.push_back(comparisonSummary(comparison));
  return lines;
}

std::string comparisonJson(const ComparedReleases& compared) {
  const Comparison& comparison = compared.comparison;
  OrderedJson json{{"schema_version", 1},
                   {"scenario", compared.old_release.runs.front().scenario},
                   {"worse", comparison.anythingWorse()},
                   {"summary", comparisonSummary(comparison)},
                   {"old", releaseJson(compared.old_release)},
                   {"new", releaseJson(compared.new_release)},
                   {"cautions", comparison.cautions},
                   {"threshold_z", std::round(comparison.threshold_z * 1000.0) / 1000.0},
                   {"told_apart", comparison.told_apart}};
  OrderedJson verdicts = OrderedJson::array();
  for (const VerdictChange& change : comparison.verdicts) {
    verdicts.push_back({{"check", change.check},
                        {"old", change.old_verdict},
                        {"new", change.new_verdict},
                        {"why", change.why},
                        {"worse", change.worse}});
  }
  json["verdicts"] = verdicts;
  json["differences"] = OrderedJson::array();
  for (const Difference& d : comparison.differences) json["differences"].push_back(differenceJson(d));
  json["only_old"] = comparison.only_old;
  json["only_new"] = comparison.only_new;
  return json.dump(2, ' ', false, decltype(json)::error_handler_t::replace) + "\n";
}

std::string comparisonPage(const ComparedReleases& compared) {
  const Comparison& comparison = compared.comparison;
  const std::string& scenario = compared.old_release.runs.front().scenario;
  std::string html = report::htmlPageHead(scenario + ": two releases");
  html +=
      fmt::format("<h1>{}: two releases</h1>\n<p class=\"verdict {}\">{}</p>\n", escapeHtml(scenario),
                  comparison.anythingWorse() ? "fail" : "pass", escapeHtml(comparisonSummary(comparison)));
  html += "<table>" + report::htmlRow("Old", describe(compared.old_release)) +
          report::htmlRow("New", describe(compared.new_release)) + "</table>\n";
  html += list(comparison.cautions);
  html += report::htmlSection("Verdicts that changed", verdictTable(comparison));
  html += report::htmlSection("Figures that differ significantly",
                              tableOf(comparison, [](const Difference& d) { return d.significant; }));
  html += report::htmlSection(
      "How it is judged",
      fmt::format("<p>U is the expanded uncertainty (k = 2) of the difference: both measurements', or the "
                  "spread of runs where that is "
                  "known and larger. A figure differs significantly if the difference is beyond {:.2f} "
                  "standard uncertainties: all "
                  "{} figures together then raise a false alarm in {:.1f} % of comparisons of one and the "
                  "same release.</p>",
                  comparison.threshold_z, comparison.differences.size(), 100.0 * kFalseAlarms));
  html += report::htmlSection(
      "Checks", tableOf(comparison, [](const Difference& d) { return d.of == Figure::Of::kCheck; }));
  html += "<details><summary>All other figures</summary>\n" +
          tableOf(comparison, [](const Difference& d) { return d.of != Figure::Of::kCheck; }) +
          figuresOfOne(comparison) + "</details>\n";
  html += report::kHtmlPageEnd;
  return html;
}

void writeComparison(const ComparedReleases& compared, const fs::path& folder) {
  fs::create_directories(folder);
  base::writeFileAtomically(folder / "compare.html", comparisonPage(compared));
  base::writeFileAtomically(folder / "compare.json", comparisonJson(compared));
}

}  // namespace kerfbench::compare
