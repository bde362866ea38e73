// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/gcode_departure.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <unordered_map>
#include <utility>

namespace kerfbench::desk {
namespace {

using Eigen::Vector2d;
using planner::Segment;

bool isCut(const Segment& segment) { return !segment.jump && segment.z > 0.0; }

/// Places along a cut, both ends included.
template <typename Take>
void walk(const Segment& segment, const Take& take) {
  const double length_mm = segment.lengthMm();
  const int parts = std::max(1, static_cast<int>(std::ceil(length_mm / kLookEvery_mm)));
  for (int i = 0; i <= parts; ++i) take(segment.at(length_mm * i / parts));
}

double distanceTo(const Segment& segment, const Vector2d& p) {
  const Vector2d a = segment.start_mm, b = segment.end_mm;
  const double to_ends = std::min((p - a).norm(), (p - b).norm());
  if (!segment.isArc()) {
    const Vector2d ab = b - a;
    const double square = ab.squaredNorm();
    if (square <= 0.0) return to_ends;
    return (p - a - std::clamp((p - a).dot(ab) / square, 0.0, 1.0) * ab).norm();
  }
  const Vector2d from = a - segment.centre_mm, to = p - segment.centre_mm;
  double turn_rad = std::atan2(planner::cross(from, to), from.dot(to));
  if (segment.sweep_rad > 0.0 && turn_rad < 0.0) turn_rad += 2.0 * std::numbers::pi;
  if (segment.sweep_rad < 0.0 && turn_rad > 0.0) turn_rad -= 2.0 * std::numbers::pi;
  const double share = turn_rad / segment.sweep_rad;
  if (share < 0.0 || share > 1.0) return to_ends;
  return std::min(to_ends, std::abs(to.norm() - segment.radiusMm()));
}

/// Cuts by the squares of the sheet that they pass, so that a place is held against its neighbours alone.
class CutGrid {
 public:
  explicit CutGrid(const std::vector<Segment>& path) {
    for (const Segment& segment : path) {
      if (!isCut(segment)) continue;
      walk(segment, [&](const Vector2d& p) {
        auto& here = squares_[keyOf(squareOf(p.x()), squareOf(p.y()))];
        if (here.empty() || here.back() != &segment) here.push_back(&segment);
      });
    }
  }

  /// Distance of the nearest cut, kFarthestLooked_mm at most.
  [[nodiscard]] double distanceFrom(const Vector2d& p) const {
    double nearest_mm = kFarthestLooked_mm;
    const std::int64_t x = squareOf(p.x()), y = squareOf(p.y());
    for (std::int64_t i = x - 1; i <= x + 1; ++i) {
      for (std::int64_t j = y - 1; j <= y + 1; ++j) {
        const auto found = squares_.find(keyOf(i, j));
        if (found == squares_.end()) continue;
        for (const Segment* segment : found->second)
          nearest_mm = std::min(nearest_mm, distanceTo(*segment, p));
      }
    }
    return nearest_mm;
  }

 private:
  // A cut may pass a corner of a square between two looks.
  static constexpr double kSquare_mm = kFarthestLooked_mm + kLookEvery_mm;
  static std::int64_t squareOf(double at_mm) {
    return static_cast<std::int64_t>(std::floor(at_mm / kSquare_mm));
  }
  static std::uint64_t keyOf(std::int64_t x, std::int64_t y) {
    return (static_cast<std::uint64_t>(x) << 32U) ^ (static_cast<std::uint64_t>(y) & 0xffffffffU);
  }
  std::unordered_map<std::uint64_t, std::vector<const Segment*>> squares_;
};

std::vector<GcodeDeparture> departuresFrom(const CutGrid& plan, const std::vector<Segment>& gcode,
                                           double within_mm) {
  std::map<int, GcodeDeparture> by_line;
  for (const Segment& segment : gcode) {
    if (!isCut(segment)) continue;
    walk(segment, [&](const Vector2d& p) {
      const double off_mm = plan.distanceFrom(p);
      if (off_mm <= within_mm) return;
      GcodeDeparture& worst = by_line[segment.line];
      if (off_mm > worst.off_mm) worst = {segment.line, off_mm, p};
    });
  }
  std::vector<GcodeDeparture> list;
  for (const auto& [line, worst] : by_line) list.push_back(worst);
  return list;
}

std::vector<UncutPiece> uncutOf(const CutGrid& gcode, const std::vector<Segment>& planned, double within_mm) {
  constexpr double kShortest_mm = 3.0 * kLookEvery_mm;
  std::vector<UncutPiece> list;
  const auto pieceOf = [&](int entity) -> UncutPiece& {
    const auto known = std::ranges::find(list, entity, &UncutPiece::entity);
    return known != list.end() ? *known : list.emplace_back(UncutPiece{entity, 0.0});
  };
  for (const Segment& segment : planned) {
    if (!isCut(segment)) continue;
    std::size_t looks = 0, uncut = 0;
    walk(segment, [&](const Vector2d& p) {
      ++looks;
      uncut += gcode.distanceFrom(p) > within_mm ? 1 : 0;
    });
    if (uncut == 0) continue;
    pieceOf(segment.entity).length_mm +=
        segment.lengthMm() * static_cast<double>(uncut) / static_cast<double>(looks);
  }
  std::erase_if(list, [](const UncutPiece& piece) { return piece.length_mm < kShortest_mm; });
  return list;
}

}  // namespace

GcodeComparison comparedWithPlan(const std::vector<Segment>& gcode, const std::vector<Segment>& planned,
                                 double within_mm) {
  return {departuresFrom(CutGrid(planned), gcode, within_mm), uncutOf(CutGrid(gcode), planned, within_mm)};
}

}  // namespace kerfbench::desk
