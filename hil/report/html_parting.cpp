// SPDX-License-Identifier: Apache-2.0
// Where the real machine and the model of it part.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "hil/report/html_text.h"
#include "hil/report/plot.h"

namespace kerfbench::report {
namespace {

constexpr std::size_t kMostPoints = 600;

double largestOf(const std::vector<SpotParting>& partings) {
  double largest_mm = 1e-3;
  for (const SpotParting& p : partings) largest_mm = std::max(largest_mm, p.worst_mm);
  return largest_mm;
}

std::string dotsOf(const Plot& plot, const std::vector<SpotParting>& partings,
                   std::vector<double> SpotParting::*values, const char* look) {
  std::size_t points = 0;
  for (const SpotParting& p : partings) points += p.time_s.size();
  const std::size_t stride = std::max<std::size_t>(1, points / kMostPoints);
  std::string d;
  for (const SpotParting& p : partings) {
    for (std::size_t i = 0; i < p.time_s.size(); i += stride)
      fmt::format_to(std::back_inserter(d), "M{:.1f} {:.1f}h0", plot.x(p.time_s[i]),
                     plot.y(1e3 * (p.*values)[i]));
  }
  return fmt::format("<path class='{}' d='{}'/>", look, d);
}

std::string figureOf(const std::vector<SpotParting>& partings) {
  const double most_um = 1.1e3 * largestOf(partings);
  const double from_s = partings.front().time_s.front();
  const double to_s = std::max(partings.back().time_s.back(), from_s + 1e-3);
  Plot plot(from_s, to_s, -most_um, most_um, "measured less model over time");
  plot.xTicks(ticks(from_s, to_s), "s", "{:.4g}");
  plot.yTicks(ticks(-most_um, most_um));
  plot.raw(dotsOf(plot, partings, &SpotParting::x_mm, "dots parting-x"));
  plot.raw(dotsOf(plot, partings, &SpotParting::y_mm, "dots parting-y"));
  return "<style>.parting-x,.parting-y{fill:none;stroke-width:2.5;stroke-linecap:round;stroke:#06c}"
         ".parting-y{stroke:#c60}</style>" +
         plot.figure("Measured spot less the model's, µm: along the belt blue, across it orange.");
}

}  // namespace

std::string partingSection(const RunReport& report) {
  const std::vector<SpotParting>& partings = report.model.partings;
  if (partings.empty()) return {};
  std::string html =
      "<h3>Where machine and model part</h3><p>The model ran along with the same pins. For information: "
      "no check judges this, and along the way it holds what the camera's clock is off by.</p>" +
      figureOf(partings) +
      "<table><thead><tr><th>Cut<th class=num>From, s<th class=num>Frames<th class=num>Mean x, mm<th "
      "class=num>Mean y, mm<th class=num>Largest, mm<th class=num>At, s</tr></thead><tbody>";
  const std::size_t rows = std::min(partings.size(), kMostRows);
  for (std::size_t i = 0; i < rows; ++i) {
    const SpotParting& p = partings[i];
    html += fmt::format(
        "<tr><td>unit {}, {}<td class=num>{:.3f}<td class=num>{}<td class=num>{:+.4f}<td class=num>{:+.4f}"
        "<td class=num>{:.4f}<td class=num>{:.3f}</tr>",
        p.unit, p.entity < 0 ? "no entity" : fmt::format("E{}", p.entity), p.time_s.front(), p.time_s.size(),
        p.mean_x_mm, p.mean_y_mm, p.worst_mm, p.worst_s);
  }
  html += "</tbody></table>";
  if (rows < partings.size())
    html += fmt::format("<p class=note>The first {} of {}.</p>", rows, partings.size());
  return html;
}

}  // namespace kerfbench::report
