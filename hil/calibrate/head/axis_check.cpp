// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/axis_check.h"

#include <algorithm>
#include <functional>
#include <vector>

#include <fmt/format.h>

#include "hil/calibrate/head/observation.h"
#include "hil/calibrate/head/spread.h"
#include "twin/base/statistics.h"
#include "twin/base/symmetric_eigen.h"

namespace kerfbench::calibrate {
namespace {

constexpr double kAgreesShare = 0.2;    // Share of the marks' spread within which a mark agrees with a map.
constexpr double kLeastAgreeing = 0.5;  // Share of the marks that must agree with the best map.
constexpr double kLeastLead = 0.1;  // Share of the marks by which it must lead the next map; at least two.
constexpr double kThinnest = 0.05;  // Width over length of the aims.

Eigen::Vector2d middleOf(const std::vector<Eigen::Vector2d>& points) {
  std::vector<double> x, y;
  for (const Eigen::Vector2d& p : points) {
    x.push_back(p.x());
    y.push_back(p.y());
  }
  return {upperMedianOf(x), upperMedianOf(y)};
}

/// Standard deviations of the aims along their longest and shortest axis, mm; the larger first.
Eigen::Vector2d spreadOf(std::span<const HeadObservation> observations) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const HeadObservation& o : observations) mean += o.aim_W_mm / static_cast<double>(observations.size());
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const HeadObservation& o : observations) {
    const Eigen::Vector2d d = o.aim_W_mm - mean;
    scatter += d * d.transpose() / static_cast<double>(observations.size());
  }
  const Eigen::Vector2d squares = SymmetricEigen<2>(scatter).values;
  return squares.cwiseMax(0.0).cwiseSqrt().reverse();
}

AxisFinding findingOf(const AxisMap& map, std::span<const HeadObservation> observations, double near_mm) {
  std::vector<Eigen::Vector2d> off;
  for (const HeadObservation& o : observations) off.emplace_back(o.measured_W_mm - map.matrix() * o.aim_W_mm);
  const Eigen::Vector2d shift = middleOf(off);
  std::vector<double> misses;
  for (const Eigen::Vector2d& d : off) misses.push_back((d - shift).norm());
  const auto agreeing = std::ranges::count_if(misses, [&](double miss) { return miss <= near_mm; });
  return {map, static_cast<std::size_t>(agreeing), 0, upperMedianOf(misses)};
}

}  // namespace

Eigen::Matrix2d AxisMap::matrix() const {
  Eigen::Matrix2d m = Eigen::Matrix2d::Identity();
  if (exchanged) m << 0.0, 1.0, 1.0, 0.0;
  if (x_backwards) m.row(0) *= -1.0;
  if (y_backwards) m.row(1) *= -1.0;
  return m;
}

std::string AxisMap::words() const {
  if (asTold()) return "x and y are as told";
  std::string text;
  if (exchanged) text += "x and y are exchanged";
  const auto add = [&](const char* words) { text += (text.empty() ? "" : "; ") + std::string(words); };
  if (x_backwards && y_backwards) {
    add("x and y run backwards");
  } else if (x_backwards || y_backwards) {
    add(x_backwards ? "x runs backwards" : "y runs backwards");
  }
  if (matrix().determinant() < 0.0) return text + ": the picture is mirrored";
  if (!exchanged) return text + ": the picture is turned by 180 degrees";
  return text + fmt::format(": the picture is turned by 90 degrees {}",
                            y_backwards ? "clockwise" : "counter-clockwise");
}

AxisFinding identifyAxes(std::span<const HeadObservation> observations) {
  if (observations.size() < kLeastMarks) {
    throw HeadCalibrationError(
        fmt::format("{} marks do not tell the axes, it takes {}", observations.size(), kLeastMarks));
  }
  const Eigen::Vector2d spread_mm = spreadOf(observations);
  if (!(spread_mm[1] > kThinnest * spread_mm[0]))
    throw HeadCalibrationError("all marks were aimed along one line: they do not tell the axes");
  std::vector<AxisFinding> findings;
  for (const bool exchanged : {false, true}) {
    for (const bool x_backwards : {false, true}) {
      for (const bool y_backwards : {false, true}) {
        findings.push_back(
            findingOf({exchanged, x_backwards, y_backwards}, observations, kAgreesShare * spread_mm[0]));
      }
    }
  }
  std::ranges::stable_sort(findings, std::greater(), &AxisFinding::agreeing);
  AxisFinding best = findings[0];
  best.next_agreeing = findings[1].agreeing;
  const auto count = static_cast<double>(observations.size());
  const auto lead = static_cast<double>(best.agreeing - best.next_agreeing);
  if (static_cast<double>(best.agreeing) <= kLeastAgreeing * count ||
      lead < std::max(2.0, kLeastLead * count)) {
    throw HeadCalibrationError(
        fmt::format("the marks fit neither as told nor turned or mirrored: at the best {} of {}, as the next "
                    "way {}. Are they of "
                    "this job, and of one sheet?",
                    best.agreeing, observations.size(), best.next_agreeing));
  }
  return best;
}

}  // namespace kerfbench::calibrate
