// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "hil/base/chart.h"
#include "hil/history/run_history.h"
#include "hil/report/html_text.h"

namespace kerfbench::history {
namespace {

using compare::Figure;
using report::escapeHtml;

constexpr std::size_t kNearest = 3;  // Checks in a line of a terminal.

/// Checks with a limit above zero that they must not exceed: their values are shares of it.
struct ShareOfLimit {
  std::string check;
  double value{}, u{}, limit{}, share{};
  std::string unit;
};

std::vector<ShareOfLimit> sharesOf(const compare::RunFigures& run) {
  std::vector<ShareOfLimit> shares;
  for (const Figure& figure : run.figures) {
    if (figure.of != Figure::Of::kCheck || figure.better != compare::Better::kSmaller || figure.sigma == 0.0)
      continue;
    const compare::CheckVerdict& check = run.checks.at(figure.place);
    if (!(check.limit > 0.0)) continue;
    shares.push_back({figure.place, figure.value, 2.0 * figure.sigma, check.limit, figure.value / check.limit,
                      figure.unit});
  }
  std::ranges::stable_sort(shares, std::greater<>(), &ShareOfLimit::share);
  return shares;
}

std::string failing(const compare::RunFigures& run) {
  std::string names;
  for (const auto& [name, check] : run.checks) {
    if (check.verdict != "PASS")
      names += fmt::format("{}{} {}", names.empty() ? "" : ", ", name, check.verdict);
  }
  return names;
}

std::string shortSum(const std::string& sum) { return sum.empty() ? "-" : sum.substr(0, 8); }

std::string row(const HistoryRow& r) {
  std::string near;
  const std::vector<ShareOfLimit> shares = sharesOf(r.figures);
  for (std::size_t i = 0; i < std::min(kNearest, shares.size()); ++i) {
    near += fmt::format("{}{} {:.4f} ± {:.4f} {} of {}", near.empty() ? "" : "; ", shares[i].check,
                        shares[i].value, shares[i].u, shares[i].unit, shares[i].limit);
  }
  const std::string bad = failing(r.figures);
  return bad.empty() ? near : bad + "; " + near;
}

/// A plot of each check that at least two runs measured.
std::string plots(const std::vector<HistoryRow>& rows) {
  struct Trend {
    std::vector<Eigen::Vector2d> value, upper, lower, limit;
    std::string unit;
  };
  std::map<std::string, Trend> trends;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto number = static_cast<double>(i + 1);
    for (const ShareOfLimit& s : sharesOf(rows[i].figures)) {
      Trend& trend = trends[s.check];
      trend.unit = s.unit;
      trend.value.emplace_back(number, s.value);
      trend.upper.emplace_back(number, s.value + s.u);
      trend.lower.emplace_back(number, s.value - s.u);
      trend.limit.emplace_back(number, s.limit);
    }
  }
  std::string html;
  for (auto& [check, trend] : trends) {
    if (trend.value.size() < 2) continue;
    base::Chart chart;
    chart.title = check;
    chart.x_name = "run";
    chart.y_name = trend.unit.empty() ? check : trend.unit;
    chart.curves = {{"value", {trend.value}},
                    {"value + U", {trend.upper}, true},
                    {"value - U", {trend.lower}, true},
                    {"limit", {trend.limit}}};
    html += "<figure>" + base::svgOf(chart) + "</figure>\n";
  }
  return html;
}

}  // namespace

std::vector<std::string> historyLines(const std::vector<HistoryRow>& rows) {
  std::vector<std::string> lines;
  for (const HistoryRow& r : rows) {
    const std::string& serial = r.figures.serial_number;
    lines.push_back(fmt::format("{}  {:<10}  firmware {}  seed {}  digest {}  {}{}", r.run.date,
                                r.figures.verdict, shortSum(r.figures.firmware_sha256), r.figures.seed,
                                shortSum(r.figures.digest),
                                serial.empty() ? "" : fmt::format("serial number {}  ", serial), row(r)));
  }
  return lines;
}

std::string historyPage(const std::vector<HistoryRow>& rows) {
  const std::string scenario = rows.empty() ? std::string() : rows.front().figures.scenario;
  std::string html = report::htmlPageHead(scenario + ": its runs");
  html += fmt::format("<h1>{}: its runs</h1>\n", escapeHtml(scenario));
  html +=
      "<table><thead><tr><th>run</th><th>date "
      "(UTC)</th><th>verdict</th><th>serial number</th><th>firmware</th><th>seed</th><th>nearest to their "
      "limits</th></tr></thead><tbody>\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const HistoryRow& r = rows[i];
    html += fmt::format(
        "<tr><td>{}</td><td><a href=\"{}/report.html\">{}</a></td><td>{}</td><td>{}</td><td>{} "
        "<code>{}</code></td><td>{}</td><td>{}</td></tr>\n",
        i + 1, escapeHtml(r.run.folder.filename().string()), r.run.date, escapeHtml(r.figures.verdict),
        escapeHtml(r.figures.serial_number), escapeHtml(r.figures.firmware),
        shortSum(r.figures.firmware_sha256), r.figures.seed, escapeHtml(row(r)));
  }
  html += "</tbody></table>\n" + report::htmlSection("Checks over the runs", plots(rows));
  html += report::kHtmlPageEnd;
  return html;
}

}  // namespace kerfbench::history
