// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/compensation/plane_check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

constexpr double kChordOffMm = 4e-6;
constexpr double kWider = 1.02;

struct Chord {
  Vector2d a;
  Vector2d b;
};

void addChords(const Segment& segment, double longest_mm, std::vector<Chord>& out) {
  double step = longest_mm;
  if (segment.isArc()) step = std::min(step, std::sqrt(8.0 * segment.radiusMm() * kChordOffMm));
  const double length = segment.lengthMm();
  const int parts = std::max(1, static_cast<int>(std::ceil(length / step)));
  Vector2d from = segment.start_mm;
  for (int k = 1; k <= parts; ++k) {
    const Vector2d to = k < parts ? segment.at(length * k / parts) : segment.end_mm;
    out.push_back({from, to});
    from = to;
  }
}

double distance(const Chord& chord, const Vector2d& p) {
  const Vector2d u = chord.b - chord.a;
  const double square = u.squaredNorm();
  const double t = square > 0.0 ? std::clamp((p - chord.a).dot(u) / square, 0.0, 1.0) : 0.0;
  return (chord.a + t * u - p).norm();
}

/// Chords in square cells, for a search near a point.
class Grid {
 public:
  Grid(const std::vector<Chord>& chords, double cell_mm) : chords_(chords), cell_mm_(cell_mm) {
    for (std::size_t i = 0; i < chords.size(); ++i) {
      const Cell a = cellOf(chords[i].a.cwiseMin(chords[i].b));
      const Cell b = cellOf(chords[i].a.cwiseMax(chords[i].b));
      for (int x = a.first; x <= b.first; ++x) {
        for (int y = a.second; y <= b.second; ++y) cells_[keyOf(x, y)].push_back(i);
      }
    }
  }
  /// Least distance, where it is below two cells; else infinity. The search goes through the cells round p
  /// from near to far.
  [[nodiscard]] double nearest(const Vector2d& p) const {
    double best = std::numeric_limits<double>::infinity();
    const Cell c = cellOf(p);
    for (int ring = 0; ring <= 2; ++ring) {
      if (best < (ring - 1) * cell_mm_) break;
      for (int x = -ring; x <= ring; ++x) {
        const int step = std::abs(x) == ring ? 1 : std::max(1, 2 * ring);
        for (int y = -ring; y <= ring; y += step) {
          const auto found = cells_.find(keyOf(c.first + x, c.second + y));
          if (found == cells_.end()) continue;
          for (const std::size_t i : found->second) best = std::min(best, distance(chords_[i], p));
        }
      }
    }
    return best;
  }

 private:
  using Cell = std::pair<int, int>;
  [[nodiscard]] Cell cellOf(const Vector2d& p) const {
    return {static_cast<int>(std::floor(p.x() / cell_mm_)), static_cast<int>(std::floor(p.y() / cell_mm_))};
  }
  [[nodiscard]] static std::uint64_t keyOf(int x, int y) {
    return (std::uint64_t{static_cast<std::uint32_t>(x)} << 32U) | static_cast<std::uint32_t>(y);
  }
  const std::vector<Chord>& chords_;
  double cell_mm_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells_;
};

/// Number of turns of the contours round p.
int windings(const std::vector<Chord>& chords, const Vector2d& p) {
  int turns = 0;
  for (const Chord& chord : chords) {
    const bool up = chord.a.y() <= p.y() && chord.b.y() > p.y();
    const bool down = chord.b.y() <= p.y() && chord.a.y() > p.y();
    if (!up && !down) continue;
    const double left = cross(chord.b - chord.a, p - chord.a);
    if (up && left > 0.0) ++turns;
    if (down && left < 0.0) --turns;
  }
  return turns;
}

bool isWhole(const std::vector<Segment>& path, bool closed) {
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i + 1 == path.size() && !closed) break;
    if ((path[i].end_mm - path[(i + 1) % path.size()].start_mm).norm() > 1e-4) return false;
  }
  return true;
}

/// Chords directed so that the beam belongs to the left.
std::vector<Chord> beamLeft(const std::vector<Contour>& contours, double longest_mm) {
  std::vector<Chord> chords;
  for (const Contour& contour : contours) {
    const std::size_t first = chords.size();
    for (const Segment& segment : contour.segments) addChords(segment, longest_mm, chords);
    if (contour.side == Side::kLeft) continue;
    for (std::size_t i = first; i < chords.size(); ++i) std::swap(chords[i].a, chords[i].b);
  }
  return chords;
}

}  // namespace

bool PlaneCheck::holds(double radius_mm) const {
  return whole && right_side && nearest_mm > radius_mm - 2e-5 && missed_mm < 1e-4 &&
         farthest_mm < std::sqrt(2.0) * radius_mm + 1e-4;
}

PlaneCheck checkPlane(const std::vector<Contour>& contours, const std::vector<std::vector<Segment>>& paths,
                      double radius_mm) {
  PlaneCheck check;
  check.nearest_mm = std::numeric_limits<double>::infinity();
  const bool closed = !contours.empty() && contours.front().closed;
  const double step = 0.1 * radius_mm;
  const std::vector<Chord> contour = beamLeft(contours, step);
  std::vector<Chord> path;
  for (const auto& segments : paths) {
    check.whole = check.whole && isWhole(segments, closed);
    for (const Segment& segment : segments) addChords(segment, step, path);
  }
  const Grid contour_grid(contour, radius_mm);
  for (const Chord& chord : path) {
    ++check.samples;
    const Vector2d middle = 0.5 * (chord.a + chord.b);
    const double d = std::min(contour_grid.nearest(chord.a), contour_grid.nearest(middle));
    check.nearest_mm = std::min(check.nearest_mm, d);
    check.farthest_mm = std::max(check.farthest_mm, d);
  }
  const Grid path_grid(path, radius_mm);
  for (const Chord& chord : contour) {
    ++check.samples;
    const Vector2d u = (chord.b - chord.a).normalized();
    const Vector2d n(-u.y(), u.x());
    const Vector2d middle = 0.5 * (chord.a + chord.b);
    if (contour_grid.nearest(middle + kWider * radius_mm * n) < kWider * radius_mm - 2.0 * kChordOffMm)
      continue;
    const double missed = path_grid.nearest(middle + radius_mm * n);
    check.missed_mm = std::max(check.missed_mm, missed);
  }
  if (!closed) return check;
  // Where the beam may be, the contours wind round it as often as round a place just left of any of them.
  const Vector2d along = contour.front().b - contour.front().a;
  const Vector2d left =
      0.5 * (contour.front().a + contour.front().b) + 1e-6 * Vector2d(-along.y(), along.x()).normalized();
  const int wanted = windings(contour, left);
  for (std::size_t i = 0; i < path.size(); i += 7) {
    check.right_side = check.right_side && windings(contour, path[i].a) == wanted;
  }
  return check;
}

}  // namespace kerfbench::planner
