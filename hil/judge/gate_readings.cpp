// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/gate_readings.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Dense>

#include "hil/inspect/evidence/emitted_light.h"

namespace kerfbench::judge {
namespace {

constexpr double kPitch_s = 2e-4;
constexpr double kLeastAround_s = 0.04;
/// Stretch of the ramp that is looked at, from where steps no longer hide how the beam sets off.
/// A beam that speeds up more slowly is off by microns for a millisecond: steps hide when it sets off.
constexpr double kQuick_mm_s2 = 5000.0;
constexpr double kNearest_mm = 0.03;
constexpr double kFarthest_mm = 0.6;

/// Instant at which a motion out of rest began, from places along its way: of d = ½ a (t - t0)² the top of
/// the parabola that fits best.
std::optional<double> setOff(const std::vector<double>& time_s, const std::vector<double>& way_mm) {
  if (time_s.size() < 6) return std::nullopt;
  Eigen::MatrixX3d columns(static_cast<Eigen::Index>(time_s.size()), 3);
  Eigen::VectorXd way(columns.rows());
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    const double t = time_s[static_cast<std::size_t>(i)] - time_s.front();
    columns.row(i) << 1.0, t, t * t;
    way(i) = way_mm[static_cast<std::size_t>(i)];
  }
  const Eigen::Vector3d c = columns.colPivHouseholderQr().solve(way);
  if (!(c[2] > 0.0)) return std::nullopt;
  return time_s.front() - 0.5 * c[1] / c[2];
}

/// One end of a cut: the instant at which the beam leaves it, or comes to it where `sense` is -1.
std::optional<double> restAt(const TimedCuts::Cut& cut, const AskedPath& asked, const SheetPath& sheet,
                             int sense, const CutOrder& order) {
  const double edge_s = sense > 0 ? cut.on_s : cut.off_s;
  const auto placeAt = [&](double time_s) -> std::optional<Eigen::Vector2d> {
    const diagnose::HeadState head = asked.at(time_s);
    if (!head.known()) return std::nullopt;
    return sheet.inSheet(cut.unit, time_s, head.p_mm);
  };
  const bool at_begin = (sense > 0) != cut.reversed;
  const planner::Segment& segment = at_begin ? cut.piece->segments.front() : cut.piece->segments.back();
  const double length_mm = segment.lengthMm();
  const Eigen::Vector2d end_mm = at_begin ? segment.start_mm : segment.end_mm;
  const Eigen::Vector2d inwards =
      at_begin ? segment.tangentAt(0.0) : Eigen::Vector2d(-segment.tangentAt(length_mm));
  const double ramp_mm = 0.5 * order.speed_mm_s * order.speed_mm_s / order.acceleration_mm_s2;
  const double farthest_mm = std::min({kFarthest_mm, 0.6 * ramp_mm, 0.3 * length_mm});
  const double around_s =
      std::max(kLeastAround_s, 1.5 * std::sqrt(2.0 * farthest_mm / order.acceleration_mm_s2));
  std::vector<double> times_s, way_mm;
  // Begin well inside of the cut and go back to its end, so that what comes before is not taken for it.
  double at_s = edge_s + sense * around_s;
  bool inside = false;
  for (int i = 0; i < static_cast<int>(2.0 * around_s / kPitch_s); ++i, at_s -= sense * kPitch_s) {
    const auto p_mm = placeAt(at_s);
    if (!p_mm) continue;
    const double way = (*p_mm - end_mm).dot(inwards);
    if (way > farthest_mm) {
      if (times_s.empty()) inside = true;
      continue;
    }
    if (way < kNearest_mm) {
      if (inside) break;
      continue;
    }
    if (!inside) continue;
    times_s.push_back(sense * at_s);
    way_mm.push_back(way);
  }
  std::ranges::reverse(times_s);
  std::ranges::reverse(way_mm);
  const auto found = setOff(times_s, way_mm);
  if (!found || std::abs(*found - sense * edge_s) > around_s) return std::nullopt;
  return sense * *found;
}

double wayOf(const TimedCuts::Cut& cut) {
  // Sum of chords that are long enough not to be lengthened by steps.
  constexpr std::size_t kStride = 8;
  double way_mm = 0.0;
  for (std::size_t i = 0; i + 1 < cut.p_S_mm.size(); i += kStride) {
    const std::size_t next = std::min(i + kStride, cut.p_S_mm.size() - 1);
    way_mm += (cut.p_S_mm[next] - cut.p_S_mm[i]).norm();
  }
  return way_mm;
}

}  // namespace

std::vector<diagnose::GateReading> gateReadings(const TimedCuts& cuts, const AskedPath& asked,
                                                const SheetPath& sheet,
                                                const std::vector<inspect::Span>& light,
                                                const CutOrder& order) {
  constexpr double kLong_mm = 2.0;
  std::vector<diagnose::GateReading> readings;
  if (!cuts.paired()) return readings;
  const inspect::EmittedLight emitted(light);
  for (const TimedCuts::Cut& cut : cuts.cuts()) {
    diagnose::GateReading reading;
    reading.unit = cut.unit;
    reading.entity = cut.piece->firstEntity();
    const bool is_quick = order.acceleration_mm_s2 >= kQuick_mm_s2;
    if (const auto begins_s = is_quick ? restAt(cut, asked, sheet, +1, order) : std::nullopt)
      reading.open_late_s = cut.on_s - *begins_s;
    if (const auto ends_s = is_quick ? restAt(cut, asked, sheet, -1, order) : std::nullopt)
      reading.close_late_s = cut.off_s - *ends_s;
    const double way_mm = wayOf(cut);
    if (order.energy_j_mm > 0.0 && way_mm > kLong_mm && cut.piece->z > 0.0)
      reading.energy_share = order.full_power_w * emitted.between(cut.on_s, cut.off_s) / way_mm /
                             (order.energy_j_mm * cut.piece->z);
    readings.push_back(reading);
  }
  return readings;
}

std::vector<diagnose::PowerRun> powerRuns(const TimedCuts& cuts, const std::vector<inspect::Span>& light) {
  // Whole steps make the speed of a single span uneven.
  constexpr std::ptrdiff_t kAround = 8;
  std::vector<diagnose::PowerRun> runs;
  const inspect::EmittedLight emitted(light);
  for (const TimedCuts::Cut& cut : cuts.cuts()) {
    std::vector<Eigen::Vector2d> p_mm;
    diagnose::PowerRun run;
    std::size_t next = 0;
    for (double at_s = cut.on_s; at_s + diagnose::kPowerSpan_s <= cut.off_s; at_s += diagnose::kPowerSpan_s) {
      while (next < cut.time_s.size() && cut.time_s[next] < at_s) ++next;
      if (next == cut.time_s.size()) break;
      p_mm.push_back(cut.p_S_mm[next]);
      run.light_share.push_back(emitted.between(at_s, at_s + diagnose::kPowerSpan_s) /
                                diagnose::kPowerSpan_s);
    }
    const auto count = static_cast<std::ptrdiff_t>(p_mm.size());
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      const auto from = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, i - kAround));
      const auto to = static_cast<std::size_t>(std::min(count - 1, i + kAround));
      const double way_mm = (p_mm[to] - p_mm[from]).norm();
      run.speed_mm_s.push_back(to > from ? way_mm / (static_cast<double>(to - from) * diagnose::kPowerSpan_s)
                                         : 0.0);
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

}  // namespace kerfbench::judge
