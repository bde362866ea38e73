// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/kerfplan/kerfplan_loop.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "firmware_under_test/planner/compensation/svg_sheet.h"
#include "firmware_under_test/planner/power/library.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

/// Periods that a loop has to settle in.
constexpr std::size_t kSettled = 40;
constexpr double kPaperGain = 1.0;

void require(const std::vector<double>& wanted_w, const LoopCase& loop) {
  if (!(loop.tube >= 0.5 && loop.tube <= 1.5))
    throw PowerError(fmt::format("--tube must be in 0.5 … 1.5, but is {:g}", loop.tube));
  if (loop.late_periods < 0 || loop.late_periods > 100)
    throw PowerError(fmt::format("--late must be in 0 … 100, but is {}", loop.late_periods));
  if (wanted_w.size() <= 2 * kSettled)
    throw PowerError(fmt::format("the marks last {} periods; a loop is judged from {} on", wanted_w.size(),
                                 2 * kSettled + 1));
}

std::string rowOf(const char* name, double gain, const std::vector<double>& shares) {
  double most = 0.0;
  double squares = 0.0;
  for (std::size_t k = kSettled; k < shares.size(); ++k) {
    most = std::max(most, std::abs(shares[k] - 1.0));
    squares += (shares[k] - 1.0) * (shares[k] - 1.0);
  }
  const double rms = std::sqrt(squares / static_cast<double>(shares.size() - kSettled));
  return fmt::format("  {:34}{:>8.3f}{:>12.2f}{:>12.2f}\n", name, gain, 100.0 * most, 100.0 * rms);
}

}  // namespace

std::string loopTable(const std::vector<double>& wanted_w, const LoopCase& loop) {
  require(wanted_w, loop);
  const auto course = [&](double gain, LoopLaw law) {
    return loopCourse(wanted_w, loop.tube, loop.late_periods, gain, law, loop.limits);
  };
  const double damped = dampedGain(loop.late_periods);
  std::string text = fmt::format(
      "a tube with {:g} of its nominal power, measured {} periods of {:g} ms late, over {} periods of marks\n"
      "  {:34}{:>8}{:>12}{:>12}\n",
      loop.tube, loop.late_periods, 1e3 * loop.period_s, wanted_w.size(), "law", "gain", "most off, %",
      "rms, %");
  text += rowOf("no loop", 0.0, course(0.0, LoopLaw::kWatts));
  text += rowOf("P(k+1) = P(k) + (P_out - P_f)", kPaperGain, course(kPaperGain, LoopLaw::kWatts));
  text += rowOf("P(k+1) = P(k) + gain (P_out - P_f)", damped, course(damped, LoopLaw::kWatts));
  return text + rowOf("the same in shares of P_out", damped, course(damped, LoopLaw::kShares));
}

std::string loopPlot(const std::vector<double>& wanted_w, const LoopCase& loop) {
  require(wanted_w, loop);
  constexpr double kWideMm = 240.0;
  constexpr double kHighMm = 110.0;
  constexpr double kTextMm = 4.0;
  const double most_w = *std::max_element(wanted_w.begin(), wanted_w.end()) * 1.3;
  const auto at = [&](std::size_t k, double power_w) {
    return Vector2d(kWideMm * static_cast<double>(k) / static_cast<double>(wanted_w.size() - 1),
                    kHighMm * std::min(power_w / most_w, 1.0));
  };
  SvgSheet sheet({Vector2d(-16.0, -14.0), Vector2d(kWideMm + 6.0, kHighMm + 12.0)}, 4.0);
  const auto draw = [&](const std::vector<double>& shares, const char* style) {
    std::vector<Vector2d> points;
    for (std::size_t k = 0; k < shares.size(); ++k) points.push_back(at(k, shares[k] * wanted_w[k]));
    sheet.polyline(points, style);
  };
  sheet.polyline({{0.0, kHighMm}, {0.0, 0.0}, {kWideMm, 0.0}}, "fill:none;stroke:#444;stroke-width:0.3");
  draw(loopCourse(wanted_w, loop.tube, loop.late_periods, kPaperGain, LoopLaw::kWatts, loop.limits),
       "fill:none;stroke:#d33;stroke-width:0.3");
  draw(loopCourse(wanted_w, loop.tube, loop.late_periods, dampedGain(loop.late_periods), LoopLaw::kShares,
                  loop.limits),
       "fill:none;stroke:#26c;stroke-width:0.6");
  draw(std::vector<double>(wanted_w.size(), 1.0), "fill:none;stroke:#000;stroke-width:0.25");
  sheet.text(
      {2.0, kHighMm + 6.0}, kTextMm,
      fmt::format("power, to {:.0f} W: black wanted, red P(k+1) = P(k) + (P_out - P_f), blue with gain "
                  "{:.3f}",
                  most_w, dampedGain(loop.late_periods)));
  sheet.text({2.0, -10.0}, kTextMm,
             fmt::format("time, to {:.3f} s; a tube with {:g} of its power, measured {} periods late",
                         loop.period_s * static_cast<double>(wanted_w.size()), loop.tube, loop.late_periods));
  return sheet.finish();
}

}  // namespace kerfbench::planner
