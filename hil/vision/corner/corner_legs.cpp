// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/corner/corner_legs.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace kerfbench::vision {
namespace {

constexpr double kBeforeNextMm = 0.25;
// Leg by its calipers: all of them where they lie on a straight line, else those that a cubic can follow.
constexpr double kCalipersFromMm = 0.35;
constexpr double kStraightToMm = 1.9;
constexpr double kBentToMm = 1.25;
// Distance from the corner up to which calipers may follow an arc that cuts it; they lie kOnArcMm off the
// line of the others.
constexpr double kBehindArcMm = 0.85;
constexpr double kOnArcMm = 0.04;
constexpr double kStraight = 1.5;  // Largest scatter of a straight leg's readings, in their own sigmas.
constexpr double kStraightCurvature_per_mm = 0.01;
constexpr double kStraightTwist_per_mm2 = 0.02;
constexpr double kPointsFromMm = 0.5;  // Distance from which on no usual arc touches a caliper's window.
constexpr double kCubicSigma = 0.004;
constexpr double kSharedPixels = 1.4;  // Neighbours share half of their pixels.
constexpr std::size_t kCubicFrom = 6;
constexpr std::size_t kLeastReadings = 3;

double scatterAbout(const std::vector<LegReading>& readings, const Eigen::VectorXd& line) {
  double squares = 0.0;
  for (const LegReading& r : readings) {
    const double rest = (r.offset_mm - line[0] - line[1] * r.away_mm) / r.sigma_mm;
    squares += rest * rest;
  }
  return std::sqrt(squares / (static_cast<double>(readings.size()) - 2.0));
}

void setLine(const Eigen::VectorXd& through, double sign, CornerLeg& leg) {
  Eigen::Vector4d c = Eigen::Vector4d::Zero();
  c.head(through.size()) = sign * through;
  leg.offset_mm = c[0];
  leg.slope = c[1];
  leg.curvature_per_mm = 2.0 * c[2];
  leg.twist_per_mm2 = 6.0 * c[3];
}

}  // namespace

CornerLeg nominalLeg(const JointScene& scene, const EntityEnd& end) {
  const double bend = scene.stationAt(end).curvature_per_mm;
  return {.outwards = -end.outward, .bend_per_mm = end.at_start ? bend : -bend};
}

double lookedAtMm(const JointScene& scene, const EntityEnd& end) {
  return std::min(kCornerLegMm, scene.plan->entities[end.plan].length_mm - kBeforeNextMm);
}

LegGuess followCalipers(const JointScene& scene, const EntityEnd& end, const KerfLeg& measured) {
  const double sign = end.at_start ? 1.0 : -1.0;
  const auto readingsFrom = [&](double from_mm, double to_mm) {
    return readingsBeside((*scene.kerfs)[end.plan], scene.stationOf(end), from_mm, to_mm);
  };
  LegGuess guess{nominalLeg(scene, end), nominalLeg(scene, end), {}};
  guess.near.offset_mm = guess.far.offset_mm = sign * measured.offset_mm;
  std::vector<LegReading> readings = readingsFrom(kCalipersFromMm, kStraightToMm);
  if (readings.size() < kLeastReadings) return guess;
  const std::vector<LegReading> far = readingsFrom(kBehindArcMm, kStraightToMm);
  if (far.size() >= kLeastReadings) {
    const Eigen::VectorXd line = polynomialThrough(far, 1);
    setLine(line, sign, guess.far);
    const auto onArc = [&](const LegReading& r) {
      return std::abs(r.offset_mm - line[0] - line[1] * r.away_mm) > kOnArcMm;
    };
    if (std::any_of(readings.begin(), readings.end(), onArc) && scatterAbout(far, line) < kStraight)
      readings = far;
  }
  Eigen::VectorXd through = polynomialThrough(readings, 1);
  const bool straight = readings.size() >= kCubicFrom && scatterAbout(readings, through) < kStraight;
  if (straight) {
    guess.known.curvature_sigma_per_mm = kStraightCurvature_per_mm;
    guess.known.twist_sigma_per_mm2 = kStraightTwist_per_mm2;
  } else {
    readings = readingsFrom(kCalipersFromMm, kBentToMm);
    if (readings.size() < kLeastReadings) return guess;
    through = polynomialThrough(readings, readings.size() >= kCubicFrom ? 3 : 1);
  }
  setLine(through, sign, guess.near);
  if (far.size() < kLeastReadings) guess.far = guess.near;
  for (const LegReading& r : readings) {
    if (r.away_mm < kPointsFromMm) continue;
    const double beyond_mm = std::max(0.0, r.away_mm - lookedAtMm(scene, end));
    const double model_mm = straight ? 0.0 : kCubicSigma * beyond_mm;
    guess.known.points.push_back(
        {r.away_mm, sign * r.offset_mm, std::hypot(kSharedPixels * r.sigma_mm, model_mm)});
  }
  return guess;
}

}  // namespace kerfbench::vision
