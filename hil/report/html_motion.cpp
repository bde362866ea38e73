// SPDX-License-Identifier: Apache-2.0
// Deviation, stillness and speed on one axis of time, with entity and line of the program: the whole run, and
// the cuts in which a check did not pass.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "hil/report/html_answer.h"
#include "hil/report/html_text.h"
#include "hil/report/plot.h"

namespace kerfbench::report {
namespace {

using inspect::CutFrame;
using inspect::CutResult;

constexpr double kMotionWidth = 820.0;
constexpr double kPanelHeight = 120.0;
constexpr double kSpeedHeight = 70.0;
constexpr std::size_t kMotionPoints = 1200;  ///< Most of a series; the farthest of each group is kept.
constexpr std::size_t kMostCuts = 4;
constexpr std::size_t kSpeedFrames = 4;  ///< A speed is that over so many frames.

struct MotionPoint {
  double time_s{}, value{};
};
using Series = std::vector<MotionPoint>;

/// The farthest from zero of each group of neighbours.
Series thinned(const Series& all) {
  const std::size_t stride = std::max<std::size_t>(1, (all.size() + kMotionPoints - 1) / kMotionPoints);
  Series kept;
  for (std::size_t i = 0; i < all.size(); i += stride) {
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(std::min(i + stride, all.size()));
    kept.push_back(*std::max_element(
        all.begin() + static_cast<std::ptrdiff_t>(i), end,
        [](const MotionPoint& a, const MotionPoint& b) { return std::abs(a.value) < std::abs(b.value); }));
  }
  return kept;
}

Series deviationsOf(const CutResult& cut) {
  Series series;
  for (const CutFrame& frame : cut.track)
    if (std::isfinite(frame.deviation_mm)) series.push_back({frame.time_s, 1e3 * frame.deviation_mm});
  return series;
}

Series residualsOf(const CutResult& cut) {
  Series series;
  for (std::size_t i = 0; i < cut.residual_mm.size(); ++i)
    series.push_back({cut.time_s[i], 1e3 * cut.residual_mm[i]});
  return series;
}

/// Speed of the spot on the sheet, mm/s.
Series speedsOf(const CutResult& cut) {
  Series series;
  for (std::size_t i = kSpeedFrames; i < cut.track.size(); ++i) {
    const CutFrame& a = cut.track[i - kSpeedFrames];
    const CutFrame& b = cut.track[i];
    if (b.time_s > a.time_s)
      series.push_back({0.5 * (a.time_s + b.time_s), (b.p_S_mm - a.p_S_mm).norm() / (b.time_s - a.time_s)});
  }
  return series;
}

double largestIn(const Series& series, double least) {
  double largest = least;
  for (const MotionPoint& p : series) largest = std::max(largest, std::abs(p.value));
  return largest;
}

/// Figures of one span of time.
class MotionFigure {
 public:
  MotionFigure(const RunReport& report, std::vector<const CutResult*> cuts)
      : report_(report), cuts_(std::move(cuts)) {
    from_s_ = cuts_.front()->track.front().time_s;
    to_s_ = std::max(cuts_.back()->track.back().time_s, from_s_ + 1e-4);
    for (const CutResult* cut : cuts_) {
      append(deviationsOf(*cut), deviations_);
      append(residualsOf(*cut), residuals_);
      append(speedsOf(*cut), speeds_);
    }
    limit_um_ = 1e3 * std::max(report.limits.path_mm, report.limits.stillness_mm);
    full_um_ = 1.1 * largestIn(residuals_, largestIn(deviations_, limit_um_));
    full_mm_s_ = 1.1 * largestIn(speeds_, 1.0);
  }

  [[nodiscard]] std::string svg(std::string_view label) const {
    const double speed_top = kPanelHeight + 14.0;
    const double job_top = speed_top + kSpeedHeight + 8.0;
    const double bottom = job_top + 18.0;
    std::string svg = fmt::format(
        "<svg class=motion viewBox='-58 -8 {:.0f} {:.0f}' role=img aria-label='{}'><rect class=frame x=0 y=0 "
        "width={:.0f} height={:.0f} /><rect class=frame x=0 y={:.0f} width={:.0f} height={:.0f} />",
        kMotionWidth + 72.0, bottom + 28.0, label, kMotionWidth, kPanelHeight, speed_top, kMotionWidth,
        kSpeedHeight);
    // Numbers of limits that lie on each other cannot be read: then the largest has one.
    const bool is_far = limit_um_ < 0.15 * full_um_;
    svg += level(0.0, "zero", true) + level(limit_um_, "lim", !is_far) + level(-limit_um_, "lim", !is_far);
    if (is_far) svg += level(full_um_ / 1.1, "grid", true) + level(-full_um_ / 1.1, "grid", true);
    svg += times(bottom);
    svg += dots(residuals_, "dots") + dots(deviations_, "devdots");
    svg += speedLine(speed_top) + fmt::format("<text class=tick x=-4 y={:.0f} text-anchor=end>{:.0f}</text>",
                                              speed_top + 8.0, full_mm_s_ / 1.1);
    return svg + jobRow(job_top) + marks(bottom) + "</svg>";
  }

  /// Lines of the program that are named in the row, in order.
  [[nodiscard]] std::vector<int> lines() const {
    std::vector<int> lines;
    for (const CutResult* cut : cuts_)
      for (const CutFrame& frame : cut->track)
        if (frame.program_line > 0 && std::ranges::find(lines, frame.program_line) == lines.end())
          lines.push_back(frame.program_line);
    return lines;
  }

 private:
  static void append(const Series& series, Series& to) { to.insert(to.end(), series.begin(), series.end()); }

  [[nodiscard]] double x(double time_s) const {
    return kMotionWidth * (std::clamp(time_s, from_s_, to_s_) - from_s_) / (to_s_ - from_s_);
  }
  [[nodiscard]] double y(double um) const { return 0.5 * kPanelHeight * (1.0 - um / full_um_); }

  [[nodiscard]] std::string level(double um, std::string_view look, bool number) const {
    std::string svg =
        fmt::format("<line class={} x1=0 x2={:.0f} y1={:.1f} y2={:.1f} />", look, kMotionWidth, y(um), y(um));
    if (number)
      svg += fmt::format("<text class=tick x=-4 y={:.1f} text-anchor=end>{:+.0f} µm</text>", y(um) + 3.5, um);
    return svg;
  }
  [[nodiscard]] std::string dots(const Series& series, std::string_view look) const {
    std::string d;
    for (const MotionPoint& p : thinned(series))
      fmt::format_to(std::back_inserter(d), "M{:.1f} {:.1f}h0", x(p.time_s), y(p.value));
    return fmt::format("<path class={} d='{}'/>", look, d);
  }
  [[nodiscard]] std::string speedLine(double top) const {
    std::string d;
    double last_s = -1.0;
    const Series kept = thinned(speeds_);
    const double pitch_s =
        4.0 * (to_s_ - from_s_) / static_cast<double>(std::max<std::size_t>(kept.size(), 1));
    for (const MotionPoint& p : kept) {
      fmt::format_to(std::back_inserter(d), "{}{:.1f} {:.1f}",
                     last_s >= 0.0 && p.time_s - last_s < pitch_s ? 'L' : 'M', x(p.time_s),
                     top + kSpeedHeight * (1.0 - p.value / full_mm_s_));
      last_s = p.time_s;
    }
    return fmt::format("<path class=speed d='{}'/>", d);
  }
  [[nodiscard]] std::string times(double bottom) const {
    std::string svg;
    for (const double at : ticks(from_s_, to_s_)) {
      svg += fmt::format(
          "<line class=grid x1={0:.1f} x2={0:.1f} y1=0 y2={1:.0f} /><text class=tick x={0:.1f} y={2:.0f} "
          "text-anchor=middle>{3:g} s</text>",
          x(at), bottom, bottom + 13.0, at);
    }
    return svg;
  }
  /// What was followed, as boxes; those too narrow for a word have it as their title.
  [[nodiscard]] std::string jobRow(double top) const {
    std::string svg;
    for (const CutResult* cut : cuts_) {
      for (std::size_t i = 0; i < cut->track.size();) {
        const CutFrame& first = cut->track[i];
        std::size_t end = i + 1;
        while (end < cut->track.size() && cut->track[end].entity == first.entity &&
               cut->track[end].program_line == first.program_line)
          ++end;
        svg += jobBox(first, cut->unit, cut->track[end - 1].time_s, top);
        i = end;
      }
    }
    return svg;
  }
  [[nodiscard]] std::string jobBox(const CutFrame& first, int unit, double to_s, double top) const {
    const double left = x(first.time_s);
    const double width = std::max(x(to_s) - left, 0.5);
    std::string name = first.entity < 0 ? "–" : fmt::format("E{}", first.entity);
    if (first.program_line > 0) name += fmt::format(" · {}", first.program_line);
    std::string box = fmt::format(
        "<rect class=job x={:.1f} y={:.0f} width={:.1f} height=18 ><title>unit {}, {}</title></rect>", left,
        top, width, unit, name);
    if (6.5 * static_cast<double>(name.size()) < width)
      box += fmt::format("<text x={:.1f} y={:.0f}>{}</text>", left + 3.0, top + 13.0, name);
    return box;
  }
  [[nodiscard]] std::string marks(double bottom) const {
    std::string svg;
    for (const inspect::Check& check : report_.result.checks) {
      const inspect::Whereabouts& where = check.where;
      if (check.verdict == inspect::Verdict::kPass || !(where.time_s >= from_s_ && where.time_s <= to_s_))
        continue;
      svg += fmt::format(
          "<a href='#check-{0}'><line class=now x1={1:.1f} x2={1:.1f} y1=0 y2={2:.0f} "
          "/><title>{0}</title></a>",
          escapeHtml(check.name), x(where.time_s), bottom);
    }
    return svg;
  }

  const RunReport& report_;
  std::vector<const CutResult*> cuts_;
  double from_s_{}, to_s_{};
  Series deviations_, residuals_, speeds_;
  double limit_um_{}, full_um_{}, full_mm_s_{};
};

/// Cuts with the time of a check that did not pass.
std::vector<const CutResult*> markedCuts(const RunReport& report, const std::vector<const CutResult*>& cuts) {
  std::vector<const CutResult*> marked;
  for (const CutResult* cut : cuts) {
    const bool has = std::ranges::any_of(report.result.checks, [&](const inspect::Check& check) {
      return check.verdict != inspect::Verdict::kPass && check.where.time_s >= cut->start_s &&
             check.where.time_s <= cut->end_s;
    });
    if (has && marked.size() < kMostCuts) marked.push_back(cut);
  }
  return marked;
}

}  // namespace

std::string motionSection(const RunReport& report) {
  std::vector<const CutResult*> cuts;
  for (const CutResult& cut : report.result.cuts)
    if (cut.track.size() > kSpeedFrames) cuts.push_back(&cut);
  if (cuts.empty()) return {};
  std::ranges::stable_sort(cuts, {}, [](const CutResult* c) { return c->start_s; });
  std::string html = "<figure>" + scrolled("The whole run", MotionFigure(report, cuts).svg("The whole run")) +
                     "<figcaption>The whole run</figcaption></figure>";
  for (const CutResult* cut : markedCuts(report, cuts)) {
    const MotionFigure figure(report, {cut});
    html += "<figure>" + scrolled("One cut", figure.svg("One cut")) +
            fmt::format("<figcaption>The cut of unit {}, from {:.4f} to {:.4f} s</figcaption></figure>",
                        cut->unit, cut->start_s, cut->end_s) +
            programList(report, figure.lines());
  }
  return html +
         "<p class=note>By the frames of the spot camera. Above, in µm: <span class=devword>deviation</span> "
         "of the spot across its line, and <span class=spotword>what it is off along x</span> on the moving "
         "sheet, where the line lets x be seen; dashed: the limit. Below it the <span "
         "class=speedword>speed</span> on the sheet, mm/s; then entity and line of the program. Upright "
         "lines "
         "are the times of checks that did not pass.</p>";
}

}  // namespace kerfbench::report
