// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/motion/rounding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "firmware_under_test/planner/geometry/biarc.h"
#include "firmware_under_test/planner/motion/jerk_profile.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

constexpr double kNoLegMm = 1e-9;
/// Sagitta below which an arc is a line: rounding of coordinates.
constexpr double kFlatMm = 1e-9;
/// Share of a corner's error that the drives' lag gets at most; the rest is the arcs' own.
constexpr double kMostLagShare = 0.5;
/// Share of the acceleration that bends the path, as in Pieces and SpeedProfile.
constexpr double kBendShare = 0.8;

/// Two arcs over a corner.
struct Blend {
  double cut_mm{};  ///< Length taken from either leg.
  std::array<Segment, 2> arcs;
};

double distanceTo(const Segment& leg, const Vector2d& p) {
  if (leg.isArc()) return std::abs((p - leg.centre_mm).norm() - leg.radiusMm());
  return std::abs(cross(leg.tangentAt(0.0), p - leg.start_mm));
}

/// Distance by which the arcs leave the legs, or the corner the arcs, whichever is more.
double missMm(const Blend& blend, const Segment& before, const Segment& after) {
  constexpr int kParts = 8;
  double off_mm = 0.0;
  double nearest_mm = kInfinite;
  for (const Segment& arc : blend.arcs) {
    for (int i = 0; i <= kParts; ++i) {
      const Vector2d p = arc.at(arc.lengthMm() * i / kParts);
      off_mm = std::max(off_mm, std::min(distanceTo(before, p), distanceTo(after, p)));
      nearest_mm = std::min(nearest_mm, (p - before.end_mm).norm());
    }
  }
  return std::max(off_mm, nearest_mm);
}

/// Rounds one corner.
class Corner {
 public:
  Corner(const Segment& before, const Segment& after, const FlowLimits& limits)
      : before_(before),
        after_(after),
        limits_(limits),
        speed_(speedLimitsOf(limits, false)),
        turn_rad_(turnRad(before, after)) {}

  [[nodiscard]] std::optional<Blend> blend() const {
    const double error_mm = limits_.corners.error_mm * std::cos(turn_rad_);
    const double top = topSpeed();
    const double sharp = turnSpeed(turn_rad_, speed_.acceleration_mm_s2, speed_.period_s, limits_.corners);
    if (error_mm <= 0.0 || !(top > sharp)) return std::nullopt;
    // Drives that lag, and chords from period to period, cut bends off by this, times the acceleration.
    const double square_s2 =
        0.25 * limits_.corners.lag_s * limits_.corners.lag_s + 0.125 * speed_.period_s * speed_.period_s;
    const double bend =
        std::min(kBendShare * speed_.acceleration_mm_s2, kMostLagShare * error_mm / square_s2);
    const double own_mm = error_mm - bend * square_s2;
    const double half = std::tan(0.5 * turn_rad_);
    double cut_mm = std::min({0.5 * before_.lengthMm(), 0.5 * after_.lengthMm(),
                              own_mm / std::tan(0.25 * turn_rad_), radiusFor(top, bend) * half});
    constexpr int kTries = 8;  // More than curved legs need.
    for (int i = 0; i < kTries && gainS(cut_mm, bend, sharp, top) > 0.0; ++i) {
      Blend found = arcsOver(cut_mm);
      const double miss_mm = missMm(found, before_, after_);
      if (miss_mm <= own_mm * (1.0 + 1e-9)) return limited(std::move(found), bend);
      cut_mm *= 0.98 * own_mm / miss_mm;
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] double topSpeed() const {
    return std::min({limits_.mark_mm_s, limits_.axes_mm_s(before_.tangentAt(before_.lengthMm())),
                     limits_.axes_mm_s(after_.tangentAt(0.0))});
  }
  [[nodiscard]] double speedOn(double radius_mm, double bend_mm_s2) const {
    return std::min({std::sqrt(bend_mm_s2 * radius_mm), bendSpeed(radius_mm, speed_),
                     curvatureStepSpeed(1.0 / radius_mm, speed_)});
  }
  /// Time that arcs save, between two places far off on either leg: they are run at one speed, a sharp corner
  /// is passed by braking to its own, at once before speeding up again.
  [[nodiscard]] double gainS(double cut_mm, double bend_mm_s2, double sharp_mm_s, double top_mm_s) const {
    const double a = speed_.acceleration_mm_s2;
    const double radius_mm = cut_mm / std::tan(0.5 * turn_rad_);
    const double v = speedOn(radius_mm, bend_mm_s2);
    const double ramps_s = 2.0 * (v - sharp_mm_s) / a;
    const double ramps_mm = (v * v - sharp_mm_s * sharp_mm_s) / a;
    return ramps_s - radius_mm * turn_rad_ / v - (ramps_mm - 2.0 * cut_mm) / top_mm_s;
  }
  /// Radius of arcs that a speed needs; the speed's three bounds grow with the radius.
  [[nodiscard]] double radiusFor(double v_mm_s, double bend_mm_s2) const {
    double radius_mm = v_mm_s * v_mm_s / bend_mm_s2;
    while (speedOn(radius_mm, bend_mm_s2) < v_mm_s * (1.0 - 1e-9)) radius_mm *= 1.1;
    return radius_mm;
  }
  [[nodiscard]] Blend arcsOver(double cut_mm) const {
    const double from_mm = before_.lengthMm() - cut_mm;
    Blend found{cut_mm, biarc(before_.at(from_mm), before_.tangentAt(from_mm), after_.at(cut_mm),
                              after_.tangentAt(cut_mm), kFlatMm)};
    for (std::size_t i = 0; i < 2; ++i) {
      const Segment& leg = i == 0 ? before_ : after_;
      found.arcs.at(i).z = leg.z;
      found.arcs.at(i).entity = leg.entity;
      found.arcs.at(i).line = leg.line;
    }
    return found;
  }
  static Blend limited(Blend found, double bend_mm_s2) {
    for (Segment& arc : found.arcs) {
      if (arc.isArc()) arc.most_mm_s = std::sqrt(bend_mm_s2 * arc.radiusMm());
    }
    return found;
  }

  const Segment& before_;
  const Segment& after_;
  const FlowLimits& limits_;
  SpeedLimits speed_;
  double turn_rad_;
};

bool meets(const Segment& before, const Segment& after) {
  return !before.jump && !after.jump && before.z == after.z;
}

}  // namespace

std::vector<Segment> roundedCorners(const std::vector<Segment>& path, const FlowLimits& limits) {
  if (limits.corners.error_mm <= 0.0) return path;
  std::vector<Segment> rounded;
  rounded.reserve(path.size());
  double begun_mm = 0.0;  // Length that the corner before has taken.
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Segment& now = path[i];
    std::optional<Blend> blend;
    if (i + 1 < path.size() && meets(now, path[i + 1])) blend = Corner(now, path[i + 1], limits).blend();
    if (!blend && begun_mm == 0.0) {
      rounded.push_back(now);
      continue;
    }
    const double to_mm = now.lengthMm() - (blend ? blend->cut_mm : 0.0);
    if (to_mm - begun_mm > kNoLegMm) rounded.push_back(now.part(begun_mm, to_mm));
    if (blend) rounded.insert(rounded.end(), blend->arcs.begin(), blend->arcs.end());
    begun_mm = blend ? blend->cut_mm : 0.0;
  }
  return rounded;
}

}  // namespace kerfbench::planner
