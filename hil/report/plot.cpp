// SPDX-License-Identifier: Apache-2.0
#include "hil/report/plot.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "hil/base/chart.h"
#include "hil/report/html_text.h"

namespace kerfbench::report {
Plot::Plot(double x0, double x1, double y0, double y1, const std::string& label)
    : x0_(x0), x1_(x1), y0_(y0), y1_(y1) {
  svg_ = fmt::format(
      "<svg class=plot viewBox='-46 -10 {:.0f} {:.0f}' role=img aria-label='{}'><rect class=frame x=0 y=0 "
      "width={:.0f} height={:.0f} />",
      kW + 62.0, kH + 46.0, escapeHtml(label), kW, kH);
}

double Plot::x(double v) const { return kW * (std::clamp(v, x0_, x1_) - x0_) / (x1_ - x0_); }
double Plot::y(double v) const { return kH * (1.0 - (std::clamp(v, y0_, y1_) - y0_) / (y1_ - y0_)); }

void Plot::xTicks(const std::vector<double>& at, const std::string& name, const char* format) {
  for (const double v : at) {
    raw(fmt::format(
        "<line class=grid x1={0:.1f} x2={0:.1f} y1=0 y2={1:.0f} /><text class=tick x={0:.1f} y={2:.0f} "
        "text-anchor=middle>{3}</text>",
        x(v), kH, kH + 13.0, fmt::format(fmt::runtime(format), v)));
  }
  raw(fmt::format("<text class=tick x={:.0f} y={:.0f} text-anchor=middle>{}</text>", 0.5 * kW, kH + 28.0,
                  escapeHtml(name)));
}

void Plot::yTicks(const std::vector<double>& at, const char* format) {
  for (const double v : at) {
    raw(
        fmt::format("<line class=grid x1=0 x2={:.0f} y1={:.1f} y2={:.1f} /><text class=tick x=-4 y={:.1f} "
                    "text-anchor=end>{}</text>",
                    kW, y(v), y(v), y(v) + 3.5, fmt::format(fmt::runtime(format), v)));
  }
}

void Plot::horizontal(double v, const char* css_class) {
  raw(fmt::format("<line class={} x1=0 x2={:.0f} y1={:.1f} y2={:.1f} />", css_class, kW, y(v), y(v)));
}

void Plot::vertical(double v, const char* css_class) {
  raw(fmt::format("<line class={} x1={:.1f} x2={:.1f} y1=0 y2={:.0f} />", css_class, x(v), x(v), kH));
}

std::string Plot::figure(const std::string& caption) const {
  return fmt::format("<figure>{}</svg><figcaption>{}</figcaption></figure>", svg_, caption);
}

std::vector<double> ticks(double from, double to) {
  const double step = base::roundStep(to - from);
  std::vector<double> at;
  const auto first = static_cast<int>(std::ceil(from / step - 1e-9));
  const auto last = static_cast<int>(std::floor(to / step + 1e-9));
  for (int i = first; i <= last; ++i) at.push_back(i * step);
  return at;
}

}  // namespace kerfbench::report
