// SPDX-License-Identifier: Apache-2.0
// Does the laser come on when the beam sets off? The kerf alone hides a late gate where the end of an outline
// burns over its start; the spot's own motion does not.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Dense>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "hil/inspect/checks/interval_words.h"
#include "hil/inspect/checks/set_off.h"
#include "hil/inspect/checks/spot_checks.h"
#include "hil/inspect/checks/start_place.h"
#include "hil/inspect/evidence/extreme.h"
#include "hil/inspect/evidence/whereabouts.h"
#include "twin/base/statistics.h"

namespace kerfbench::inspect::checks {
namespace {

/// Stretch of the way from the start of a line in which the beam's motion is looked at; the longer one is
/// tried first.
constexpr std::array kFarthest_mm{2.0, 1.0};
constexpr std::size_t kMinLagFrames = 4;
/// Steps and servo make the motion this rough, whatever the camera sees; standard deviation.
constexpr double kRoughness_mm = 0.005;
/// Above this the motion was none of these: a jerk-limited start, or a cut that goes on from another.
constexpr double kMaxChiSquare = 9.0;

/// A line shorter than this may have no frame that is its own.
constexpr double kShortest_mm = 1.0;

struct Start {
  double lag_s{};         ///< Gate minus the instant at which the beam set off; > 0: the gate is late.
  double sigma_s{};       ///< Standard uncertainty by the frames.
  double rest_sigma_s{};  ///< The same by where the beam rested before.
  int unit{};
  int entity{};
  double on_s{};
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};  ///< Where the line begins on the sheet.
};

/// Arc length from an end of the curve (u = 0 or 1) inwards to the place nearest to p. Before that end, as
/// far before it along its tangent: < 0.
double wayFromEnd(const dieline::Curve& curve, bool from_start, const Eigen::Vector2d& p_mm) {
  constexpr int kPieces = 32;
  const double end = from_start ? 0.0 : 1.0;
  const double span = dieline::nearestOn(curve, p_mm).u - end;
  const Eigen::Vector2d end_mm = dieline::pointAt(curve, end);
  if (span == 0.0) {
    const Eigen::Vector2d inward = (from_start ? 1.0 : -1.0) * dieline::tangentAt(curve, end);
    return std::min(0.0, inward.dot(p_mm - end_mm));
  }
  // Over the two millimetres that count, chords this short differ from the arc by far less than the camera
  // sees.
  double way_mm = 0.0;
  Eigen::Vector2d last = end_mm;
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

/// Whether the beam runs from u = 0 on; else from u = 1: its way from the first frame tells.
bool runsForward(const dieline::Curve& curve, const std::vector<const LitFrame*>& frames) {
  const double length_mm = dieline::lengthOf(curve);
  const auto uOf = [&](const LitFrame& frame) { return dieline::nearestOn(curve, frame.p_S_mm).u; };
  const double from_u = uOf(*frames.front());
  for (const LitFrame* frame : frames) {
    const double u = uOf(*frame) - from_u;
    if (std::abs(u) * length_mm > kNearest_mm) return u > 0.0;
  }
  return uOf(*frames.back()) > from_u;
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

/// Chi square of a beam that comes out of a jump without a stop: it meets the start of the line at a speed of
/// its own, which then changes, s = v (t - t0) + a (t - t0)² / 2. Rest and full speed are limits of it, late
/// or not.
double chiSquareThrough(const std::vector<Place>& places, double rest_mm) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double square = 0.0;
  for (const Place& p : places) {
    if (p.way_mm - rest_mm < kNearest_mm) continue;
    const Eigen::Vector3d row = Eigen::Vector3d(1.0, p.t_s, p.t_s * p.t_s) / p.sigma_mm;
    normal += row * row.transpose();
    right += row * (p.way_mm / p.sigma_mm);
    square += std::pow(p.way_mm / p.sigma_mm, 2);
  }
  return square - right.dot(normal.ldlt().solve(right));
}

/// A start with where the beam rested before it.
struct Rested {
  StartPlace rest;
  SetOffFit fit;
};

/// The start, with the place of rest that agrees best with what is known of it, and with where the kerf
/// begins: there the beam was when the gate opened, or there it rested if it had not yet set off.
Rested restedFit(const std::vector<Place>& places, const SetOff& law, const StartPlace& known,
                 const std::optional<StartPlace>& kerf) {
  if (!kerf) return {known, fitSetOff(places, law, known.mm)};
  constexpr int kSteps = 200;
  constexpr double kSigmas = 3.0;
  const auto kerfAt = [&](double rest_mm) { return rest_mm + fitSetOff(places, law, rest_mm).gate_way_mm; };
  // The farther inside the beam rested, the farther inside the kerf begins, but by no more than that.
  const double low_mm = std::min(known.mm, kerf->mm) - kSigmas * (known.sigma_mm + kerf->sigma_mm);
  const double high_mm = std::max(known.mm, kerf->mm) + kSigmas * (known.sigma_mm + kerf->sigma_mm);
  StartPlace rest = known;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSteps; ++i) {
    const double rest_mm = std::lerp(low_mm, high_mm, static_cast<double>(i) / kSteps);
    const double square = std::pow((rest_mm - known.mm) / known.sigma_mm, 2) +
                          std::pow((kerfAt(rest_mm) - kerf->mm) / kerf->sigma_mm, 2);
    if (square < least) {
      least = square;
      rest.mm = rest_mm;
    }
  }
  // At full speed at once a gate that opens later moves the begin of the kerf as a place farther inside does:
  // then it tells nothing. Where either may be, the smaller slope counts.
  const double step_mm = known.sigma_mm;
  const double here_mm = kerfAt(rest.mm);
  const double slope = std::clamp(
      std::min(kerfAt(rest.mm + step_mm) - here_mm, here_mm - kerfAt(rest.mm - step_mm)) / step_mm, 0.0, 1.0);
  rest.sigma_mm = 1.0 / std::hypot(1.0 / known.sigma_mm, slope / kerf->sigma_mm);
  return {rest, fitSetOff(places, law, rest.mm)};
}

/// Standard uncertainty of the instant by where the beam rested.
double restSigma_s(const std::vector<Place>& places, const SetOff& law, const StartPlace& rest) {
  const double later_s = fitSetOff(places, law, rest.mm + rest.sigma_mm).t0_s;
  const double sooner_s = fitSetOff(places, law, rest.mm - rest.sigma_mm).t0_s;
  return 0.5 * std::abs(later_s - sooner_s);
}

/// What tells where a beam rested before it set off.
struct RestEvidence {
  std::vector<JointResult> joints;
  Displacements displacements;
};

/// The first stretch of a cut, as seen.
struct SeenStart {
  const LitFrame* first{};
  Eigen::Vector2d start_mm{Eigen::Vector2d::Zero()};
  std::vector<Place> places;
  StartPlace known;
  std::optional<StartPlace> kerf;
};

std::optional<SeenStart> seenWithin(double stretch_mm, const Evidence& evidence, const LitFrames& lit,
                                    const RestEvidence& rest, const GateInterval& gate) {
  const auto frames = framesOf(lit, gate);
  if (frames.size() < kMinLagFrames) return std::nullopt;
  const LitFrame& first = *frames.front();
  const dieline::Entity& entity = entityOf(evidence, first.entity);
  // The teeth of a perforation begin in full run.
  if (entity.process == dieline::Process::kPerforation) return std::nullopt;
  const dieline::Curve& curve = entity.curve;
  // A closed curve may be cut from any place on: where the beam set off is not known.
  if (dieline::isClosed(curve)) return std::nullopt;
  const bool forward = runsForward(curve, frames);
  const double start_u = forward ? 0.0 : 1.0;
  if (beginsElsewhere(evidence, lit, gate, first, start_u)) return std::nullopt;
  // A line that ends in a corner is braked from its middle on.
  const double farthest_mm = std::min(stretch_mm, 0.4 * dieline::lengthOf(curve));
  SeenStart seen{&first,
                 dieline::pointAt(curve, start_u),
                 {},
                 {},
                 kerfStart(rest.joints, first.unit, first.entity, forward)};
  for (const LitFrame* frame : frames) {
    const double way_mm = wayFromEnd(curve, forward, frame->p_S_mm);
    if (way_mm > farthest_mm) break;
    const double sigma_mm = std::hypot(frame->sigma_mm, kRoughness_mm);
    seen.places.push_back({frame->time_s - gate.on_s, way_mm, sigma_mm});
  }
  const Eigen::Vector2d inward = (forward ? 1.0 : -1.0) * dieline::tangentAt(curve, start_u);
  seen.known = rest.displacements.along(first.unit, inward);
  return seen;
}

/// The law that explains the places, and its fit; none if several do that do not agree, or none does.
/// `limit_s`: of the lag.
std::optional<std::pair<SetOff, Rested>> setOffOf(const SeenStart& seen, double limit_s) {
  const std::vector<Place>& places = seen.places;
  const auto fitted = [&](const SetOff& law) { return restedFit(places, law, seen.known, seen.kerf); };
  const Rested even = fitted(SetOff::byPower(2.0));
  const Rested at_once = fitted(SetOff::byPower(1.0));
  const bool dashes = at_once.fit.chi_square < even.fit.chi_square;
  std::pair best{SetOff::byPower(dashes ? 1.0 : 2.0), dashes ? at_once : even};
  const double rest_mm = best.second.rest.mm;
  const auto moving = static_cast<std::size_t>(
      std::ranges::count_if(places, [&](const Place& p) { return p.way_mm - rest_mm >= kNearest_mm; }));
  if (moving < kMinLagFrames) return std::nullopt;
  const double worst_chi_square = kMaxChiSquare * static_cast<double>(moving - 2);
  const RampFit ramp = fitRamp(places, rest_mm);
  const double through_chi_square = chiSquareThrough(places, rest_mm);
  if (ramp.fit.chi_square + kClearlyBetter < best.second.fit.chi_square) {
    // A beam that comes at a speed of its own has as many parameters, and a ramp is chosen among many.
    if (ramp.fit.chi_square > worst_chi_square ||
        through_chi_square < ramp.fit.chi_square + 2.0 * kClearlyBetter)
      return std::nullopt;
    // Where the gate opens late, the ramp's begin was not seen: the beam may have come out of a jump.
    if (-ramp.fit.t0_s > limit_s) return std::nullopt;
    best = {SetOff::rampOver(ramp.ramp_mm), {best.second.rest, ramp.fit}};
  } else if ((even.fit.chi_square <= worst_chi_square) == (at_once.fit.chi_square <= worst_chi_square)) {
    // Where both fit, too little was seen to say how the beam set off, and they disagree on when.
    return std::nullopt;
  } else if (dashes && at_once.fit.t0_s > limit_s && rampExplains(places, rest_mm, at_once.fit)) {
    // Nothing is seen of a beam that is dark at rest, before it is fast.
    return std::nullopt;
  }
  const double chi_square = best.second.fit.chi_square;
  // How fast it came is not known well enough to say when; the kerf's own ends tell of a late gate there.
  if (through_chi_square + kClearlyBetter < chi_square) return std::nullopt;
  // A start with limited jerk, s ~ t³, passes for an even one where few frames saw it, with a wrong t0.
  if (fitSetOff(places, SetOff::byPower(3.0), rest_mm).chi_square < chi_square) return std::nullopt;
  return best;
}

std::optional<Start> startWithin(double stretch_mm, double limit_s, const Evidence& evidence,
                                 const LitFrames& lit, const RestEvidence& rest, const GateInterval& gate) {
  const auto seen = seenWithin(stretch_mm, evidence, lit, rest, gate);
  if (!seen) return std::nullopt;
  const auto set_off = setOffOf(*seen, limit_s);
  if (!set_off) return std::nullopt;
  const auto& [law, rested] = *set_off;
  // An instant farther from the gate than the last frame that shows the start is not seen, but guessed.
  if (std::abs(rested.fit.t0_s) > seen->places.back().t_s) return std::nullopt;
  return Start{-rested.fit.t0_s,  rested.fit.sigma_s,  restSigma_s(seen->places, law, rested.rest),
               seen->first->unit, seen->first->entity, gate.on_s,
               seen->start_mm};
}

std::optional<Start> startOf(double limit_s, const Evidence& evidence, const LitFrames& lit,
                             const RestEvidence& rest, const GateInterval& gate) {
  for (const double stretch_mm : kFarthest_mm) {
    if (const auto start = startWithin(stretch_mm, limit_s, evidence, lit, rest, gate)) return start;
  }
  return std::nullopt;
}

}  // namespace

Finding gateLagCheck(const Evidence& evidence, const Tolerances& limits, const LitFrames& lit) {
  Check check{.name = "gate_lag", .title = "The laser comes on as the beam sets off", .unit = "ms"};
  std::vector<JointResult> joints = measureJoints(evidence);
  Displacements displacements(evidence, joints, limits, lit);
  const RestEvidence rest{std::move(joints), std::move(displacements)};
  std::vector<Start> starts;
  for (const GateInterval& gate : evidence.gates) {
    const auto start = startOf(limits.gate_lag_s, evidence, lit, rest, gate);
    if (!start) continue;
    // A start that few frames saw is known too loosely to prove anything, unless it is far off.
    const bool usable =
        start->sigma_s <= 0.2 * limits.gate_lag_s && evidence.clock_bound_s <= 0.5 * limits.gate_lag_s;
    const bool far_off = std::abs(start->lag_s) - 4.0 * std::hypot(start->sigma_s, start->rest_sigma_s) -
                             evidence.clock_bound_s >
                         limits.gate_lag_s;
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
    extreme.add(1e3 * s.lag_s, 1e3 * std::hypot(s.sigma_s, s.rest_sigma_s, evidence.pin_u_s));
    lags_ms.push_back(1e3 * s.lag_s);
  }
  const Start& worst = *std::max_element(starts.begin(), starts.end(), [](const Start& a, const Start& b) {
    return std::abs(a.lag_s) < std::abs(b.lag_s);
  });
  check.value = extreme.value();
  // The clocks' relation is off alike at all starts.
  check.u = check.guard = extreme.expandedU() + 1e3 * evidence.clock_bound_s;
  check.subject = nameOf(worst.unit, worst.entity);
  check.where = atPlace(worst.unit, worst.entity, worst.p_S_mm);
  check.where.time = Whereabouts::Time::kPins;
  check.where.time_s = worst.on_s;
  check.where.other_s = worst.on_s - worst.lag_s;
  decide(check);
  const double median_ms = medianOf(lags_ms);
  check.explanation = fmt::format(
      "At {} starts the gate opened {:.2f} ms {} the beam set off, in the median; farthest off is {} at "
      "{:.3f} s with "
      "{:.2f} ms.",
      starts.size(), std::abs(median_ms), median_ms >= 0 ? "after" : "before", check.subject, worst.on_s,
      1e3 * worst.lag_s);
  check.explanation += intervalWords(check);
  return check;
}

}  // namespace kerfbench::inspect::checks
