// SPDX-License-Identifier: Apache-2.0
// The page of a campaign.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "hil/base/number_from.h"
#include "hil/campaign/analysis.h"
#include "hil/campaign/analysis_words.h"
#include "hil/campaign/merge.h"
#include "hil/report/html_text.h"
#include "hil/report/plot.h"

namespace kerfbench::campaign {
namespace {

using report::escapeHtml;
using report::Plot;

constexpr std::size_t kMostRows = 100;
constexpr std::size_t kMostMarginPlots = 6;
constexpr std::size_t kBins = 8;
constexpr int kCurvePoints = 120;
constexpr double kThin = 0.1;  // A margin below this is shown in red.
constexpr double kMostLabels = 14.0;
constexpr std::size_t kMostDots = 3000;

constexpr std::string_view kCss =
    ".err{stroke:var(--acc);stroke-width:2}.mark{fill:var(--acc)}.curve{fill:none;stroke:var(--fg);stroke-"
    "width:1.6}"
    ".span{stroke:var(--np);stroke-width:5;stroke-linecap:butt;opacity:.7}.miss{stroke:var(--nom)}.hitdot{"
    "stroke:var(--fail)}"
    ".plot .at{stroke:var(--np);stroke-dasharray:3 3}";

std::string percent(const std::optional<base::Interval>& interval, const Outcomes& o) {
  if (!interval) return "–";
  return fmt::format("{:.1f} %<td class=num>{:.1f} … {:.1f} %",
                     100.0 * static_cast<double>(o.pass) / static_cast<double>(o.judged()),
                     100.0 * interval->low, 100.0 * interval->high);
}

std::string rateTable(const FactorRates& rates) {
  std::string html = fmt::format(
      "<table><thead><tr><th>{}<th class=num>runs<th class=num>PASS<th class=num>FAIL<th class=num>NOT "
      "PROVEN<th "
      "class=num>INVALID<th class=num>refused<th class=num>broken<th class=num>pass rate<th class=num>95 "
      "%</tr></thead><tbody>",
      escapeHtml(rates.factor));
  for (const RateRow& row : rates.rows) {
    const Outcomes& o = row.outcomes;
    html += fmt::format(
        "<tr><td>{}<td class=num>{}<td class=num>{}<td class=num>{}<td class=num>{}<td class=num>{}<td "
        "class=num>{}<td class=num>{}<td class=num>{}</tr>",
        escapeHtml(row.value.empty() ? "–" : row.value), o.all(), o.pass, o.fail, o.not_proven, o.invalid,
        o.refused, o.broken, row.pass_rate ? percent(row.pass_rate, o) : "–<td class=num>–");
  }
  return html + "</tbody></table>";
}

/// A point with its interval at each value of a factor.
std::string ratePlot(const FactorRates& rates) {
  const auto count = static_cast<double>(rates.rows.size());
  if (rates.rows.size() < 2 || count > kMostLabels) return {};
  Plot plot(0.0, count, 0.0, 100.0, "Pass rate over " + rates.factor);
  plot.yTicks({0.0, 25.0, 50.0, 75.0, 100.0}, "{:g} %");
  for (std::size_t i = 0; i < rates.rows.size(); ++i) {
    const RateRow& row = rates.rows[i];
    const double x = plot.x(static_cast<double>(i) + 0.5);
    const std::size_t letters = std::max<std::size_t>(4, static_cast<std::size_t>(70.0 / count));
    plot.raw(
        fmt::format("<text class=tick x={:.1f} y={:.0f} text-anchor=middle>{}</text>", x, Plot::kH + 13.0,
                    escapeHtml(row.value.size() > letters ? row.value.substr(0, letters) + "…" : row.value)));
    if (!row.pass_rate) continue;
    const double rate =
        100.0 * static_cast<double>(row.outcomes.pass) / static_cast<double>(row.outcomes.judged());
    plot.raw(fmt::format(
        "<line class=err x1={0:.1f} x2={0:.1f} y1={1:.1f} y2={2:.1f} /><circle class=mark cx={0:.1f} "
        "cy={3:.1f} r=3.5 />",
        x, plot.y(100.0 * row.pass_rate->low), plot.y(100.0 * row.pass_rate->high), plot.y(rate)));
  }
  return plot.figure(
      fmt::format("Pass rate over <b>{}</b>, with its exact 95 % interval (Clopper and Pearson).",
                  escapeHtml(rates.factor)));
}

std::string ratesSection(const Analysis& a) {
  std::string tables, plots;
  for (const FactorRates& rates : a.rates) {
    tables += rateTable(rates);
    plots += ratePlot(rates);
  }
  if (tables.empty()) return {};
  return (plots.empty() ? "" : "<div class=figs>" + plots + "</div>") + tables +
         "<p class=note>Pass rate: PASS among the runs that have a verdict. Each row counts all runs with "
         "that "
         "value, whatever the other factors were.</p>";
}

/// Scale of sizes: from a size to its place, 0 … 1, in a plot.
struct SizeAxis {
  bool logarithmic{};
  double from{}, to{};

  [[nodiscard]] double at(double size) const { return logarithmic ? std::log10(size) : size; }
  [[nodiscard]] double sizeAt(double x) const { return logarithmic ? std::pow(10.0, x) : x; }
};

SizeAxis axisOf(const std::vector<Trial>& trials, bool logarithmic) {
  SizeAxis axis{.logarithmic = logarithmic};
  const auto [least, most] = std::ranges::minmax_element(trials, {}, &Trial::size);
  axis.from = axis.at(least->size);
  axis.to = axis.at(most->size);
  const double room = axis.to > axis.from ? 0.04 * (axis.to - axis.from) : 1.0;
  axis.from -= room;
  axis.to += room;
  return axis;
}

void addSizeTicks(Plot& plot, const SizeAxis& axis) {
  if (!axis.logarithmic) {
    plot.xTicks(report::ticks(axis.from, axis.to), "size of the fault");
    return;
  }
  plot.xTicks({}, "size of the fault");
  const bool fine = axis.to - axis.from < 2.5;
  for (int decade = static_cast<int>(std::floor(axis.from)); decade <= static_cast<int>(std::ceil(axis.to));
       ++decade) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double x = decade + std::log10(digit);
      if (x < axis.from || x > axis.to || (digit > 1.0 && !fine)) continue;
      plot.raw(
          fmt::format("<line class=grid x1={0:.1f} x2={0:.1f} y1=0 y2={1:.0f} /><text class=tick x={0:.1f} "
                      "y={2:.0f} text-anchor=middle>{3:g}</text>",
                      plot.x(x), Plot::kH, Plot::kH + 13.0, digit * std::pow(10.0, decade)));
    }
  }
}

/// The share that was found among trials of like size, with its interval, and a dot for each trial at the
/// rim.
void addTrials(Plot& plot, const SizeAxis& axis, std::vector<Trial> trials) {
  std::ranges::stable_sort(trials, {}, &Trial::size);
  std::string found, missed;
  for (std::size_t i = 0; i < trials.size(); i += trials.size() / kMostDots + 1) {
    const Trial& t = trials[i];
    fmt::format_to(std::back_inserter(t.found ? found : missed), "M{:.1f} {:.1f}h0", plot.x(axis.at(t.size)),
                   plot.y(t.found ? 100.0 : 0.0));
  }
  plot.raw(fmt::format("<path class='dots hitdot' d='{}'/><path class='dots miss' d='{}'/>", found, missed));
  const std::size_t bins = std::min(kBins, trials.size());
  for (std::size_t b = 0; b < bins; ++b) {
    const std::size_t begin = trials.size() * b / bins, end = trials.size() * (b + 1) / bins;
    double x = 0.0;
    std::size_t hits = 0;
    for (std::size_t i = begin; i < end; ++i) {
      x += axis.at(trials[i].size) / static_cast<double>(end - begin);
      hits += trials[i].found ? 1 : 0;
    }
    const base::Interval interval = base::clopperPearson(hits, end - begin);
    plot.raw(fmt::format(
        "<line class=err x1={0:.1f} x2={0:.1f} y1={1:.1f} y2={2:.1f} /><circle class=mark cx={0:.1f} "
        "cy={3:.1f} r=3 />",
        plot.x(x), plot.y(100.0 * interval.low), plot.y(100.0 * interval.high),
        plot.y(100.0 * static_cast<double>(hits) / static_cast<double>(end - begin))));
  }
}

void addFit(Plot& plot, const SizeAxis& axis, const Detection& d) {
  std::string curve;
  for (int i = 0; i <= kCurvePoints; ++i) {
    const double x = axis.from + (axis.to - axis.from) * i / kCurvePoints;
    fmt::format_to(std::back_inserter(curve), "{}{:.1f} {:.1f}", i == 0 ? "M" : "L", plot.x(x),
                   plot.y(100.0 * d.chanceAt(axis.sizeAt(x))));
  }
  plot.raw(fmt::format("<path class=curve d='{}'/>", curve));
  const auto span = [&](const SizeEstimate& e, double level) {
    const double low = e.low ? axis.at(*e.low) : axis.from, high = e.high ? axis.at(*e.high) : axis.to;
    plot.raw(fmt::format("<line class=span x1={:.1f} x2={:.1f} y1={:.1f} y2={:.1f} />", plot.x(low),
                         plot.x(high), plot.y(level), plot.y(level)));
  };
  span(d.fit->half, 50.0);
  span(d.fit->most, 90.0);
}

std::string detectionPlot(const FaultDetection& d, const Detection& detection,
                          const std::vector<Trial>& trials, const char* found_is) {
  if (trials.empty()) return {};
  const SizeAxis axis = axisOf(trials, detection.logarithmic);
  Plot plot(axis.from, axis.to, 0.0, 100.0, "Share found over size");
  addSizeTicks(plot, axis);
  plot.yTicks({0.0, 50.0, 90.0, 100.0}, "{:g} %");
  addTrials(plot, axis, trials);
  if (detection.fit) {
    addFit(plot, axis, detection);
  } else if (detection.largest_missed && detection.smallest_found) {
    plot.vertical(axis.at(*detection.largest_missed), "at");
    plot.vertical(axis.at(*detection.smallest_found), "at");
  }
  return plot.figure(fmt::format("<b>{}</b> in {}: {} ({} of {}); {}.", escapeHtml(d.fault),
                                 escapeHtml(d.base), found_is, detection.found, detection.trials,
                                 escapeHtml(detectionWords(detection))));
}

std::string detectionSection(const Analysis& a) {
  std::string plots;
  for (const FaultDetection& d : a.detections) {
    plots += detectionPlot(d, d.by_fail, d.fails, "found is FAIL");
    plots += detectionPlot(d, d.by_no_pass, d.no_passes, "found is whatever does not pass");
  }
  if (plots.empty()) return {};
  return "<div class=figs>" + plots +
         "</div><p class=note>Curve: logistic, by maximum likelihood. Bars on it: sizes that are found with "
         "a chance of "
         "50 and 90 %, with 95 % intervals by profile likelihood. Points: eight groups of like size with "
         "exact 95 % "
         "intervals; dots at the rims: the runs. Where one size parts what was found from what was missed no "
         "curve "
         "can be fitted: the dashed lines are the largest that was missed and the smallest that was "
         "found.</p>";
}

std::string marginTable(const Analysis& a) {
  std::string html =
      "<table><thead><tr><th>check<th class=num>runs<th class=num>least margin<th "
      "class=num>median<th>thinnest: value ± "
      "U, limit<th class=num>run</tr></thead><tbody>";
  for (const CheckMargin& m : a.margins)
    html += fmt::format(
        "<tr><td>{}<td class=num>{}<td class='num{}'>{:.1f} %<td class=num>{:.1f} %<td>{}<td "
        "class=num>{}</tr>",
        escapeHtml(m.check), m.runs, m.least < kThin ? " hit" : "", 100.0 * m.least, 100.0 * m.median,
        escapeHtml(marginWords(m)), m.thinnest_run);
  return html + "</tbody></table>";
}

/// Margin of a check over a factor whose values are numbers.
std::string marginPlot(const CheckMargin& m, const std::string& factor,
                       const std::map<std::size_t, double>& value_of) {
  std::vector<std::pair<double, double>> points;
  for (std::size_t i = 0; i < m.margins.size(); ++i)
    if (const auto found = value_of.find(m.at[i]); found != value_of.end())
      points.emplace_back(found->second, m.margins[i]);
  if (points.size() < 3) return {};
  const auto [left, right] = std::ranges::minmax(points, {}, &std::pair<double, double>::first);
  if (left.first >= right.first) return {};
  const double low = std::min(0.0, 1.1 * m.least);
  Plot plot(left.first, right.first, 100.0 * low, 100.0, m.check + " over " + factor);
  plot.xTicks(report::ticks(left.first, right.first), factor);
  plot.yTicks(report::ticks(100.0 * low, 100.0), "{:g} %");
  plot.horizontal(0.0, "lim");
  std::string dots;
  for (std::size_t i = 0; i < points.size(); i += points.size() / kMostDots + 1)
    fmt::format_to(std::back_inserter(dots), "M{:.1f} {:.1f}h0", plot.x(points[i].first),
                   plot.y(100.0 * points[i].second));
  plot.raw(fmt::format("<path class=dots d='{}'/>", dots));
  return plot.figure(fmt::format("Margin of <b>{}</b> over {}.", escapeHtml(m.check), escapeHtml(factor)));
}

/// Values of each factor in each run, where they are numbers; a fault's size is one as well.
std::map<std::string, std::map<std::size_t, double>> numbersOf(const std::vector<Record>& records) {
  std::map<std::string, std::map<std::size_t, double>> numbers;
  for (const Record& record : records)
    for (const FactorValue& f : record.factors) {
      if (f.size) {
        numbers["size of " + f.value][record.run] = *f.size;
      } else if (const auto number = base::numberFrom<double>(f.value)) {
        numbers[f.factor][record.run] = *number;
      }
    }
  return numbers;
}

std::string marginSection(const Analysis& a, const std::vector<Record>& records) {
  if (a.margins.empty()) return {};
  std::string plots;
  std::size_t drawn = 0;
  const auto numbers = numbersOf(records);
  for (const CheckMargin& m : a.margins)
    for (const auto& [factor, value_of] : numbers) {
      if (drawn == kMostMarginPlots) break;
      const std::string plot = marginPlot(m, factor, value_of);
      drawn += plot.empty() ? 0 : 1;
      plots += plot;
    }
  return marginTable(a) + (plots.empty() ? "" : "<div class=figs>" + plots + "</div>") +
         fmt::format(
             "<p class=note>{}. Margin: what value and U (k = 2) leave of the limit, as a share of it; below "
             "zero nothing "
             "is left. Checks with the limit zero have none.</p>",
             a.margins_of_good ? "Runs without a fault of a size, whatever their verdict"
                               : "Runs that passed");
}

std::string countSection(const Analysis& a) {
  if (a.counts.empty()) return {};
  std::string html =
      "<table><thead><tr><th>check<th class=num>FAIL<th class=num>NOT PROVEN<th "
      "class=num>INVALID</tr></thead><tbody>";
  for (const CheckCount& c : a.counts)
    html += fmt::format("<tr><td>{}<td class=num>{}<td class=num>{}<td class=num>{}</tr>",
                        escapeHtml(c.check), c.fail, c.not_proven, c.invalid);
  return html + "</tbody></table>";
}

/// Runs without a verdict, with the reason.
std::string reasonSection(const std::vector<Record>& records) {
  std::string rows;
  std::size_t count = 0;
  for (const Record& r : records) {
    if (r.reason.empty() || ++count > kMostRows) continue;
    rows += fmt::format("<tr><td class=num>{}<td>{}<td>{}</tr>", r.run, escapeHtml(r.outcome),
                        escapeHtml(r.reason));
  }
  if (rows.empty()) return {};
  return "<table><thead><tr><th class=num>run<th>outcome<th>reason</tr></thead><tbody>" + rows +
         "</tbody></table>" +
         (count > kMostRows ? fmt::format("<p class=note>And {} more.</p>", count - kMostRows) : "");
}

}  // namespace

std::string analysisPage(const Analysis& a, const std::vector<Record>& records) {
  const std::string title = a.title.empty() ? a.name : a.title;
  std::string html = report::htmlPageHead(title, kCss);
  html += fmt::format("<h1>{}</h1>\n<p>{}</p>\n", escapeHtml(title),
                      report::htmlFacts({{"Campaign", a.name},
                                         {"Runs", fmt::format("{}", a.runs)},
                                         {"Outcomes", outcomeWords(a.outcomes)},
                                         {"Digest of results.jsonl", a.digest}}));
  if (!a.missing.empty())
    html += fmt::format("<ul class=problems><li>Not all runs are there: {} are missing ({}).</ul>\n",
                        a.missing.size(), escapeHtml(rangesOf(a.missing)));
  html += report::htmlSection("Pass rate", ratesSection(a));
  html += report::htmlSection("Smallest fault found", detectionSection(a));
  html += report::htmlSection("Margins", marginSection(a, records));
  html += report::htmlSection("Checks that did not pass", countSection(a));
  html += report::htmlSection("Runs without a verdict", reasonSection(records));
  html +=
      "<p class=note>A run again by itself: <code>./bench run scenarios/NUMBER.yaml</code>, in this "
      "folder.</p>\n";
  html += report::kHtmlPageEnd;
  return html;
}

}  // namespace kerfbench::campaign
