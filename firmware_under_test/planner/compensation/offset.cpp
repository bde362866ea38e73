// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/compensation/offset.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firmware_under_test/planner/compensation/pieces.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

/// Distance from a piece at which there must be free space as well. Distinguishes a slot as wide as the kerf,
/// in which the beam would run to and fro, from a path.
constexpr double kAlongsideMm = 1e-7;
/// Limit of requireClear().
constexpr double kTooNearMm = 1e-5;
constexpr double kShortestMm = 1e-6;

/// Arc lengths at which others cross or touch a piece, its ends among them; increasing.
std::vector<double> cuts(const Segment& curve, const std::vector<Boxed>& others) {
  Eigen::AlignedBox2d box = boxOf(curve);
  box.min().array() -= kTouchMm;
  box.max().array() += kTouchMm;
  const double length = curve.lengthMm();
  std::vector<double> found;
  for (const Boxed& other : others) {
    if (!box.intersects(other.box)) continue;
    for (const Vector2d& p : meetings(curve, other.curve)) found.push_back(stationMm(curve, p));
  }
  std::sort(found.begin(), found.end());
  std::vector<double> at{0.0};
  for (const double s : found) {
    if (s > at.back() + kShortestMm && s < length - kShortestMm) at.push_back(s);
  }
  at.push_back(length);
  return at;
}

/// Parts of the pieces that have free space along them.
std::vector<OffsetPiece> freeParts(const std::vector<OffsetPiece>& pieces, const std::vector<Boxed>& cutters,
                                   const std::vector<Boxed>& obstacles, double radius_mm) {
  std::vector<OffsetPiece> parts;
  for (const OffsetPiece& piece : pieces) {
    const std::vector<double> at = cuts(piece.curve, cutters);
    const auto free = [&](std::size_t k) {
      const double middle = 0.5 * (at[k] + at[k + 1]);
      const Vector2d p = piece.curve.at(middle);
      if (!isFree(obstacles, p, radius_mm)) return false;
      const Vector2d t = piece.curve.tangentAt(middle);
      const Vector2d alongside = p + piece.side * kAlongsideMm * Vector2d(-t.y(), t.x());
      return isFree(obstacles, alongside, radius_mm + 0.5 * kAlongsideMm);
    };
    for (std::size_t k = 0; k + 1 < at.size();) {
      const std::size_t first = k;
      while (k + 1 < at.size() && free(k)) ++k;
      if (k == first) {
        ++k;
        continue;
      }
      if (at[k] - at[first] < kShortestMm) continue;
      OffsetPiece part = piece;
      if (first > 0 || k + 1 < at.size()) part.curve = piece.curve.part(at[first], at[k]);
      parts.push_back(part);
    }
  }
  return parts;
}

std::vector<Boxed> boxedCurves(const std::vector<OffsetPiece>& pieces) {
  std::vector<Boxed> out;
  for (const OffsetPiece& piece : pieces) out.push_back(boxed(piece.curve));
  return out;
}

Boxed circleAbout(const Vector2d& p, double radius_mm) {
  Segment circle;
  circle.centre_mm = p;
  circle.start_mm = circle.end_mm = p + Vector2d(radius_mm, 0.0);
  circle.sweep_rad = 2.0 * std::numbers::pi;
  return boxed(circle);
}

/// Adds the back and the ends of an open contour, which may be approached from there as well.
void addBackAndEnds(const Contour& contour, const std::vector<Boxed>& obstacles, double radius_mm,
                    std::vector<Boxed>& cutters) {
  Contour back = contour;
  back.side = contour.side == Side::kLeft ? Side::kRight : Side::kLeft;
  std::vector<Joint> ignored;
  for (const Boxed& b : boxedCurves(rawPieces({back}, obstacles, radius_mm, ignored))) cutters.push_back(b);
  cutters.push_back(circleAbout(contour.segments.front().start_mm, radius_mm));
  cutters.push_back(circleAbout(contour.segments.back().end_mm, radius_mm));
}

/// Refuses every path that comes too near; the last check.
void requireClear(const std::vector<BeamPath>& paths, const std::vector<Boxed>& obstacles, double radius_mm) {
  for (const BeamPath& path : paths) {
    for (const Segment& segment : path.segments) {
      for (const double u : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        const Vector2d p = segment.at(u * segment.lengthMm());
        if (isFree(obstacles, p, radius_mm - kTooNearMm)) continue;
        throw CompensationError(placeName({segment.entity}, p) +
                                ": the compensated path comes too near to the contour");
      }
    }
  }
}

/// Contours that act on each other: all closed ones, or one open one.
Offset offsetGroup(const std::vector<Contour>& contours, double radius_mm) {
  const std::vector<Boxed> obstacles = boxed(contours);
  Offset result;
  const std::vector<OffsetPiece> raw = rawPieces(contours, obstacles, radius_mm, result.joints);
  std::vector<Boxed> cutters = boxedCurves(raw);
  if (!contours.front().closed) addBackAndEnds(contours.front(), obstacles, radius_mm, cutters);
  const std::vector<OffsetPiece> parts = freeParts(raw, cutters, obstacles, radius_mm);
  result.paths = stitched(parts, contours);
  requireClear(result.paths, obstacles, radius_mm);
  result.lost = lostStretches(contours, parts, result.paths, radius_mm);
  return result;
}

void append(Offset& all, Offset more, const std::vector<std::size_t>& numbers) {
  for (BeamPath& path : more.paths) {
    path.contour = numbers[path.contour];
    all.paths.push_back(std::move(path));
  }
  for (Joint& joint : more.joints) {
    joint.contour = numbers[joint.contour];
    all.joints.push_back(joint);
  }
  for (LostStretch& lost : more.lost) {
    lost.contour = numbers[lost.contour];
    all.lost.push_back(std::move(lost));
  }
}

}  // namespace

Offset offsetContours(const std::vector<Contour>& contours, double radius_mm) {
  if (!(radius_mm > 0.0) || !std::isfinite(radius_mm)) {
    throw CompensationError(fmt::format("the kerf's radius must be > 0, but is {:g} mm", radius_mm));
  }
  std::vector<Contour> closed;
  std::vector<std::size_t> closed_numbers;
  std::vector<std::string> faults;
  for (std::size_t i = 0; i < contours.size(); ++i) {
    if (contours[i].segments.empty()) throw CompensationError("a contour without segments");
    if (contours[i].closed) {
      closed.push_back(contours[i]);
      closed_numbers.push_back(i);
    } else {
      for (std::string& fault : contactFaults({contours[i]})) faults.push_back(std::move(fault));
    }
  }
  for (std::string& fault : contactFaults(closed)) faults.push_back(std::move(fault));
  if (!faults.empty()) throw CompensationError(fmt::format("{}", fmt::join(faults, "\n")));

  Offset all;
  if (!closed.empty()) append(all, offsetGroup(closed, radius_mm), closed_numbers);
  for (std::size_t i = 0; i < contours.size(); ++i) {
    if (!contours[i].closed) append(all, offsetGroup({contours[i]}, radius_mm), {i});
  }
  return all;
}

}  // namespace kerfbench::planner
