// SPDX-License-Identifier: Apache-2.0
// The timing of pulses.
#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "hil/report/html_text.h"

namespace kerfbench::report {
namespace {

std::string histogram(const PulseTiming& timing) {
  std::size_t last = 0;
  std::uint64_t most = 1;
  for (std::size_t i = 0; i < timing.setup_histogram.size(); ++i) {
    if (timing.setup_histogram[i] > 0) last = i;
    most = std::max(most, timing.setup_histogram[i]);
  }
  const bool open = last + 1 == timing.setup_histogram.size();
  const auto required = static_cast<std::size_t>(timing.profile.setup_s / timing.setup_bin_s);
  const std::size_t bins =
      std::min(std::max(last, required + 2) + 1, std::max(timing.setup_histogram.size(), required + 3));
  constexpr double kW = 300.0;
  constexpr double kH = 90.0;
  const double bar = kW / static_cast<double>(bins);
  // Logarithmic, so that a single late edge among a million stays visible.
  const double top = std::log10(static_cast<double>(most)) + 1.0;
  std::string svg = fmt::format(
      "<figure><svg class=plot viewBox='-46 -12 {:.0f} {:.0f}' role=img aria-label='DIR set-up of "
      "{}'><rect class=frame x=0 y=0 width={:.0f} height={:.0f} />",
      kW + 56.0, kH + 28.0, escapeHtml(timing.axis), kW, kH);
  for (std::size_t i = 0; i < std::min(bins, timing.setup_histogram.size()); ++i) {
    const std::uint64_t count = timing.setup_histogram[i];
    if (count == 0) continue;
    const double height = kH * (std::log10(static_cast<double>(count)) + 1.0) / top * 0.94;
    const bool late =
        static_cast<double>(i + 1) * timing.setup_bin_s <= timing.profile.setup_s * (1.0 + 1e-9);
    svg += fmt::format(
        "<rect class={} x={:.2f} y={:.1f} width={:.2f} height={:.1f} ><title>{} pulses</title></rect>",
        late ? "barbad" : "bar", static_cast<double>(i) * bar, kH - height, std::max(0.85 * bar, 0.8), height,
        count);
  }
  const double limit_x = timing.profile.setup_s / timing.setup_bin_s * bar;
  svg += fmt::format(
      "<line class=lim x1={:.1f} x2={:.1f} y1=-2 y2={:.0f} /><text class=tick x={:.1f} y=-4 "
      "text-anchor=middle>{:.3g} µs</text><text class=tick x=0 y={:.0f}>0</text><text class=tick x={:.0f} "
      "y={:.0f} text-anchor=end>{:.3g} µs{}</text><text class=tick x=-4 y=8 text-anchor=end>{}</text>"
      "<text class=tick x=-4 y={:.0f} text-anchor=end>0</text></svg>"
      "<figcaption>{}: pulses over DIR set-up, logarithmic</figcaption></figure>",
      limit_x, limit_x, kH, limit_x, 1e6 * timing.profile.setup_s, kH + 13.0, kW, kH + 13.0,
      1e6 * static_cast<double>(bins) * timing.setup_bin_s, open ? " and more" : "", most, kH,
      escapeHtml(timing.axis));
  return svg;
}

std::string timeCell(double seen_s, double required_s, std::uint64_t violations) {
  const std::string seen = std::isfinite(seen_s) ? fmt::format("{:.3g}", 1e6 * seen_s) : "–";
  return fmt::format("<td class='num{}'>{} <small>≥ {:.3g}</small></td>", violations > 0 ? " hit" : "", seen,
                     1e6 * required_s);
}

}  // namespace

std::string pulseFigures(const RunReport& report) {
  if (report.pulses.empty()) return {};
  std::string html =
      "<table><thead><tr><th>Axis<th>Drive<th class=num>Pulses<th class=num>DIR set-up, µs<th class=num>DIR "
      "hold, µs<th class=num>Width, µs<th class=num>Space, µs<th class=num>Enable, µs<th "
      "class=num>Violations<th "
      "class=num>First, s</tr></thead><tbody>";
  std::string plots;
  for (const PulseTiming& t : report.pulses) {
    const std::uint64_t violations = t.setup_violations + t.hold_violations + t.width_violations +
                                     t.space_violations + t.enable_setup_violations + t.disabled_pulses;
    html += fmt::format("<tr><td>{}<td>{}<td class=num>{}", escapeHtml(t.axis), escapeHtml(t.profile.name),
                        t.pulses);
    html += timeCell(t.min_setup_s, t.profile.setup_s, t.setup_violations);
    html += timeCell(t.min_hold_s, t.profile.hold_s, t.hold_violations);
    html += timeCell(t.min_width_s, t.profile.width_s, t.width_violations);
    html += timeCell(t.min_space_s, t.profile.space_s, t.space_violations);
    html += t.has_enable ? timeCell(t.min_enable_setup_s, t.profile.enable_setup_s, t.enable_setup_violations)
                         : "<td class=num>–";
    html += fmt::format("<td class='num{}'>{}<td class=num>{}</tr>", violations > 0 ? " hit" : "", violations,
                        t.first_violation_s >= 0.0 ? fmt::format("{:.6f}", t.first_violation_s) : "–");
    if (t.pulses > 0 && !t.setup_histogram.empty() && t.setup_bin_s > 0.0) plots += histogram(t);
  }
  html += "</tbody></table>";
  if (!plots.empty()) html += "<div class=plots>" + plots + "</div>";
  return html;
}

}  // namespace kerfbench::report
