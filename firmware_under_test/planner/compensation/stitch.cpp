// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware_under_test/planner/compensation/pieces.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

/// Largest distance between ends that belong together: a part too short to keep, or the length in which two
/// curves that leave each other tangentially differ by the slack of a distance.
constexpr double kStitchMm = 2e-4;
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

struct Link {
  double gap_mm;
  std::size_t from;
  std::size_t to;
};

/// Finds for each piece the one that goes on from its end; the nearest first, so that a short piece does not
/// close on itself.
std::vector<std::size_t> linked(const std::vector<OffsetPiece>& pieces) {
  std::vector<Link> links;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    for (std::size_t j = 0; j < pieces.size(); ++j) {
      const double gap = (pieces[i].curve.end_mm - pieces[j].curve.start_mm).norm();
      if (gap < kStitchMm) links.push_back({gap, i, j});
    }
  }
  std::stable_sort(links.begin(), links.end(),
                   [](const Link& a, const Link& b) { return a.gap_mm < b.gap_mm; });
  std::vector<std::size_t> next(pieces.size(), kNone);
  std::vector<bool> taken(pieces.size(), false);
  for (const Link& link : links) {
    if (next[link.from] != kNone || taken[link.to]) continue;
    next[link.from] = link.to;
    taken[link.to] = true;
  }
  return next;
}

bool goesStraightOn(const Segment& a, const Segment& b) {
  if (a.isArc() || b.isArc() || a.entity != b.entity) return false;
  const Vector2d ta = a.tangentAt(0.0);
  const Vector2d tb = b.tangentAt(0.0);
  return ta.dot(tb) > 0.0 && std::abs(cross(ta, tb)) < 1e-9;
}

/// Closes the remaining gaps and makes one line of a line and its extension.
std::vector<Segment> smoothed(const std::vector<Segment>& path, bool closed) {
  std::vector<Segment> out;
  for (Segment segment : path) {
    if (!out.empty()) {
      segment.start_mm = out.back().end_mm;
      if (goesStraightOn(out.back(), segment)) {
        out.back().end_mm = segment.end_mm;
        continue;
      }
    }
    out.push_back(segment);
  }
  if (!closed || out.empty()) return out;
  if (out.size() > 1 && goesStraightOn(out.back(), out.front())) {
    out.front().start_mm = out.back().start_mm;
    out.pop_back();
  }
  out.back().end_mm = out.front().start_mm;
  return out;
}

}  // namespace

std::vector<BeamPath> stitched(std::vector<OffsetPiece> pieces, const std::vector<Contour>& contours) {
  const std::vector<std::size_t> next = linked(pieces);
  std::vector<bool> has_before(pieces.size(), false);
  for (const std::size_t to : next) {
    if (to != kNone) has_before[to] = true;
  }
  std::vector<bool> used(pieces.size(), false);
  std::vector<BeamPath> paths;
  const auto follow = [&](std::size_t first) {
    BeamPath path;
    path.contour = pieces[first].contour;
    std::vector<Segment> segments;
    std::size_t i = first;
    for (; i != kNone && !used[i]; i = next[i]) {
      used[i] = true;
      segments.push_back(pieces[i].curve);
    }
    path.segments = smoothed(segments, i != kNone);
    paths.push_back(std::move(path));
  };
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (next[i] == kNone && contours[pieces[i].contour].closed) {
      throw CompensationError(placeName({pieces[i].curve.entity}, pieces[i].curve.end_mm) +
                              ": the compensated path does not close");
    }
    if (!has_before[i]) follow(i);
  }
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (!used[i]) follow(i);
  }
  return paths;
}

}  // namespace kerfbench::planner
