// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/head_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>

#include <fmt/format.h>

#include "hil/report/html_text.h"
#include "hil/report/plot.h"

namespace kerfbench::head_service {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

constexpr double kLongest = 1.0 / 12.0;  // Largest drawn error, in the field's longer sides.
constexpr int kLines = 11;               // Lines of the grid, each way.
constexpr int kParts = 40;               // Parts of a line.
constexpr int kBins = 30;

double largestOf(const std::vector<PlaceError>& errors) {
  double most = 0.0;
  for (const PlaceError& error : errors) most = std::max(most, error.e_mm.norm());
  return most;
}

/// 1, 2 or 5 times a power of ten, not above `value` > 0.
double roundDown(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  const double rest = value / power;
  return power * (rest >= 5.0 ? 5.0 : rest >= 2.0 ? 2.0 : 1.0);
}

/// A picture of the field, in mm, y upwards.
class FieldMap {
 public:
  FieldMap(const AlignedBox2d& field_W_mm, const std::string& label)
      : field_(field_W_mm), unit_mm_(field_W_mm.sizes().maxCoeff() / 100.0) {
    const double side = 13.0 * unit_mm_;
    svg_ = fmt::format("<svg class=headmap viewBox='{:.3f} {:.3f} {:.3f} {:.3f}' role=img aria-label='{}'>",
                       field_.min().x() - side, -field_.max().y() - side, field_.sizes().x() + 2.0 * side,
                       field_.sizes().y() + 2.3 * side, report::escapeHtml(label));
    scales();
  }

  void raw(const std::string& text) { svg_ += text; }
  /// Per cent of the field's longer side.
  [[nodiscard]] double unit_mm() const { return unit_mm_; }
  static void to(std::string& path, const Vector2d& p, bool move) {
    fmt::format_to(std::back_inserter(path), "{}{:.3f} {:.3f}", move ? 'M' : 'L', p.x(), -p.y());
  }
  void path(const std::string& d, const char* css_class) {
    if (!d.empty()) raw(fmt::format("<path class='{}' d='{}'/>", css_class, d));
  }
  void text(const Vector2d& p, const char* anchor, const std::string& words) {
    raw(fmt::format("<text class=tick style='font-size:{:.3f}px' x={:.3f} y={:.3f} text-anchor={}>{}</text>",
                    3.1 * unit_mm_, p.x(), -p.y(), anchor, report::escapeHtml(words)));
  }
  /// A bar below the field that is as long as an error of a round length.
  void scaleBar(double exaggeration, double largest_mm) {
    if (!(largest_mm > 0.0)) return;
    const double mm = roundDown(largest_mm);
    const Vector2d at(field_.min().x(), field_.min().y() - 14.0 * unit_mm_);
    std::string bar;
    to(bar, at, true);
    to(bar, at + Vector2d(exaggeration * mm, 0.0), false);
    path(bar, "scalebar");
    text(at + Vector2d(exaggeration * mm + 1.5 * unit_mm_, -unit_mm_), "start", lengthText(mm));
  }
  [[nodiscard]] std::string figure(const std::string& caption) const {
    return fmt::format("<figure>{}</svg><figcaption>{}</figcaption></figure>", svg_, caption);
  }

 private:
  void scales() {
    const double below = field_.min().y() - 10.0 * unit_mm_;
    const double left = field_.min().x() - 5.0 * unit_mm_;
    text({field_.min().x(), below}, "middle", fmt::format("{:g}", field_.min().x()));
    text({field_.center().x(), below}, "middle", "x, mm");
    text({field_.max().x(), below}, "middle", fmt::format("{:g}", field_.max().x()));
    text({left, field_.min().y() - unit_mm_}, "end", fmt::format("{:g}", field_.min().y()));
    text({left, field_.center().y() - unit_mm_}, "end", "y");
    text({left, field_.max().y() - unit_mm_}, "end", fmt::format("{:g}", field_.max().y()));
  }

  AlignedBox2d field_;
  double unit_mm_;
  std::string svg_;
};

/// The lines of a grid, each point moved by `move`; a line breaks where that is nullopt.
std::string gridPath(const AlignedBox2d& field,
                     const std::function<std::optional<Vector2d>(const Vector2d&)>& moved) {
  std::string path;
  for (int axis = 0; axis < 2; ++axis) {
    for (int line = 0; line < kLines; ++line) {
      bool broken = true;
      for (int part = 0; part <= kParts; ++part) {
        Vector2d share;
        share[axis] = static_cast<double>(line) / (kLines - 1);
        share[1 - axis] = static_cast<double>(part) / kParts;
        const auto p = moved(field.min() + share.cwiseProduct(field.sizes()));
        if (p) FieldMap::to(path, *p, broken);
        broken = !p;
      }
    }
  }
  return path;
}

}  // namespace

std::string lengthText(double mm) {
  return mm >= 0.1 ? fmt::format("{:.3g} mm", mm) : fmt::format("{:.3g} µm", 1e3 * mm);
}

double exaggerationFor(double largest_mm, const AlignedBox2d& field_W_mm) {
  return largest_mm > 0.0 ? roundDown(kLongest * field_W_mm.sizes().maxCoeff() / largest_mm) : 1.0;
}

std::string deformedGrid(const AlignedBox2d& field_W_mm,
                         const std::function<std::optional<Vector2d>(const Vector2d&)>& error_mm,
                         const std::vector<PlaceError>& marks) {
  const double largest_mm = largestOf(marks);
  const double exaggeration = exaggerationFor(largest_mm, field_W_mm);
  FieldMap map(field_W_mm, "The field before");
  map.path(gridPath(field_W_mm, [](const Vector2d& p) { return std::optional(p); }), "wantedgrid");
  map.path(gridPath(field_W_mm,
                    [&](const Vector2d& p) -> std::optional<Vector2d> {
                      const auto e = error_mm(p);
                      if (!e) return std::nullopt;
                      return p + exaggeration * *e;
                    }),
           "drawngrid");
  for (const PlaceError& mark : marks) {
    const Vector2d at = mark.p_W_mm + exaggeration * mark.e_mm;
    std::string arrow;
    FieldMap::to(arrow, mark.p_W_mm, true);
    FieldMap::to(arrow, at, false);
    map.path(arrow, "way");
    map.raw(
        fmt::format("<circle class=mark cx={:.3f} cy={:.3f} r={:.3f} ><title>wanted at {:.2f}, {:.2f} mm; "
                    "off by {:+.4f}, "
                    "{:+.4f} mm</title></circle>",
                    at.x(), -at.y(), 0.9 * map.unit_mm(), mark.p_W_mm.x(), mark.p_W_mm.y(), mark.e_mm.x(),
                    mark.e_mm.y()));
  }
  map.scaleBar(exaggeration, largest_mm);
  return map.figure(
      fmt::format("<b>Before</b>, errors × {:g}. Grey: as wanted. Blue: as the beam draws it, by the fitted "
                  "head. Dots: the "
                  "{} marks of the first grid, as measured; the farthest is off by {}.",
                  exaggeration, marks.size(), lengthText(largest_mm)));
}

std::string errorArrows(const AlignedBox2d& field_W_mm, const std::vector<PlaceError>& errors,
                        double limit_mm) {
  if (errors.empty()) return {};
  const double largest_mm = largestOf(errors);
  const double exaggeration = exaggerationFor(largest_mm, field_W_mm);
  FieldMap map(field_W_mm, "What is left");
  map.path(gridPath(field_W_mm, [](const Vector2d& p) { return std::optional(p); }), "wantedgrid");
  for (const PlaceError& error : errors) {
    const Vector2d tip = error.p_W_mm + exaggeration * error.e_mm;
    const std::size_t bin = report::limitBin(error.e_mm.norm(), limit_mm);
    map.raw(fmt::format(
        "<g class=f{}><title>wanted at {:.2f}, {:.2f} mm; off by {:+.2f}, {:+.2f} µm</title><circle "
        "cx={:.3f} "
        "cy={:.3f} r={:.3f} /><line x1={:.3f} y1={:.3f} x2={:.3f} y2={:.3f} /></g>",
        bin, error.p_W_mm.x(), error.p_W_mm.y(), 1e3 * error.e_mm.x(), 1e3 * error.e_mm.y(), error.p_W_mm.x(),
        -error.p_W_mm.y(), 0.45 * map.unit_mm(), error.p_W_mm.x(), -error.p_W_mm.y(), tip.x(), -tip.y()));
  }
  map.scaleBar(exaggeration, largest_mm);
  return map.figure(fmt::format(
      "<b>After</b>, errors × {:g}: at the {} places that verify the table, each from the dot, where "
      "the beam was wanted, to where it landed. The longest is {}; the limit is {}.",
      exaggeration, errors.size(), lengthText(largest_mm), lengthText(limit_mm)));
}

std::string errorHistogram(const std::vector<PlaceError>& errors, double limit_mm) {
  if (errors.empty()) return {};
  const double top_um = 1.1e3 * std::max(limit_mm, largestOf(errors));
  std::array<std::size_t, kBins> bins{};
  for (const PlaceError& error : errors) {
    const auto bin = static_cast<std::size_t>(1e3 * error.e_mm.norm() / top_um * kBins);
    ++bins.at(std::min<std::size_t>(bin, kBins - 1));
  }
  const auto most = static_cast<double>(*std::ranges::max_element(bins));
  report::Plot plot(0.0, top_um, 0.0, 1.1 * most, "Histogram of errors");
  plot.xTicks(report::ticks(0.0, top_um), "error, µm");
  plot.yTicks(report::ticks(0.0, 1.1 * most));
  const double width_um = top_um / kBins;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    if (bins[i] == 0) continue;
    const double from_um = width_um * static_cast<double>(i);
    const double y = plot.y(static_cast<double>(bins[i]));
    plot.raw(fmt::format(
        "<rect class={} x={:.2f} y={:.2f} width={:.2f} height={:.2f} ><title>{} places</title></rect>",
        from_um >= 1e3 * limit_mm ? "barbad" : "bar", plot.x(from_um) + 0.5, y,
        plot.x(from_um + width_um) - plot.x(from_um) - 1.0, plot.y(0.0) - y, bins[i]));
  }
  plot.vertical(1e3 * limit_mm, "lim");
  return plot.figure(
      fmt::format("Places over how far the beam is off; red: the limit of {}.", lengthText(limit_mm)));
}

std::string errorScatter(const std::vector<PlaceError>& errors, double limit_mm) {
  if (errors.empty()) return {};
  const double y_um = 1.1e3 * std::max(limit_mm, largestOf(errors));
  const double x_um = y_um * report::Plot::kW / report::Plot::kH;
  report::Plot plot(-x_um, x_um, -y_um, y_um, "Errors along x and y");
  plot.xTicks(report::ticks(-x_um, x_um), "along x, µm", "{:+g}");
  plot.yTicks(report::ticks(-y_um, y_um), "{:+g}");
  std::string dots;
  Vector2d mean(0.0, 0.0);
  for (const PlaceError& error : errors) {
    mean += error.e_mm / static_cast<double>(errors.size());
    fmt::format_to(std::back_inserter(dots), "M{:.1f} {:.1f}h0", plot.x(1e3 * error.e_mm.x()),
                   plot.y(1e3 * error.e_mm.y()));
  }
  plot.raw(fmt::format("<circle class=circle cx={:.1f} cy={:.1f} r={:.1f} />", plot.x(0.0), plot.y(0.0),
                       plot.x(1e3 * limit_mm) - plot.x(0.0)));
  plot.raw(fmt::format("<path class=dots d='{}'/>", dots));
  return plot.figure(
      fmt::format("Errors along x and y, µm; red: the limit. Their mean is {:+.2f}, {:+.2f} µm: what lies "
                  "together beside the "
                  "middle is a shift of the whole field.",
                  1e3 * mean.x(), 1e3 * mean.y()));
}

}  // namespace kerfbench::head_service
