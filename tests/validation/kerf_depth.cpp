// SPDX-License-Identifier: Apache-2.0
// Depth of a straight cut by S3: D = f(P_ua), P_ua = P / (F d).
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "tests/validation/studies.h"
#include "tests/validation/support/svg.h"
#include "twin/laser/laser.h"
#include "twin/sheet/sheet.h"

namespace kerfbench::validation {
namespace {

using twin::Footprint;
using twin::Sheet;

constexpr double kRadius_mm = 0.105;
constexpr double kBurnStep_s = 10e-6;
constexpr double kCut_mm = 4.0;

// Board with a curve like S3's figure 1: steep first, then saturating. The threshold is that of board.
twin::BoardDescription board() {
  twin::BoardDescription result;
  result.thickness_mm = 0.4;
  result.cut_fluence_j_mm2 = 0.5;
  result.depth_curve = {{0.06, 0.0}, {0.15, 0.26}, {0.25, 0.46}, {0.37, 0.62},
                        {0.5, 0.75}, {0.67, 0.87}, {0.83, 0.95}, {1.0, 1.0}};
  return result;
}

// Function f of S3, on P_ua in J/mm² (W/mm over mm/s): straight pieces between the points. A Gaussian spot of
// 1/e² radius w, d = 2 w, leaves 2 sqrt(2/pi) P_ua on the line's centre.
double paperDepth(const twin::BoardDescription& board, double p_ua_j_mm2) {
  const double share = 2.0 * std::sqrt(2.0 / std::numbers::pi) * p_ua_j_mm2 / board.cut_fluence_j_mm2;
  const auto& f = board.depth_curve;
  if (share <= f.front().fluence_share) return 0.0;
  for (std::size_t i = 1; i < f.size(); ++i) {
    if (share > f[i].fluence_share) continue;
    const double t = (share - f[i - 1].fluence_share) / (f[i].fluence_share - f[i - 1].fluence_share);
    return f[i - 1].depth_share + t * (f[i].depth_share - f[i - 1].depth_share);
  }
  return 1.0;
}

struct Cut {
  double power_w, speed_mm_s, turn_rad;
};

// Largest and mean depth error along the middle of a cut, over the board's thickness.
struct DepthError {
  double p_ua{}, wanted{}, mean{}, worst{};
};

DepthError cutOnce(const Cut& cut) {
  Sheet sheet(board());
  twin::LaserDescription tube;
  tube.full_power_w = cut.power_w;
  twin::Laser laser(tube, 1);
  double now_s = 0.0;
  // The tube has long come up: the rest is a property of the sheet alone.
  for (; now_s < 100.0 * tube.rise_time_s; now_s += kBurnStep_s) laser.step(1.0, now_s, kBurnStep_s);
  const Eigen::Vector2d along(std::cos(cut.turn_rad), std::sin(cut.turn_rad));
  const Eigen::Vector2d start(3.137, -2.719);  // The start is on no node of the map.
  const auto at = [&](double travel_mm) {
    Footprint spot;
    spot.p_SQ_mm = start + travel_mm * along;
    spot.radius_x_mm = spot.radius_y_mm = kRadius_mm;
    return spot;
  };
  const double stride_mm = cut.speed_mm_s * kBurnStep_s;
  const auto steps = static_cast<int>(std::ceil(kCut_mm / stride_mm));
  for (int i = 0; i < steps; ++i) {
    sheet.burn(at(i * stride_mm), at((i + 1) * stride_mm), laser.step(1.0, now_s, kBurnStep_s));
    now_s += kBurnStep_s;
  }
  DepthError error;
  error.p_ua = cut.power_w / (cut.speed_mm_s * 2.0 * kRadius_mm);
  error.wanted = paperDepth(board(), error.p_ua);
  constexpr int kStations = 201;
  for (int i = 0; i < kStations; ++i) {
    const double depth =
        sheet.depthAt(start + (1.0 + (kCut_mm - 2.0) * i / (kStations - 1.0)) * along) - error.wanted;
    error.mean += depth / kStations;
    raiseTo(error.worst, std::abs(depth));
  }
  return error;
}

double powerCurveError() {
  twin::LaserDescription tube;
  tube.full_power_w = 80.0;  // Tube of S3's figure 2.
  tube.power_curve = {{0.0, 0.0}, {0.2, 0.33}, {0.4, 0.6}, {0.6, 0.8}, {0.8, 0.93}, {1.0, 1.0}};
  double worst = 0.0;
  for (int i = 0; i <= 50; ++i) {
    const double u = i / 50.0;
    twin::Laser laser(tube, 1);
    double energy_j = 0.0;
    for (int k = 0; k < 400; ++k) energy_j = laser.step(u, k * kBurnStep_s, kBurnStep_s);
    const auto& g = tube.power_curve;
    std::size_t piece = 1;
    while (g[piece].demand < u) ++piece;
    const double t = (u - g[piece - 1].demand) / (g[piece].demand - g[piece - 1].demand);
    const double wanted_w = 80.0 * (g[piece - 1].share + t * (g[piece].share - g[piece - 1].share));
    raiseTo(worst, std::abs(energy_j / kBurnStep_s - wanted_w) / 80.0);
  }
  return worst;
}

}  // namespace

Section kerfDepth(const Context& context) {
  const bool quick = context.effort == Effort::kQuick;
  const std::vector<double> powers_w = quick ? std::vector{60.0} : std::vector{20.0, 60.0, 100.0};
  const std::vector<double> speeds_mm_s =
      quick ? std::vector{300.0, 2400.0}
            : std::vector{100.0, 200.0, 300.0, 400.0, 600.0, 800.0, 1200.0, 1600.0, 2400.0, 4000.0};
  PlotLine curve{"f of the board", {}};
  for (int i = 0; i <= 200; ++i) {
    const double p_ua = 0.4 * i / 200.0;
    curve.points.emplace_back(p_ua, paperDepth(board(), p_ua));
  }
  LinePlot plot{
      "Depth of a straight cut", {"P_ua, J/mm²", false, 0.0, 0.4}, {"depth over thickness"}, {curve}};
  double worst = 0.0;
  double worst_mean = 0.0;
  int cuts = 0;
  std::vector<std::vector<std::string>> rows;
  for (const double power_w : powers_w) {
    PlotLine dots{fmt::format("{:g} W", power_w), {}, false, true};
    for (const double speed_mm_s : speeds_mm_s) {
      DepthError largest;
      for (const double turn_deg : {0.0, 30.0, 45.0, 90.0}) {
        const DepthError error = cutOnce({power_w, speed_mm_s, turn_deg * std::numbers::pi / 180.0});
        if (error.worst >= largest.worst) largest = error;
        raiseTo(worst, error.worst);
        raiseTo(worst_mean, std::abs(error.mean));
        ++cuts;
      }
      dots.points.emplace_back(largest.p_ua, largest.wanted + largest.mean);
      rows.push_back({fmt::format("{:g} W", power_w), fmt::format("{:g}", speed_mm_s),
                      fmt::format("{:.4f}", largest.p_ua), fmt::format("{:.4f}", largest.wanted),
                      fmt::format("{:+.5f}", largest.mean), fmt::format("{:.5f}", largest.worst)});
    }
    plot.lines.push_back(dots);
  }
  Section section;
  section.title = "Depth of the kerf against S3's curve";
  section.markdown = fmt::format(
      "{} straight cuts, four directions for each power and speed, off the nodes of the map; 201 stations on "
      "the middle\nof each. P_ua = P / (F d) with d = {:g} mm; depth and its errors over the board's "
      "thickness, of the worst direction.\n\n",
      cuts, 2.0 * kRadius_mm);
  section.markdown +=
      markdownTable({"power", "speed, mm/s", "P_ua, J/mm²", "f(P_ua)", "mean error", "largest error"}, rows);
  section.atMost("largest error of depth at any station, over the thickness", worst, 0.01, "");
  section.atMost("largest mean error of a cut, over the thickness", worst_mean, 0.01, "");
  section.atMost("power of the tube at rest against its curve g(u), over full power", powerCurveError(), 1e-6,
                 "", 1e-9);
  section.figures.push_back({"kerf-depth", "Depth of straight cuts over power per area", svgOf(plot)});
  return section;
}

}  // namespace kerfbench::validation
