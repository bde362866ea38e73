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
#include <Eigen/Dense>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "hil/inspect/checks/spot_checks.h"
#include "hil/inspect/evidence/extreme.h"
#include "twin/base/statistics.h"

namespace kerfbench::inspect::checks {
namespace {

/// Stretch of the way from the start of a line in which the beam is taken to speed up evenly; the longer one
/// is tried first.
constexpr double kNearest_mm = 0.04;
constexpr std::array kFarthest_mm{2.0, 1.0};
constexpr std::size_t kMinLagFrames = 4;
/// Steps and servo make the motion this rough, whatever the camera sees; standard deviation.
constexpr double kRoughness_mm = 0.005;
/// Above this the motion was neither of the two: a jerk-limited start, or a cut that goes on from another.
constexpr double kMaxChiSquare = 9.0;

/// Drop of chi square that justifies the extra parameter of a start at speed; by chance one start in forty
/// has it.
constexpr double kClearlyBetter = 6.0;

/// A line shorter than this may have no frame that is its own.
constexpr double kShortest_mm = 1.0;
/// An instant so far from the gate comes from a motion that was not seen, but guessed from later frames.
constexpr double kFarthestLag_s = 0.05;

struct Start {
  double lag_s{};  ///< Gate minus the instant at which the beam set off; > 0: the gate is late.
  double sigma_s{};
  int unit{};
  int entity{};
  double on_s{};
};

/// Arc length between an end of the curve (u = 0 or 1) and the place nearest to p.
double wayFromEnd(const dieline::Curve& curve, bool from_start, const Eigen::Vector2d& p_mm) {
  constexpr int kPieces = 32;
  const double end = from_start ? 0.0 : 1.0;
  const double span = dieline::nearestOn(curve, p_mm).u - end;
  // Over the two millimetres that count, chords this short differ from the arc by far less than the camera
  // sees; round a whole circle they do not.
  double way_mm = 0.0;
  Eigen::Vector2d last = dieline::pointAt(curve, end);
  for (int i = 1; i <= kPieces; ++i) {
    const Eigen::Vector2d next = dieline::pointAt(curve, end + span * i / kPieces);
    way_mm += (next - last).norm();
    last = next;
  }
  return way_mm;
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

/// Whether the cut may have begun on another line than `used`, from whose start (u = 0 or 1) the beam is seen
/// to come: the camera's first frame of the cut lies on another, or a line too short for frames of its own
/// ends there.
bool beginsElsewhere(const Evidence& evidence, const LitFrames& lit, const GateInterval& gate,
                     const LitFrame& used, double start_u) {
  auto first = std::ranges::lower_bound(lit.frames, gate.on_s, {}, &LitFrame::time_s);
  while (first != lit.frames.end() && first->time_s <= gate.off_s && first->entity < 0) ++first;
  if (first == lit.frames.end() || first->entity != used.entity || first->unit != used.unit) return true;
  const auto& entities = evidence.dieline->entities;
  const Eigen::Vector2d start_mm =
      dieline::pointAt(entities[static_cast<std::size_t>(used.entity)].curve, start_u);
  return std::ranges::any_of(entities, [&](const dieline::Entity& other) {
    if (other.id == used.entity || other.process == dieline::Process::kIgnore) return false;
    if (dieline::lengthOf(other.curve) > kShortest_mm) return false;
    return std::ranges::any_of(std::array{0.0, 1.0}, [&](double u) {
      return (dieline::pointAt(other.curve, u) - start_mm).norm() <= kMeet_mm;
    });
  });
}

/// How the beam sets off: from rest, speeding up evenly, s = a (t - t0)² / 2, or at once with its full speed,
/// s = v (t - t0), as a firmware without ramps moves mirrors. Either way s^(1/power) is a straight line in
/// time that meets zero at t0.
struct Place {
  double t_s{};     ///< Since the gate opened.
  double way_mm{};  ///< From the start of the line.
  double sigma_mm{};
};

struct Fit {
  double t0_s{};
  double sigma_s{};
  double chi_square{std::numeric_limits<double>::infinity()};
};

/// Weighted least squares over the places beyond kNearest_mm; those before must fit in as well.
Fit fitMotion(const std::vector<Place>& places, double power) {
  double sw = 0, st = 0, sy = 0, stt = 0, sty = 0;
  const auto weightOf = [&](const Place& p) {
    const double slope = power * std::pow(p.way_mm, 1.0 - 1.0 / power) / p.sigma_mm;
    return slope * slope;
  };
  for (const Place& p : places) {
    if (p.way_mm < kNearest_mm) continue;
    const double weight = weightOf(p);
    const double y = std::pow(p.way_mm, 1.0 / power);
    sw += weight;
    st += weight * p.t_s;
    sy += weight * y;
    stt += weight * p.t_s * p.t_s;
    sty += weight * p.t_s * y;
  }
  const double determinant = sw * stt - st * st;
  const double slope = (sw * sty - st * sy) / determinant;
  const double offset = (stt * sy - st * sty) / determinant;
  if (!(slope > 0)) return {};
  Fit fit{-offset / slope, 0.0, 0.0};
  for (const Place& p : places) {
    const double expected = std::max(offset + slope * p.t_s, 0.0);
    if (p.way_mm < kNearest_mm) {
      const double off = (p.way_mm - std::pow(expected, power)) / p.sigma_mm;
      fit.chi_square += off * off;
    } else {
      const double off = std::pow(p.way_mm, 1.0 / power) - offset - slope * p.t_s;
      fit.chi_square += weightOf(p) * off * off;
    }
  }
  const double variance =
      (stt + sw * fit.t0_s * fit.t0_s - 2.0 * st * fit.t0_s) / determinant / (slope * slope);
  fit.sigma_s = std::sqrt(std::max(variance, 0.0));
  return fit;
}

/// Chi square of a beam that comes out of a jump without a stop: it meets the start of the line at a speed of
/// its own, which then changes, s = v (t - t0) + a (t - t0)² / 2. Rest and full speed are limits of it, late
/// or not.
double chiSquareThrough(const std::vector<Place>& places) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double square = 0.0;
  for (const Place& p : places) {
    if (p.way_mm < kNearest_mm) continue;
    const Eigen::Vector3d row = Eigen::Vector3d(1.0, p.t_s, p.t_s * p.t_s) / p.sigma_mm;
    normal += row * row.transpose();
    right += row * (p.way_mm / p.sigma_mm);
    square += std::pow(p.way_mm / p.sigma_mm, 2);
  }
  return square - right.dot(normal.ldlt().solve(right));
}

std::optional<Start> startWithin(double stretch_mm, const Evidence& evidence, const LitFrames& lit,
                                 const GateInterval& gate) {
  const auto frames = framesOf(lit, gate);
  if (frames.size() < kMinLagFrames) return std::nullopt;
  const LitFrame& first = *frames.front();
  const dieline::Entity& entity = evidence.dieline->entities[static_cast<std::size_t>(first.entity)];
  // The teeth of a perforation begin in full run.
  if (entity.process == dieline::Process::kPerforation) return std::nullopt;
  const dieline::Curve& curve = entity.curve;
  const double length_mm = dieline::lengthOf(curve);
  // From which end: the way must grow. On a closed curve both ends are one place.
  const double third_u = dieline::nearestOn(curve, frames[2]->p_S_mm).u;
  const bool forward =
      dieline::isClosed(curve) ? third_u < 0.5 : third_u > dieline::nearestOn(curve, first.p_S_mm).u;
  if (beginsElsewhere(evidence, lit, gate, first, forward ? 0.0 : 1.0)) return std::nullopt;
  // A line that ends in a corner is braked from its middle on.
  const double farthest_mm = std::min(stretch_mm, 0.4 * length_mm);
  std::vector<Place> places;
  std::size_t fitted = 0;
  for (const LitFrame* frame : frames) {
    const double way_mm = wayFromEnd(curve, forward, frame->p_S_mm);
    if (way_mm > farthest_mm) continue;
    const double sigma_mm = std::hypot(frame->sigma_mm, kRoughness_mm);
    places.push_back({frame->time_s - gate.on_s, way_mm, sigma_mm});
    fitted += way_mm >= kNearest_mm ? 1 : 0;
  }
  if (fitted < kMinLagFrames) return std::nullopt;
  const Fit ramp = fitMotion(places, 2.0);
  const Fit dash = fitMotion(places, 1.0);
  // How fast it came is not known well enough to say when; the kerf's own ends tell of a late gate there.
  if (chiSquareThrough(places) + kClearlyBetter < std::min(ramp.chi_square, dash.chi_square))
    return std::nullopt;
  // A start with limited jerk, s ~ t³, passes for an even one where few frames saw it, with a wrong t0.
  if (fitMotion(places, 3.0).chi_square < std::min(ramp.chi_square, dash.chi_square)) return std::nullopt;
  const double worst_chi_square = kMaxChiSquare * static_cast<double>(fitted - 2);
  // Where both fit, too little was seen to say how the beam set off, and they disagree on when.
  if ((ramp.chi_square <= worst_chi_square) == (dash.chi_square <= worst_chi_square)) return std::nullopt;
  const Fit& better = dash.chi_square < ramp.chi_square ? dash : ramp;
  if (std::abs(better.t0_s) > kFarthestLag_s) return std::nullopt;
  return Start{-better.t0_s, better.sigma_s, first.unit, first.entity, gate.on_s};
}

std::optional<Start> startOf(const Evidence& evidence, const LitFrames& lit, const GateInterval& gate) {
  for (const double stretch_mm : kFarthest_mm) {
    if (const auto start = startWithin(stretch_mm, evidence, lit, gate)) return start;
  }
  return std::nullopt;
}

}  // namespace

Finding gateLagCheck(const Evidence& evidence, const Tolerances& limits, const LitFrames& lit) {
  Check check{.name = "gate_lag", .title = "The laser comes on as the beam sets off", .unit = "ms"};
  std::vector<Start> starts;
  for (const GateInterval& gate : evidence.gates) {
    const auto start = startOf(evidence, lit, gate);
    if (!start) continue;
    // A start that few frames saw is known too loosely to prove anything, unless it is far off.
    const bool usable =
        start->sigma_s <= 0.2 * limits.gate_lag_s && evidence.clock_bound_s <= 0.5 * limits.gate_lag_s;
    const bool far_off =
        std::abs(start->lag_s) - 4.0 * start->sigma_s - evidence.clock_bound_s > limits.gate_lag_s;
    if (usable || far_off) starts.push_back(*start);
  }
  if (starts.empty())
    return notJudged(
        check, fmt::format("Of {} openings of the gate none is seen well enough: a start from rest or at "
                           "full speed in at least {} frames is needed, and the clocks of camera and pins "
                           "within {:g} ms.",
                           evidence.gates.size(), kMinLagFrames, 0.5e3 * limits.gate_lag_s));
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
  // The clocks' relation is off alike at all starts.
  check.u = check.guard = extreme.expandedU() + 1e3 * evidence.clock_bound_s;
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

}  // namespace kerfbench::inspect::checks
