// SPDX-License-Identifier: Apache-2.0
// The pins around a moment, with what the beam followed and the line of the program.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/inspect/evidence/places.h"
#include "hil/report/html_answer.h"
#include "hil/report/html_text.h"

namespace kerfbench::report {
namespace {

constexpr double kWaveWidth = 800.0;
constexpr double kRow = 24.0;
constexpr double kSwing = 14.0;  ///< From the low level to the high one.
/// Edges closer than this are drawn as one line between the two levels, from which the pin goes on at the
/// level that the last of them leaves.
constexpr double kDense = 0.6;

/// The time axis of one moment.
struct WaveScale {
  double from_s{}, to_s{};
  [[nodiscard]] double x(double time_s) const {
    return kWaveWidth * (std::clamp(time_s, from_s, to_s) - from_s) / (to_s - from_s);
  }
};

/// The level of a pin over time, as SVG path data; `low` is the y of the low level.
std::string wirePath(const PinTrace& pin, const WaveScale& scale, double low) {
  const auto y = [&](bool level) { return level ? low - kSwing : low; };
  bool level = pin.level;
  std::string d = fmt::format("M0 {:.1f}", y(level));
  for (auto first = pin.toggle_s.begin(); first != pin.toggle_s.end();) {
    const double x = scale.x(*first);
    const auto next =
        std::find_if(first, pin.toggle_s.end(), [&](double time_s) { return scale.x(time_s) - x >= kDense; });
    const bool changes = (next - first) % 2 == 1;
    fmt::format_to(std::back_inserter(d), "H{:.1f}V{:.1f}", x, y(!level));
    if (next - first > 1) fmt::format_to(std::back_inserter(d), "V{:.1f}", y(level != changes));
    if (changes) level = !level;
    first = next;
  }
  fmt::format_to(std::back_inserter(d), "V{:.1f}H{:.1f}", y(level), kWaveWidth);
  return d;
}

bool endsWith(const std::string& name, std::string_view end) { return name.ends_with(end); }

std::string_view wireClass(const std::string& name) {
  if (name == "laser_gate") return "wire gate";
  if (name == "laser_pwm") return "wire pwm";
  return endsWith(name, "_pul") || endsWith(name, "_dir") ? "wire" : "wire sensor";
}

/// Time at the high level.
double highOf_s(const PinTrace& pin, const WaveScale& scale) {
  double high_s = 0.0;
  double since_s = scale.from_s;
  bool level = pin.level;
  for (const double time_s : pin.toggle_s) {
    if (level) high_s += time_s - since_s;
    since_s = time_s;
    level = !level;
  }
  return level ? high_s + scale.to_s - since_s : high_s;
}

/// What a pin did in numbers.
std::string wireNote(const PinTrace& pin, const WaveScale& scale) {
  if (pin.toggle_s.empty()) return pin.level ? "high" : "low";
  if (pin.name == "laser_pwm" || pin.name == "laser_gate")
    return fmt::format("high {:.1f} %", 100.0 * highOf_s(pin, scale) / (scale.to_s - scale.from_s));
  if (endsWith(pin.name, "_pul")) return fmt::format("{} pulses", (pin.toggle_s.size() + 1) / 2);
  return fmt::format("{} edges", pin.toggle_s.size());
}

std::string wireRow(const PinTrace& pin, const WaveScale& scale, double low) {
  return fmt::format(
      "<text x=-8 y={:.1f} text-anchor=end>{}</text><path class='{}' d='{}'/><text class=tick x={:.0f} "
      "y={:.1f}>{}</text>",
      low - 2.0, escapeHtml(pin.name), wireClass(pin.name), wirePath(pin, scale, low), kWaveWidth + 8.0,
      low - 2.0, wireNote(pin, scale));
}

std::string nameOf(const FollowedSpan& span) {
  std::string name = span.entity < 0 ? fmt::format("unit {}, on no line", span.unit)
                                     : inspect::checks::nameOf(span.unit, span.entity);
  return span.line > 0 ? name + fmt::format(" · line {}", span.line) : name;
}

/// What the beam followed, as a row of boxes.
std::string followedRow(const Moment& moment, const WaveScale& scale, double top) {
  std::string svg = fmt::format("<text x=-8 y={:.1f} text-anchor=end>spot seen on</text>", top + 13.0);
  for (const FollowedSpan& span : moment.followed) {
    const double x = scale.x(span.from_s);
    const double width = std::max(scale.x(span.to_s) - x, 1.0);
    const std::string name = nameOf(span);
    svg += fmt::format("<rect class=job x={:.1f} y={:.1f} width={:.1f} height=18 ><title>{}</title></rect>",
                       x, top, width, name);
    // About 6 units a character.
    if (6.0 * static_cast<double>(name.size()) < width)
      svg += fmt::format("<text x={:.1f} y={:.1f}>{}</text>", x + 4.0, top + 13.0, name);
  }
  return svg;
}

std::string timeAxis(const Moment& moment, const WaveScale& scale, double bottom) {
  std::string svg;
  const auto first = static_cast<int>(std::ceil(1e3 * (scale.from_s - moment.time_s) - 1e-6));
  const auto last = static_cast<int>(std::floor(1e3 * (scale.to_s - moment.time_s) + 1e-6));
  for (int ms = first; ms <= last; ++ms) {
    const double x = scale.x(moment.time_s + 1e-3 * ms);
    svg += fmt::format(
        "<line class=grid x1={0:.1f} x2={0:.1f} y1=0 y2={1:.1f} /><text class=tick x={0:.1f} y={2:.1f} "
        "text-anchor=middle>{3:+} ms</text>",
        x, bottom, bottom + 14.0, ms);
  }
  return svg;
}

/// The moment itself, as wide as it is known.
std::string nowLine(const RunReport& report, const Moment& moment, const WaveScale& scale, double bottom) {
  double within_s = 0.0;
  std::string other;
  for (const inspect::Check& check : report.result.checks) {
    if (std::ranges::find(moment.checks, check.name) == moment.checks.end()) continue;
    within_s = std::max(within_s, check.where.within_s);
    const double x = scale.x(check.where.other_s);
    if (std::isnan(check.where.other_s) || x <= 0.0 || x >= kWaveWidth) continue;
    // From the one instant to the other: that is what the check judges.
    const double now = scale.x(moment.time_s);
    other = fmt::format(
        "<rect class=nowband x={0:.1f} y=0 width={1:.1f} height={2:.1f} /><line class=now "
        "stroke-dasharray='4 3' "
        "x1={3:.1f} x2={3:.1f} y1=0 y2={2:.1f} ><title>{4}: counted from here</title></line>",
        std::min(x, now), std::abs(now - x), bottom, x, check.name);
  }
  const double left = scale.x(moment.time_s - within_s);
  return other + fmt::format(
                     "<rect class=nowband x={:.1f} y=0 width={:.1f} height={:.1f} /><line class=now "
                     "x1={:.1f} x2={:.1f} "
                     "y1=0 "
                     "y2={:.1f} />",
                     left, scale.x(moment.time_s + within_s) - left, bottom, scale.x(moment.time_s),
                     scale.x(moment.time_s), bottom);
}

}  // namespace

std::string programList(const RunReport& report, const std::vector<int>& lines) {
  std::string list;
  for (const int line : lines) {
    const auto found = report.program.find(line);
    if (found != report.program.end())
      list += fmt::format("<li>line {}: <code>{}</code></li>", line, escapeHtml(found->second));
  }
  return list.empty() ? list : "<p class=note>Program (job.gcode):</p><ul class=note>" + list + "</ul>";
}

std::string waveformFigure(const RunReport& report, std::size_t index) {
  const Moment& moment = report.moments[index];
  const WaveScale scale{moment.from_s, moment.to_s};
  if (!(scale.to_s > scale.from_s)) return {};
  const double bottom = kRow * static_cast<double>(moment.pins.size() + 1) + 8.0;
  std::string svg = fmt::format(
      "<svg class=wave viewBox='-126 -6 {:.0f} {:.0f}' role=img aria-label='Pins from {:.4f} to {:.4f} s'>",
      kWaveWidth + 126.0 + 90.0, bottom + 26.0, moment.from_s, moment.to_s);
  svg += timeAxis(moment, scale, bottom) + nowLine(report, moment, scale, bottom);
  double low = kRow - 4.0;
  for (const PinTrace& pin : moment.pins) {
    svg += wireRow(pin, scale, low);
    low += kRow;
  }
  svg += followedRow(moment, scale, low - kSwing) + "</svg>";
  std::vector<int> lines;
  for (const FollowedSpan& span : moment.followed)
    if (span.line > 0 && std::ranges::find(lines, span.line) == lines.end()) lines.push_back(span.line);
  return fmt::format(
             "<figure id='moment-{}'>{}<figcaption>The pins around {:.6f} s: {}. Read from the recording "
             "(pins.vcd), and where the spot camera saw the spot meanwhile.</figcaption></figure>",
             index + 1, scrolled("Waveform", svg), moment.time_s,
             escapeHtml(fmt::format("{}", fmt::join(moment.checks, ", ")))) +
         programList(report, lines);
}

}  // namespace kerfbench::report
