// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "hil/gauge/gauge_report.h"
#include "hil/report/html_text.h"
#include "hil/report/plot.h"

namespace kerfbench::gauge {
namespace {

constexpr double kClass_mm = 0.01;  ///< Width of a class of sizes.
constexpr std::size_t kMostDots = 2500;

std::size_t classOf(double truth_mm) { return static_cast<std::size_t>(std::max(0.0, truth_mm) / kClass_mm); }

}  // namespace

std::string biasPlot(const std::vector<GaugePoint>& points, const std::optional<Linearity>& line) {
  if (points.empty()) return {};
  std::vector<double> magnitude;
  std::vector<std::vector<double>> widths;
  double most_mm = 1e-3;
  for (const GaugePoint& p : points) {
    magnitude.push_back(std::abs(p.value_mm - p.truth_mm));
    most_mm = std::max(most_mm, p.truth_mm);
    widths.resize(std::max(widths.size(), classOf(p.truth_mm) + 1));
    widths[classOf(p.truth_mm)].push_back(p.U_mm);
  }
  const double top = 1e3 * std::max(2.0 * quantileOf(magnitude, 0.95), 2e-4);
  report::Plot plot(0.0, 1e3 * most_mm, -top, top, "Error over true size");
  plot.xTicks(report::ticks(0.0, 1e3 * most_mm), "true deviation, µm");
  plot.yTicks(report::ticks(-top, top), "{:+g}");
  for (std::size_t i = 0; i < widths.size(); ++i) {
    if (widths[i].empty()) continue;
    const double U = 1e3 * quantileOf(widths[i], 0.5);
    const double from = plot.x(1e3 * kClass_mm * static_cast<double>(i));
    const double to = plot.x(1e3 * kClass_mm * static_cast<double>(i + 1));
    plot.raw(fmt::format("<rect class=band x={:.1f} y={:.1f} width={:.1f} height={:.1f} />", from, plot.y(U),
                         to - from, plot.y(-U) - plot.y(U)));
  }
  std::string in;
  std::string out;
  const std::size_t stride = points.size() / kMostDots + 1;
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const GaugePoint& p = points[i];
    const double error = p.value_mm - p.truth_mm;
    fmt::format_to(std::back_inserter(std::abs(error) <= p.U_mm ? in : out), "M{:.1f} {:.1f}h0",
                   plot.x(1e3 * p.truth_mm), plot.y(1e3 * error));
  }
  plot.raw(fmt::format("<path class=dots d='{}'/><path class='dots miss' d='{}'/>", in, out));
  plot.horizontal(0.0, "zero");
  std::string caption =
      "Error of each case over its true size; red: U does not cover it; at the rim: beyond. Band: median "
      "U.";
  if (line) {
    plot.raw(fmt::format("<line class=fit x1=0 x2={:.0f} y1={:.1f} y2={:.1f} />", report::Plot::kW,
                         plot.y(1e3 * line->offset), plot.y(1e3 * (line->offset + line->slope * most_mm))));
    caption += fmt::format(" Line: {:+.3f} µm {:+.4f} µm/µm (± {:.4f}).", 1e3 * line->offset, line->slope,
                           2.0 * line->slope_sigma);
  }
  return plot.figure(caption);
}

std::string zPlot(const std::vector<GaugePoint>& points) {
  if (points.empty()) return {};
  constexpr int kBins = 32;
  constexpr double kReach = 2.0;
  std::array<double, kBins> bins{};
  for (const GaugePoint& p : points) {
    if (!(p.U_mm > 0.0)) continue;
    const double z = std::clamp((p.value_mm - p.truth_mm) / p.U_mm, -kReach, kReach - 1e-9);
    bins.at(static_cast<std::size_t>((z + kReach) / (2.0 * kReach) * kBins)) +=
        1.0 / static_cast<double>(points.size());
  }
  constexpr double kStep = 2.0 * kReach / kBins;
  // A right U is two standard deviations.
  const auto density = [](double z) {
    return kStep * 2.0 / std::sqrt(2.0 * 3.14159265358979) * std::exp(-2.0 * z * z);
  };
  const double top = 1.15 * std::max(*std::ranges::max_element(bins), density(0.0));
  report::Plot plot(-kReach, kReach, 0.0, 100.0 * top, "Histogram of error over U");
  plot.xTicks({-2.0, -1.0, 0.0, 1.0, 2.0}, "error / U", "{:+g}");
  plot.yTicks(report::ticks(0.0, 100.0 * top), "{:g} %");
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const double from = -kReach + kStep * static_cast<double>(i);
    const bool miss = std::abs(from + 0.5 * kStep) > 1.0;
    plot.raw(fmt::format("<rect class={} x={:.1f} y={:.1f} width={:.1f} height={:.1f} />",
                         miss ? "barbad" : "bar", plot.x(from) + 0.5, plot.y(100.0 * bins.at(i)),
                         report::Plot::kW / kBins - 1.0, report::Plot::kH - plot.y(100.0 * bins.at(i))));
  }
  std::string curve = "M";
  for (int i = 0; i <= 100; ++i) {
    const double z = -kReach + 2.0 * kReach * i / 100.0;
    fmt::format_to(std::back_inserter(curve), "{}{:.1f} {:.1f}", i == 0 ? "" : "L", plot.x(z),
                   plot.y(100.0 * density(z)));
  }
  plot.raw(fmt::format("<path class=curve d='{}'/>", curve));
  plot.vertical(-1.0, "lim");
  plot.vertical(1.0, "lim");
  return plot.figure(
      "Error over U. Curve: what a right U (k = 2) of normal errors would show. Ends: beyond.");
}

std::string runChart(const std::vector<double>& errors_mm, const std::string& title) {
  if (errors_mm.size() < 2) return {};
  double most = 2e-4;
  for (const double e : errors_mm) {
    if (std::isfinite(e)) most = std::max(most, std::abs(e));
  }
  const double top = 1.3e3 * most;
  const auto n = static_cast<double>(errors_mm.size());
  report::Plot plot(0.0, n + 1.0, -top, top, title);
  plot.xTicks(report::ticks(1.0, n), "measurement");
  plot.yTicks(report::ticks(-top, top), "{:+g}");
  std::string way;
  std::string dots;
  for (std::size_t i = 0; i < errors_mm.size(); ++i) {
    if (!std::isfinite(errors_mm[i])) continue;
    const double x = plot.x(static_cast<double>(i + 1));
    const double y = plot.y(1e3 * errors_mm[i]);
    fmt::format_to(std::back_inserter(way), "{}{:.1f} {:.1f}", way.empty() ? "M" : "L", x, y);
    fmt::format_to(std::back_inserter(dots), "M{:.1f} {:.1f}h0", x, y);
  }
  plot.raw(fmt::format("<path class=way d='{}'/><path class='dots big' d='{}'/>", way, dots));
  plot.horizontal(0.0, "zero");
  const TypeOne t = typeOne(errors_mm, kTolerance_mm);
  plot.horizontal(1e3 * t.error.mean, "fit");
  return plot.figure(fmt::format("{}: bias {:+.3f} µm, σ {:.3f} µm, Cg {:.1f}, Cgk {:.1f}. Errors in µm.",
                                 report::escapeHtml(title), 1e3 * t.error.mean, 1e3 * t.error.sigma, t.cg,
                                 t.cgk));
}

std::string verdictPlot(const std::vector<GaugePoint>& points, const std::string& title) {
  if (points.empty()) return {};
  constexpr double kBin_mm = 0.004;
  constexpr std::array kOrder{inspect::Verdict::kPass, inspect::Verdict::kNotProven, inspect::Verdict::kFail,
                              inspect::Verdict::kInvalid};
  std::map<std::size_t, std::map<inspect::Verdict, double>> bins;
  double most_mm = 0.06;
  for (const GaugePoint& p : points) {
    ++bins[static_cast<std::size_t>(p.truth_mm / kBin_mm)][p.verdict];
    most_mm = std::max(most_mm, p.truth_mm);
  }
  report::Plot plot(0.0, 1e3 * most_mm, 0.0, 100.0, title);
  for (auto& [bin, counts] : bins) {
    double all = 0.0;
    for (const auto& [verdict, count] : counts) all += count;
    double below = 0.0;
    const double from = plot.x(1e3 * kBin_mm * static_cast<double>(bin));
    const double to = plot.x(1e3 * kBin_mm * static_cast<double>(bin + 1));
    for (const inspect::Verdict v : kOrder) {
      const double share = 100.0 * counts[v] / all;
      if (share == 0.0) continue;
      plot.raw(fmt::format(
          "<rect class='oc {}' x={:.1f} y={:.1f} width={:.1f} height={:.1f} ><title>{} {:.0f} % of "
          "{:.0f}, {:.0f} to {:.0f} µm</title></rect>",
          report::verdictClass(v), from + 0.3, plot.y(below + share), std::max(to - from - 0.6, 0.5),
          plot.y(below) - plot.y(below + share), inspect::verdictName(v), share, all,
          1e3 * kBin_mm * static_cast<double>(bin), 1e3 * kBin_mm * static_cast<double>(bin + 1)));
      below += share;
    }
  }
  plot.xTicks(report::ticks(0.0, 1e3 * most_mm), "true deviation, µm");
  plot.yTicks({0.0, 50.0, 100.0}, "{:g} %");
  plot.vertical(50.0, "lim");
  return plot.figure(report::escapeHtml(title) +
                     ". <span class='pass'>■</span> PASS <span class='notproven'>■</span> NOT PROVEN "
                     "<span class='fail'>■</span> FAIL <span class='invalid'>■</span> INVALID; the "
                     "dashed line is the limit.");
}

}  // namespace kerfbench::gauge
