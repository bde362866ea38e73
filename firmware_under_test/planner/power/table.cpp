// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "firmware_under_test/planner/power/model.h"

namespace kerfbench::planner {

std::vector<double> tableSpeeds(const PowerModel& model, double depth_mm) {
  constexpr double kSlowest_mm_s = 1.0;
  constexpr double kFastest_mm_s = 1e6;
  const PowerModel::Speeds range = model.speedsFor(depth_mm);
  const double lowest = std::min(range.lowest_mm_s, kFastest_mm_s);
  const double highest = std::min(range.highest_mm_s, kFastest_mm_s);
  std::vector<double> speeds{highest};
  if (lowest > 0.0) speeds.push_back(lowest);
  double decade = std::pow(10.0, std::floor(std::log10(std::max(lowest / 2.0, kSlowest_mm_s))));
  for (bool on = true; on; decade *= 10.0) {
    for (const double step : {1.0, 2.0, 5.0}) {
      if (!on || decade * step < lowest / 2.5) continue;
      speeds.push_back(decade * step);
      on = decade * step <= highest;
    }
  }
  std::sort(speeds.begin(), speeds.end());
  speeds.erase(std::unique(speeds.begin(), speeds.end()), speeds.end());
  return speeds;
}

std::string powerTable(const PowerModel& model, double depth_mm, const std::vector<double>& speeds_mm_s) {
  const LaserTube& laser = model.laser();
  const PowerModel::Speeds range = model.speedsFor(depth_mm);
  std::string text = fmt::format(
      "{} with {}, spot {:g} mm: {:g} mm deep from {:.4g} to {:.4g} mm/s\n"
      "  speed mm/s  P_ua J/mm2     P_out W  {:>10}  byte    depth mm\n",
      model.material().name, laser.name, model.wish().spot_diameter_mm, depth_mm, range.lowest_mm_s,
      range.highest_mm_s, "u " + laser.control_unit);
  for (const double speed : speeds_mm_s) {
    const PowerModel::Setting s = model.at(speed, depth_mm);
    const std::uint8_t byte = model.byteFor(s.control);
    text += fmt::format("{:12.4g}{:12.4g}{:12.4g}{:12.4g}{:6d}{:12.4g}", speed, s.p_ua_j_mm2, s.power_w,
                        s.control, byte, model.depthBy(model.powerOf(byte), speed));
    if (s.limit == PowerModel::Limit::kLeast)
      text += fmt::format("  least power, {:.4g} W wanted: too deep", s.wanted_w);
    if (s.limit == PowerModel::Limit::kMost)
      text += fmt::format("  most power, {:.4g} W wanted: not deep enough", s.wanted_w);
    text += '\n';
  }
  return text;
}

}  // namespace kerfbench::planner
