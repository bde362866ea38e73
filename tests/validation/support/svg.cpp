// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/support/svg.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace kerfbench::validation {
namespace {

constexpr double kWidth = 720.0, kHeight = 420.0;
constexpr double kLeft = 76.0, kRight = 20.0, kTop = 36.0, kBottom = 52.0, kKeyLine = 17.0;
constexpr std::array kColours{"#1f5fa8", "#c4541b", "#2f8a4c", "#8a3fa0", "#a38a00", "#0f8f9c", "#7a7a7a"};

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else {
      result += c;
    }
  }
  return result;
}

std::string text(double x, double y, const std::string& content, const char* anchor = "middle",
                 const char* more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" {}>{}</text>\n", x, y, anchor, more,
                     escaped(content));
}

std::string head(double width, double height, const std::string& title) {
  // A bold letter is about 0.62 of its size wide; a title that is too long is written smaller.
  const double size = std::min(14.0, (width - 16.0) / (0.62 * static_cast<double>(title.size())));
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
             "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#222\">\n"
             "<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#ffffff\"/>\n",
             width, height) +
         text(0.5 * width, 21.0, title, "middle",
              fmt::format("font-size=\"{:.1f}\" font-weight=\"bold\"", size).c_str());
}

/// Maps values to the page, and finds round numbers to write at an axis.
class Scale {
 public:
  Scale(const PlotAxis& axis, double low, double high, double from, double to)
      : log_(axis.log), low_(map(low)), high_(map(high)), from_(from), to_(to) {}
  [[nodiscard]] double operator()(double value) const {
    return from_ + (to_ - from_) * (map(value) - low_) / (high_ - low_);
  }
  [[nodiscard]] std::vector<double> ticks() const { return log_ ? decades() : rounds(); }

 private:
  [[nodiscard]] double map(double value) const { return log_ ? std::log10(value) : value; }
  [[nodiscard]] std::vector<double> decades() const {
    std::vector<double> result;
    const bool fine = high_ - low_ < 1.5;
    const auto first = static_cast<int>(std::floor(low_));
    const auto last = static_cast<int>(std::floor(high_ + 1e-9));
    for (int e = first; e <= last; ++e) {
      for (const double m : {1.0, 2.0, 5.0}) {
        if (m > 1.0 && !fine) break;
        const double at = e + std::log10(m);
        if (at >= low_ - 1e-9 && at <= high_ + 1e-9) result.push_back(m * std::pow(10.0, e));
      }
    }
    return result;
  }
  [[nodiscard]] std::vector<double> rounds() const {
    const double raw = (high_ - low_) / 6.0;
    const double power = std::pow(10.0, std::floor(std::log10(raw)));
    double step = 10.0 * power;
    for (const double m : {5.0, 2.0, 1.0}) {
      if (m * power >= raw) step = m * power;
    }
    std::vector<double> result;
    const auto first = static_cast<int>(std::ceil(low_ / step - 1e-9));
    const auto last = static_cast<int>(std::floor(high_ / step + 1e-9));
    for (int i = first; i <= last; ++i) result.push_back(i * step);
    return result;
  }

  bool log_;
  double low_, high_, from_, to_;
};

struct Range {
  double low{std::numeric_limits<double>::infinity()};
  double high{-std::numeric_limits<double>::infinity()};
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

Range rangeOf(const LinePlot& plot, int dimension) {
  const PlotAxis& axis = dimension == 0 ? plot.x : plot.y;
  if (axis.low != axis.high) return {axis.low, axis.high};
  Range range;
  for (const PlotLine& line : plot.lines) {
    for (const Eigen::Vector2d& point : line.points) {
      if (point.allFinite() && (!axis.log || point[dimension] > 0)) range.add(point[dimension]);
    }
  }
  if (dimension == 1) {
    for (const PlotLimit& limit : plot.limits) range.add(limit.value);
  }
  if (!(range.low <= range.high)) return {axis.log ? 0.1 : 0.0, 1.0};
  if (axis.log) return {range.low / 1.3, range.high * 1.3};
  const double margin = std::max(0.05 * (range.high - range.low), 1e-12 + 1e-6 * std::abs(range.high));
  return {range.low - margin, range.high + margin};
}

void equalise(Range& x, Range& y) {
  const double per_px =
      std::max((x.high - x.low) / (kWidth - kLeft - kRight), (y.high - y.low) / (kHeight - kTop - kBottom));
  const auto widen = [per_px](Range& range, double px) {
    const double middle = 0.5 * (range.low + range.high);
    range = {middle - 0.5 * per_px * px, middle + 0.5 * per_px * px};
  };
  widen(x, kWidth - kLeft - kRight);
  widen(y, kHeight - kTop - kBottom);
}

std::string axes(const LinePlot& plot, const Scale& x, const Scale& y) {
  constexpr double kFloor = kHeight - kBottom;
  std::string svg;
  const auto grid = [&svg](double x1, double y1, double x2, double y2) {
    svg += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#ddd\"/>\n",
                       x1, y1, x2, y2);
  };
  for (const double tick : x.ticks()) {
    grid(x(tick), kTop, x(tick), kFloor);
    svg += text(x(tick), kFloor + 17.0, fmt::format("{:.4g}", tick));
  }
  for (const double tick : y.ticks()) {
    grid(kLeft, y(tick), kWidth - kRight, y(tick));
    svg += text(kLeft - 6.0, y(tick) + 4.0, fmt::format("{:.4g}", tick), "end");
  }
  svg += fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" "
      "stroke=\"#444\"/>\n",
      kLeft, kTop, kWidth - kLeft - kRight, kFloor - kTop);
  svg += text(0.5 * (kLeft + kWidth - kRight), kHeight - 14.0, plot.x.label);
  const double middle = 0.5 * (kTop + kFloor);
  svg += text(16.0, middle, plot.y.label, "middle",
              fmt::format("transform=\"rotate(-90 16 {:.1f})\"", middle).c_str());
  return svg;
}

std::string curve(const PlotLine& line, const PlotAxis& x_axis, const PlotAxis& y_axis, const Scale& x,
                  const Scale& y, const char* colour) {
  std::string path;
  std::string dots;
  bool pen_down = false;
  for (const Eigen::Vector2d& p : line.points) {
    if (!p.allFinite() || (x_axis.log && p.x() <= 0) || (y_axis.log && p.y() <= 0)) {
      pen_down = false;
      continue;
    }
    path += fmt::format("{}{:.1f} {:.1f}", pen_down ? "L" : "M", x(p.x()), y(p.y()));
    pen_down = true;
    if (line.dots) {
      dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", x(p.x()), y(p.y()),
                          colour);
    }
  }
  if (!line.line || path.empty()) return dots;
  return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\"/>\n", path, colour) +
         dots;
}

}  // namespace

std::string svgOf(const LinePlot& plot) {
  Range x_range = rangeOf(plot, 0);
  Range y_range = rangeOf(plot, 1);
  if (plot.equal_scales) equalise(x_range, y_range);
  const Scale x(plot.x, x_range.low, x_range.high, kLeft, kWidth - kRight);
  const Scale y(plot.y, y_range.low, y_range.high, kHeight - kBottom, kTop);
  const auto named =
      std::ranges::count_if(plot.lines, [](const PlotLine& line) { return !line.name.empty(); });
  std::string svg =
      head(kWidth, kHeight + kKeyLine * static_cast<double>(named) + 4.0, plot.title) + axes(plot, x, y);
  svg += fmt::format(
      "<clipPath id=\"frame\"><rect x=\"{0:.1f}\" y=\"{1:.1f}\" width=\"{2:.1f}\" height=\"{3:.1f}\"/>"
      "</clipPath>\n<g clip-path=\"url(#frame)\">\n",
      kLeft, kTop, kWidth - kLeft - kRight, kHeight - kTop - kBottom);
  for (const PlotLimit& limit : plot.limits) {
    svg += fmt::format(
        "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#b00020\" "
        "stroke-dasharray=\"6 4\"/>\n",
        kLeft, y(limit.value), kWidth - kRight, y(limit.value));
    svg += text(kWidth - kRight - 6.0, y(limit.value) - 5.0, limit.name, "end", "fill=\"#b00020\"");
  }
  for (std::size_t i = 0; i < plot.lines.size(); ++i) {
    svg += curve(plot.lines[i], plot.x, plot.y, x, y, kColours.at(i % kColours.size()));
  }
  svg += "</g>\n";
  double key_y = kHeight + 4.0;
  for (std::size_t i = 0; i < plot.lines.size(); ++i) {
    if (plot.lines[i].name.empty()) continue;
    svg += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"14\" height=\"4\" fill=\"{}\"/>\n", kLeft,
                       key_y - 6.0, kColours.at(i % kColours.size()));
    svg += text(kLeft + 20.0, key_y, plot.lines[i].name, "start");
    key_y += kKeyLine;
  }
  return svg + "</svg>\n";
}

namespace {

constexpr double kCellW = 66.0, kCellH = 30.0, kSide = 116.0, kCellTop = 36.0;

// Line of the limit between cells on its two sides.
std::string limitLine(const CellPlot& plot) {
  const auto holds = [&](std::size_t r, std::size_t c) { return plot.value.at(r).at(c) <= plot.limit; };
  const auto line = [](double x1, double y1, double x2, double y2) {
    return fmt::format(
        "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#b00020\" "
        "stroke-width=\"2.5\" stroke-linecap=\"round\"/>\n",
        x1, y1, x2, y2);
  };
  std::string svg;
  for (std::size_t r = 0; r < plot.rows.size(); ++r) {
    for (std::size_t c = 0; c < plot.columns.size(); ++c) {
      const double x = kSide + kCellW * static_cast<double>(c);
      const double y = kCellTop + kCellH * static_cast<double>(r);
      if (c > 0 && holds(r, c) != holds(r, c - 1)) svg += line(x, y, x, y + kCellH);
      if (r > 0 && holds(r, c) != holds(r - 1, c)) svg += line(x, y, x + kCellW, y);
    }
  }
  return svg;
}

}  // namespace

std::string svgOf(const CellPlot& plot) {
  const double width = kSide + kCellW * static_cast<double>(plot.columns.size()) + 20.0;
  const double height = 78.0 + kCellH * static_cast<double>(plot.rows.size()) + 20.0;
  std::string svg = head(width, height, plot.title);
  const double floor = height - 52.0;
  for (std::size_t r = 0; r < plot.rows.size(); ++r) {
    const double y = kCellTop + kCellH * static_cast<double>(r);
    svg += text(kSide - 6.0, y + 0.5 * kCellH + 4.0, plot.rows[r], "end");
    for (std::size_t c = 0; c < plot.columns.size(); ++c) {
      const double x = kSide + kCellW * static_cast<double>(c);
      const double share = plot.value.at(r).at(c) / plot.limit;
      const char* fill = share <= 0.5   ? "#bfe3c4"
                         : share <= 1.0 ? "#e6f2c2"
                         : share <= 2.0 ? "#f6d0b4"
                                        : "#eaa0a0";
      svg += fmt::format(
          "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\" "
          "stroke=\"#ffffff\"/>\n",
          x, y, kCellW, kCellH, fill);
      svg += text(x + 0.5 * kCellW, y + 0.5 * kCellH + 4.0, plot.text.at(r).at(c));
    }
  }
  svg += limitLine(plot);
  for (std::size_t c = 0; c < plot.columns.size(); ++c) {
    svg += text(kSide + kCellW * (static_cast<double>(c) + 0.5), floor + 8.0, plot.columns[c]);
  }
  svg += text(kSide + 0.5 * (width - kSide - 20.0), height - 14.0, plot.x_label);
  const double middle = kCellTop + 0.5 * (floor - 46.0);
  svg += text(16.0, middle, plot.y_label, "middle",
              fmt::format("transform=\"rotate(-90 16 {:.1f})\"", middle).c_str());
  return svg + "</svg>\n";
}

}  // namespace kerfbench::validation
