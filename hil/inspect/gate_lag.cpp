// SPDX-License-Identifier: Apache-2.0
// Does the laser come on when the beam sets off? The kerf alone hides a late gate where the end of an outline
// burns over its start; the spot's own motion does not.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "hil/inspect/checks.h"
#include "hil/inspect/extreme.h"
#include "hil/inspect/spot_checks.h"

namespace kerfbench::hil::checks {
namespace {

/// Stretch of the way from the start of a line in which the beam is taken to speed up evenly; the longer one
/// is tried first.
constexpr double kNearest_mm = 0.04;
constexpr std::array kFarthest_mm{2.0, 1.0};
constexpr std::size_t kMinFrames = 4;
/// Steps and servo make the motion this rough, whatever the camera sees; standard deviation.
constexpr double kRoughness_mm = 0.005;
/// Above this the motion was no even acceleration: a jerk-limited start, or a cut that goes on from another.
constexpr double kMaxChiSquare = 9.0;

struct Start {
  double lag_s{};  ///< Gate minus the instant at which the beam set off; > 0: the gate is late.
  double sigma_s{};
  int unit{};
  int entity{};
  double on_s{};
};

/// Arc length between an end of the curve (u = 0 or 1) and the place nearest to p.
double wayFromEnd(const Curve& curve, bool from_start, const Eigen::Vector2d& p_mm, double length_mm) {
  constexpr int kPieces = 32;
  const double u = nearestOn(curve, p_mm).u;
  // Chords of a piece this short differ from the arc by far less than the camera sees.
  double way_mm = 0.0;
  Eigen::Vector2d last = pointAt(curve, 0.0);
  for (int i = 1; i <= kPieces; ++i) {
    const Eigen::Vector2d next = pointAt(curve, u * i / kPieces);
    way_mm += (next - last).norm();
    last = next;
  }
  return from_start ? way_mm : length_mm - way_mm;
}

/// The frames of one gate interval that lie on the entity with which it begins, in order of time. Not one
/// run: where the beam is slow the laser is weak, and a frame may show nothing.
std::vector<const LitFrame*> framesOf(const LitFrames& lit, const GateInterval& gate) {
  std::vector<const LitFrame*> frames;
  for (const LitFrame& frame : lit.frames) {
    if (frame.time_s < gate.on_s || frame.time_s > gate.off_s) continue;
    if (frame.entity < 0 || frame.ambiguous) continue;
    if (!frames.empty() && (frame.entity != frames.front()->entity || frame.unit != frames.front()->unit))
      break;
    frames.push_back(&frame);
  }
  return frames;
}

/// s = a (t - t0)² / 2, so sqrt(s) is a straight line in time that meets zero at t0. Weighted least squares
/// over the frames of the first millimetre.
std::optional<Start> startWithin(double stretch_mm, const Evidence& evidence, const LitFrames& lit,
                                 const GateInterval& gate) {
  const double on_s = gate.on_s;
  const auto frames = framesOf(lit, gate);
  if (frames.size() < kMinFrames) return std::nullopt;
  const LitFrame& first = *frames.front();
  const Curve& curve = evidence.dieline->entities[static_cast<std::size_t>(first.entity)].curve;
  const double length_mm = lengthOf(curve);
  // From which end: the way must grow. On a closed curve both ends are one place.
  const bool forward = nearestOn(curve, frames[2]->p_S_mm).u > nearestOn(curve, first.p_S_mm).u ||
                       (isClosed(curve) && nearestOn(curve, frames[2]->p_S_mm).u < 0.5);
  // A line that ends in a corner is braked from its middle on.
  const double farthest_mm = std::min(stretch_mm, 0.4 * length_mm);
  double sw = 0, st = 0, sy = 0, stt = 0, sty = 0;
  std::vector<std::array<double, 3>> points;  // t, sqrt(s), weight
  for (const LitFrame* it : frames) {
    const LitFrame& frame = *it;
    const double way_mm = wayFromEnd(curve, forward, frame.p_S_mm, length_mm);
    if (way_mm > farthest_mm) continue;
    if (way_mm < kNearest_mm) continue;
    const double sigma_mm = std::hypot(std::max(frame.sigma_mm, evidence.spot_u_mm), kRoughness_mm);
    const double weight = 4.0 * way_mm / (sigma_mm * sigma_mm);
    const double t = frame.time_s - on_s;
    const double y = std::sqrt(way_mm);
    points.push_back({t, y, weight});
    sw += weight;
    st += weight * t;
    sy += weight * y;
    stt += weight * t * t;
    sty += weight * t * y;
  }
  if (points.size() < kMinFrames) return std::nullopt;
  const double determinant = sw * stt - st * st;
  const double slope = (sw * sty - st * sy) / determinant;
  const double offset = (stt * sy - st * sty) / determinant;
  if (!(slope > 0)) return std::nullopt;
  double chi_square = 0.0;
  for (const auto& [t, y, weight] : points)
    chi_square += weight * (y - offset - slope * t) * (y - offset - slope * t);
  if (chi_square > kMaxChiSquare * static_cast<double>(points.size() - 2)) return std::nullopt;
  const double t0 = -offset / slope;
  const double variance = (stt + sw * t0 * t0 - 2.0 * st * t0) / determinant / (slope * slope);
  return Start{-t0, std::sqrt(std::max(variance, 0.0)), first.unit, first.entity, on_s};
}

std::optional<Start> startOf(const Evidence& evidence, const LitFrames& lit, const GateInterval& gate) {
  for (const double stretch_mm : kFarthest_mm) {
    if (const auto start = startWithin(stretch_mm, evidence, lit, gate)) return start;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Check> gateLagCheck(const Evidence& evidence, const Limits& limits, const LitFrames& lit) {
  std::vector<Start> starts;
  for (const GateInterval& gate : evidence.gates) {
    const auto start = startOf(evidence, lit, gate);
    if (!start) continue;
    // A start that few frames saw is known too loosely to prove anything, unless it is far off.
    const bool usable = start->sigma_s <= 0.2 * limits.gate_lag_s;
    const bool far_off = std::abs(start->lag_s) - 4.0 * start->sigma_s > limits.gate_lag_s;
    if (usable || far_off) starts.push_back(*start);
  }
  if (starts.empty()) return std::nullopt;
  Check check{.name = "gate_lag", .title = "The laser comes on as the beam sets off", .unit = "ms"};
  check.limit = 1e3 * limits.gate_lag_s;
  ExtremeEstimate extreme(starts.size());
  std::vector<double> lags_ms;
  for (const Start& s : starts) {
    extreme.add(1e3 * s.lag_s, std::hypot(1e3 * s.sigma_s, 1e3 * evidence.pin_u_s));
    lags_ms.push_back(1e3 * s.lag_s);
  }
  const Start& worst = *std::max_element(starts.begin(), starts.end(), [](const Start& a, const Start& b) {
    return std::abs(a.lag_s) < std::abs(b.lag_s);
  });
  check.value = extreme.value();
  check.u = check.guard = extreme.expandedU();
  check.subject = nameOf(worst.unit, worst.entity);
  decide(check);
  const double median_ms = medianOf(lags_ms);
  check.explanation = fmt::format(
      "At {} starts the gate opened {:.2f} ms {} the beam set off, in the median; farthest off is {} at "
      "{:.3f} s with "
      "{:.2f} ms.",
      starts.size(), std::abs(median_ms), median_ms >= 0 ? "after" : "before", check.subject, worst.on_s,
      1e3 * worst.lag_s);
  return check;
}

}  // namespace kerfbench::hil::checks
