// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "hil/gauge/gauge_report.h"
#include "hil/report/html_text.h"

namespace kerfbench::hil {
namespace {

constexpr double kW = 420.0;
constexpr double kH = 190.0;
constexpr double kClass_mm = 0.01;  ///< Of sizes.
constexpr std::size_t kMostDots = 2500;

/// A plot of kW x kH with scales: x and y in µm or plain.
class Plot {
 public:
  Plot(double x0, double x1, double y0, double y1, const std::string& label)
      : x0_(x0), x1_(x1), y0_(y0), y1_(y1) {
    svg_ = fmt::format(
        "<svg class=plot viewBox='-46 -10 {:.0f} {:.0f}' role=img aria-label='{}'><rect class=frame x=0 y=0 "
        "width={:.0f} height={:.0f} />",
        kW + 62.0, kH + 46.0, escapeHtml(label), kW, kH);
  }
  [[nodiscard]] double x(double v) const { return kW * (std::clamp(v, x0_, x1_) - x0_) / (x1_ - x0_); }
  [[nodiscard]] double y(double v) const {
    return kH * (1.0 - (std::clamp(v, y0_, y1_) - y0_) / (y1_ - y0_));
  }
  void raw(const std::string& text) { svg_ += text; }
  void xTicks(const std::vector<double>& at, const std::string& name, const char* format = "{:g}") {
    for (const double v : at) {
      raw(fmt::format(
          "<line class=grid x1={0:.1f} x2={0:.1f} y1=0 y2={1:.0f} /><text class=tick x={0:.1f} y={2:.0f} "
          "text-anchor=middle>{3}</text>",
          x(v), kH, kH + 13.0, fmt::format(fmt::runtime(format), v)));
    }
    raw(fmt::format("<text class=tick x={:.0f} y={:.0f} text-anchor=middle>{}</text>", 0.5 * kW, kH + 28.0,
                    escapeHtml(name)));
  }
  void yTicks(const std::vector<double>& at, const char* format = "{:g}") {
    for (const double v : at) {
      raw(
          fmt::format("<line class=grid x1=0 x2={:.0f} y1={:.1f} y2={:.1f} /><text class=tick x=-4 y={:.1f} "
                      "text-anchor=end>{}</text>",
                      kW, y(v), y(v), y(v) + 3.5, fmt::format(fmt::runtime(format), v)));
    }
  }
  void horizontal(double v, const char* css) {
    raw(fmt::format("<line class={} x1=0 x2={:.0f} y1={:.1f} y2={:.1f} />", css, kW, y(v), y(v)));
  }
  void vertical(double v, const char* css) {
    raw(fmt::format("<line class={} x1={:.1f} x2={:.1f} y1=0 y2={:.0f} />", css, x(v), x(v), kH));
  }
  std::string figure(const std::string& caption) {
    return fmt::format("<figure>{}</svg><figcaption>{}</figcaption></figure>", svg_, caption);
  }

 private:
  double x0_, x1_, y0_, y1_;
  std::string svg_;
};

/// 1, 2 or 5 times a power of ten, so that `range` has four to ten of them.
double tickOf(double range) {
  const double power = std::pow(10.0, std::floor(std::log10(range / 4.0)));
  const double rest = range / 4.0 / power;
  return power * (rest >= 5.0 ? 5.0 : rest >= 2.0 ? 2.0 : 1.0);
}
std::vector<double> ticks(double from, double to) {
  const double step = tickOf(to - from);
  std::vector<double> at;
  for (double v = std::ceil(from / step - 1e-9) * step; v <= to + 1e-9 * step; v += step)
    at.push_back(std::abs(v) < 1e-9 * step ? 0.0 : v);
  return at;
}

/// µm, or a dash for what was not found.
std::string micrometres(double mm, bool sign) {
  if (!std::isfinite(mm)) return "–";
  return sign ? fmt::format("{:+.2f}", 1e3 * mm) : fmt::format("{:.2f}", 1e3 * mm);
}

std::size_t classOf(double truth_mm) { return static_cast<std::size_t>(std::max(0.0, truth_mm) / kClass_mm); }

}  // namespace

std::string biasPlot(const std::vector<GaugePoint>& points, const std::optional<Linearity>& line) {
  if (points.empty()) return {};
  std::vector<double> magnitude;
  std::vector<std::vector<double>> widths;
  double most_mm = 0.0;
  for (const GaugePoint& p : points) {
    magnitude.push_back(std::abs(p.value_mm - p.truth_mm));
    most_mm = std::max(most_mm, p.truth_mm);
    widths.resize(std::max(widths.size(), classOf(p.truth_mm) + 1));
    widths[classOf(p.truth_mm)].push_back(p.U_mm);
  }
  const double top = 1e3 * std::max(2.0 * quantileOf(magnitude, 0.95), 2e-4);
  Plot plot(0.0, 1e3 * most_mm, -top, top, "Error over true size");
  plot.xTicks(ticks(0.0, 1e3 * most_mm), "true deviation, µm");
  plot.yTicks(ticks(-top, top), "{:+g}");
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
    plot.raw(fmt::format("<line class=fit x1=0 x2={:.0f} y1={:.1f} y2={:.1f} />", kW,
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
  Plot plot(-kReach, kReach, 0.0, 100.0 * top, "Histogram of error over U");
  plot.xTicks({-2.0, -1.0, 0.0, 1.0, 2.0}, "error / U", "{:+g}");
  plot.yTicks(ticks(0.0, 100.0 * top), "{:g} %");
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const double from = -kReach + kStep * static_cast<double>(i);
    const bool miss = std::abs(from + 0.5 * kStep) > 1.0;
    plot.raw(fmt::format("<rect class={} x={:.1f} y={:.1f} width={:.1f} height={:.1f} />",
                         miss ? "barbad" : "bar", plot.x(from) + 0.5, plot.y(100.0 * bins.at(i)),
                         kW / kBins - 1.0, kH - plot.y(100.0 * bins.at(i))));
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
  Plot plot(0.0, n + 1.0, -top, top, title);
  plot.xTicks(ticks(1.0, n), "measurement");
  plot.yTicks(ticks(-top, top), "{:+g}");
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
                                 escapeHtml(title), 1e3 * t.error.mean, 1e3 * t.error.sigma, t.cg, t.cgk));
}

std::string fieldPlot(const std::vector<FieldCell>& field) {
  if (field.empty()) return {};
  Eigen::AlignedBox2d box;
  double most_mm = 1e-6;
  std::vector<double> sigma;
  for (const FieldCell& c : field) {
    box.extend(c.p_V_mm);
    most_mm = std::max(most_mm, c.bias_mm.norm());
    sigma.push_back(c.sigma_mm);
  }
  const Eigen::Vector2d low = box.min() - Eigen::Vector2d::Constant(3.5);
  const Eigen::Vector2d size = box.sizes() + Eigen::Vector2d::Constant(7.0);
  const double scale = 3.2 / most_mm;  // The longest arrow nearly leaves its cell of 5 mm.
  std::string svg =
      fmt::format("<svg class=field viewBox='{:.1f} {:.1f} {:.1f} {:.1f}' role=img aria-label='Field'>",
                  low.x(), -low.y() - size.y(), size.x(), size.y());
  for (const FieldCell& c : field) {
    const double share = c.bias_mm.norm() / most_mm;
    svg += fmt::format(
        "<rect class=cell x={:.1f} y={:.1f} width=4.8 height=4.8 style='fill-opacity:{:.2f}'><title>x "
        "{:.1f}, "
        "y {:.1f} mm: {:+.3f}, {:+.3f} µm (± {:.3f}), {} readings</title></rect>",
        c.p_V_mm.x() - 2.4, -c.p_V_mm.y() - 2.4, 0.06 + 0.5 * share, c.p_V_mm.x(), c.p_V_mm.y(),
        1e3 * c.bias_mm.x(), 1e3 * c.bias_mm.y(), 2e3 * c.sigma_mm, c.readings);
    const Eigen::Vector2d tip = c.p_V_mm + scale * c.bias_mm;
    svg += fmt::format(
        "<circle class=root cx={0:.2f} cy={1:.2f} r=0.35 /><line class=arrow x1={0:.2f} y1={1:.2f} "
        "x2={2:.2f} y2={3:.2f} />",
        c.p_V_mm.x(), -c.p_V_mm.y(), tip.x(), -tip.y());
  }
  return fmt::format(
      "<figure>{}</svg><figcaption>Mean error of readings over the kerf camera's field (plane V, cells of "
      "5 mm); the longest arrow is {:.3f} µm, a cell's mean is known to about {:.3f} µm (k = 2)."
      "</figcaption></figure>",
      svg, 1e3 * most_mm, 2e3 * quantileOf(sigma, 0.5));
}

std::string verdictPlot(const std::vector<GaugePoint>& points, const std::string& title) {
  if (points.empty()) return {};
  constexpr double kBin_mm = 0.004;
  constexpr std::array kOrder{Verdict::kPass, Verdict::kNotProven, Verdict::kFail, Verdict::kInvalid};
  std::map<std::size_t, std::map<Verdict, double>> bins;
  double most_mm = 0.06;
  for (const GaugePoint& p : points) {
    ++bins[static_cast<std::size_t>(p.truth_mm / kBin_mm)][p.verdict];
    most_mm = std::max(most_mm, p.truth_mm);
  }
  Plot plot(0.0, 1e3 * most_mm, 0.0, 100.0, title);
  for (auto& [bin, counts] : bins) {
    double all = 0.0;
    for (const auto& [verdict, count] : counts) all += count;
    double below = 0.0;
    const double from = plot.x(1e3 * kBin_mm * static_cast<double>(bin));
    const double to = plot.x(1e3 * kBin_mm * static_cast<double>(bin + 1));
    for (const Verdict v : kOrder) {
      const double share = 100.0 * counts[v] / all;
      if (share == 0.0) continue;
      plot.raw(fmt::format(
          "<rect class='oc {}' x={:.1f} y={:.1f} width={:.1f} height={:.1f} ><title>{} {:.0f} % of "
          "{:.0f}, {:.0f} to {:.0f} µm</title></rect>",
          verdictClass(v), from + 0.3, plot.y(below + share), std::max(to - from - 0.6, 0.5),
          plot.y(below) - plot.y(below + share), verdictName(v), share, all,
          1e3 * kBin_mm * static_cast<double>(bin), 1e3 * kBin_mm * static_cast<double>(bin + 1)));
      below += share;
    }
  }
  plot.xTicks(ticks(0.0, 1e3 * most_mm), "true deviation, µm");
  plot.yTicks({0.0, 50.0, 100.0}, "{:g} %");
  plot.vertical(50.0, "lim");
  return plot.figure(escapeHtml(title) +
                     ". <span class='pass'>■</span> PASS <span class='notproven'>■</span> NOT PROVEN "
                     "<span class='fail'>■</span> FAIL <span class='invalid'>■</span> INVALID; the "
                     "dashed line is the limit.");
}

std::string detectablePlot(const std::vector<KindResult>& kinds) {
  Plot plot(45.0, 65.0, 0.0, static_cast<double>(kinds.size()), "Smallest detectable size");
  plot.xTicks(ticks(45.0, 65.0), "smallest size that is FAIL in 95 % of cases, with 95 % confidence, µm");
  plot.vertical(50.0, "lim");
  double row = static_cast<double>(kinds.size()) - 0.5;
  for (const KindResult& k : kinds) {
    const double y = plot.y(row);
    plot.raw(
        fmt::format("<text class=tick x=-4 y={:.1f} text-anchor=end>{}</text>", y + 3.5, faultName(k.kind)));
    if (std::isfinite(k.detectable_mm)) {
      plot.raw(fmt::format(
          "<rect class=bar x=0 y={:.1f} width={:.1f} height=12 /><text class=tick x={:.1f} y={:.1f} >{:.2f}"
          "</text>",
          y - 6.0, plot.x(1e3 * k.detectable_mm), plot.x(1e3 * k.detectable_mm) + 4.0, y + 3.5,
          1e3 * k.detectable_mm));
    } else {
      const auto fails = k.bad.find(Verdict::kFail);
      const bool none = fails == k.bad.end() || fails->second == 0;
      plot.raw(fmt::format("<text class='tick warn' x=6 y={:.1f} >{}</text>", y + 3.5,
                           none ? "never FAIL up to 120 µm" : "too few cases (59 are needed)"));
    }
    row -= 1.0;
  }
  return plot.figure("Smallest detectable size of each fault kind (distribution-free tolerance bound).");
}

std::string coveragePlot(const std::vector<Coverage>& coverage) {
  constexpr double kRow = 17.0;
  const double height = kRow * static_cast<double>(coverage.size());
  const auto x = [](double share) { return 420.0 * (std::clamp(share, 0.7, 1.0) - 0.7) / 0.3; };
  std::string svg = fmt::format(
      "<svg class=plot viewBox='-236 -8 900 {:.0f}' role=img aria-label='Coverage'><rect class=frame x=0 y=0 "
      "width=420 "
      "height={:.0f} /><rect class=goal x={:.1f} y=0 width={:.1f} height={:.0f} />",
      height + 36.0, height, x(0.94), x(0.968) - x(0.94), height);
  for (const double share : {0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 1.0}) {
    svg += fmt::format(
        "<line class=grid x1={0:.1f} x2={0:.1f} y1=0 y2={1:.0f} /><text class=tick x={0:.1f} y={2:.0f} "
        "text-anchor=middle>{3:.0f} %</text>",
        x(share), height, height + 14.0, 100.0 * share);
  }
  double y = 0.5 * kRow;
  for (const Coverage& c : coverage) {
    const double share = c.cases == 0 ? 0.0 : static_cast<double>(c.hits) / static_cast<double>(c.cases);
    svg += fmt::format("<text class=tick x=-6 y={:.1f} text-anchor=end>{}</text>", y + 3.5,
                       escapeHtml(c.quantity));
    svg += fmt::format(
        "<line class=ci x1={:.1f} x2={:.1f} y1={:.1f} y2={:.1f} /><circle class={} cx={:.1f} cy={:.1f} r=3.2 "
        "/>",
        x(c.share.low), x(c.share.high), y, y, share >= 0.94 && share <= 0.968 ? "hold" : "off", x(share), y);
    svg += fmt::format("<text class=tick x=428 y={:.1f}>{:.1f} % of {}; bias {}, σ {}, U {} µm</text>",
                       y + 3.5, 100.0 * share, c.cases, micrometres(c.error_mm.mean, true),
                       micrometres(c.error_mm.sigma, false), micrometres(c.U_median_mm, false));
    y += kRow;
  }
  return svg + "</svg>";
}

}  // namespace kerfbench::hil
