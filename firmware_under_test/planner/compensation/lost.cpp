// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "firmware_under_test/planner/compensation/pieces.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

constexpr double kSharpestRad = 5.0 * std::numbers::pi / 6.0;
constexpr double kNextToMm = 1e-5;
/// Most that the legs of a corner may bend away from the beam, as a share of what the stretch turns towards
/// it. Beyond, little of the corner is left outside of the stretch: it is a notch or a pocket, which is lost
/// as a whole.
constexpr double kBowShare = 1.0 / 3.0;

/// A stretch of one segment, in its arc length.
struct Interval {
  std::size_t segment;
  double from_mm;
  double to_mm;
};

/// Stretches of each segment that no kept piece runs along.
std::vector<Interval> uncovered(const Contour& contour, std::size_t number,
                                const std::vector<OffsetPiece>& kept, double radius_mm) {
  std::vector<std::vector<std::pair<double, double>>> covered(contour.segments.size());
  for (const OffsetPiece& piece : kept) {
    if (piece.contour != number || piece.joint) continue;
    const Segment& source = contour.segments[piece.segment];
    const auto whole = offsetOf(source, piece.side, radius_mm);
    const double scale = source.lengthMm() / whole->lengthMm();
    const double from = stationMm(*whole, piece.curve.start_mm);
    // Stations have no end of a full circle other than its start.
    covered[piece.segment].emplace_back(from * scale, (from + piece.curve.lengthMm()) * scale);
  }
  std::vector<Interval> open;
  for (std::size_t i = 0; i < covered.size(); ++i) {
    std::sort(covered[i].begin(), covered[i].end());
    double at = 0.0;
    for (const auto& [from, to] : covered[i]) {
      if (from > at + kNextToMm) open.push_back({i, at, from});
      at = std::max(at, to);
    }
    const double length = contour.segments[i].lengthMm();
    if (length > at + kNextToMm) open.push_back({i, at, length});
  }
  return open;
}

bool follows(const Contour& contour, const Interval& a, const Interval& b) {
  return (a.segment + 1) % contour.segments.size() == b.segment &&
         a.to_mm > contour.segments[a.segment].lengthMm() - kNextToMm && b.from_mm < kNextToMm;
}

/// Runs of neighbouring intervals.
std::vector<std::vector<Interval>> runs(const Contour& contour, const std::vector<Interval>& open) {
  std::vector<std::vector<Interval>> all;
  for (const Interval& interval : open) {
    if (all.empty() || interval.segment == 0 || !follows(contour, all.back().back(), interval))
      all.push_back({});
    all.back().push_back(interval);
  }
  if (contour.closed && all.size() > 1 && follows(contour, all.back().back(), all.front().front())) {
    all.back().insert(all.back().end(), all.front().begin(), all.front().end());
    all.erase(all.begin());
  }
  return all;
}

/// Turning of a run, towards the beam and away from it.
struct Turning {
  double towards_rad{};
  double away_rad{};
  void add(double turn) { (turn > 0.0 ? towards_rad : away_rad) += std::abs(turn); }
};

Turning turningOf(const Contour& contour, const std::vector<Interval>& run) {
  const double side = contour.side == Side::kLeft ? 1.0 : -1.0;
  Turning turning;
  for (std::size_t k = 0; k < run.size(); ++k) {
    const Segment& segment = contour.segments[run[k].segment];
    turning.add(side * segment.sweep_rad * (run[k].to_mm - run[k].from_mm) / segment.lengthMm());
    if (k + 1 < run.size()) turning.add(side * jointAfter(contour, run[k].segment).turn_rad);
  }
  return turning;
}

/// Place of the beam's centre at a place of the contour.
Vector2d centreAt(const Contour& contour, std::size_t segment, double s_mm, double radius_mm) {
  const Segment& source = contour.segments[segment];
  const Vector2d t = source.tangentAt(s_mm);
  const double side = contour.side == Side::kLeft ? 1.0 : -1.0;
  return source.at(s_mm) + side * radius_mm * Vector2d(-t.y(), t.x());
}

double edgeDistance(const std::vector<Boxed>& paths, const Vector2d& p, double radius_mm) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Boxed& path : paths) {
    if (path.box.squaredExteriorDistance(p) >= nearest * nearest) continue;
    nearest = std::min(nearest, distanceMm(path.curve, p));
  }
  return nearest - radius_mm;
}

/// Curves of which one may be the nearest to places no farther than `reach_mm` from p.
std::vector<Boxed> candidates(const std::vector<Boxed>& paths, const Vector2d& p, double reach_mm) {
  const double bound = edgeDistance(paths, p, 0.0) + 2.0 * reach_mm;
  std::vector<Boxed> near;
  for (const Boxed& path : paths) {
    if (path.box.squaredExteriorDistance(p) <= bound * bound) near.push_back(path);
  }
  return near;
}

LostStretch describe(const Contour& contour, const std::vector<Interval>& run,
                     const std::vector<Boxed>& paths, double radius_mm) {
  constexpr int kSamples = 32;
  LostStretch lost;
  lost.depth_mm = -std::numeric_limits<double>::infinity();
  for (const Interval& interval : run) lost.length_mm += interval.to_mm - interval.from_mm;
  const Vector2d begin = contour.segments[run.front().segment].at(run.front().from_mm);
  const std::vector<Boxed> near = candidates(paths, begin, lost.length_mm);
  for (const Interval& interval : run) {
    const Segment& segment = contour.segments[interval.segment];
    if (std::find(lost.entities.begin(), lost.entities.end(), segment.entity) == lost.entities.end()) {
      lost.entities.push_back(segment.entity);
    }
    for (int k = 0; k <= kSamples; ++k) {
      const Vector2d p = segment.at(interval.from_mm + (interval.to_mm - interval.from_mm) * k / kSamples);
      const double depth = edgeDistance(near, p, radius_mm);
      if (depth <= lost.depth_mm) continue;
      lost.depth_mm = depth;
      lost.p_mm = p;
    }
  }
  const Turning turning = turningOf(contour, run);
  // The beam touches both ends of a corner at once.
  const Vector2d apart = centreAt(contour, run.front().segment, run.front().from_mm, radius_mm) -
                         centreAt(contour, run.back().segment, run.back().to_mm, radius_mm);
  // Legs that bend away open a corner, so that no more is lost than in one with straight legs.
  const double turn = std::min(turning.towards_rad, kSharpestRad);
  const bool is_corner = turning.towards_rad < kSharpestRad + 1e-6 &&
                         turning.away_rad <= kBowShare * turning.towards_rad + 1e-6 &&
                         lost.depth_mm < radius_mm * (1.0 / std::cos(0.5 * turn) - 1.0) + kShallowMm;
  const bool rounds = apart.norm() < kShallowMm && is_corner;
  lost.kind = rounds ? LostStretch::Kind::kRounded : LostStretch::Kind::kNarrow;
  return lost;
}

}  // namespace

std::vector<LostStretch> lostStretches(const std::vector<Contour>& contours,
                                       const std::vector<OffsetPiece>& kept,
                                       const std::vector<BeamPath>& paths, double radius_mm) {
  std::vector<Boxed> curves;
  for (const BeamPath& path : paths) {
    for (const Segment& segment : path.segments) curves.push_back(boxed(segment));
  }
  std::vector<LostStretch> all;
  for (std::size_t c = 0; c < contours.size(); ++c) {
    const bool any = std::any_of(kept.begin(), kept.end(), [&](const OffsetPiece& piece) {
      return piece.contour == c && !piece.joint;
    });
    for (const auto& run : runs(contours[c], uncovered(contours[c], c, kept, radius_mm))) {
      LostStretch lost = describe(contours[c], run, curves, radius_mm);
      lost.contour = c;
      if (!any) {
        lost.kind = LostStretch::Kind::kWhole;
        lost.depth_mm = std::numeric_limits<double>::infinity();
        lost.p_mm = contours[c].segments.front().start_mm;
      }
      if (any && lost.depth_mm < kShallowMm) continue;
      all.push_back(std::move(lost));
    }
  }
  return all;
}

}  // namespace kerfbench::planner
