// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/program_path.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/job/job.h"

namespace kerfbench::judge {
namespace {

constexpr double kJoined_mm = 1e-3;
constexpr double kChord_mm = 0.05;
/// Within which a program without names of entities is taken for that of a line.
constexpr double kUnnamedReach_mm = 0.5;

bool isLit(const planner::Segment& segment) { return !segment.jump && segment.z > 0.0; }

}  // namespace

bool ProgramPath::Piece::has(int entity) const {
  return std::ranges::any_of(segments, [&](const planner::Segment& s) { return s.entity == entity; });
}

ProgramPath::ProgramPath(const std::string& gcode) {
  std::vector<planner::Segment> path;
  try {
    path = planner::readGcode(gcode);
  } catch (const planner::PlanError&) {
    return;
  }
  bool open = false;
  for (const planner::Segment& segment : path) {
    if (!isLit(segment)) {
      open = open && segment.lengthMm() < kJoined_mm;
      continue;
    }
    if (!open) pieces_.emplace_back();
    open = true;
    Piece& piece = pieces_.back();
    piece.segments.push_back(segment);
    piece.z += segment.z * segment.lengthMm();
    piece.length_mm += segment.lengthMm();
  }
  for (Piece& piece : pieces_)
    if (piece.length_mm > 0.0) piece.z /= piece.length_mm;
}

bool ProgramPath::has(int entity) const {
  return std::ranges::any_of(pieces_, [&](const Piece& piece) { return piece.has(entity); });
}

bool ProgramPath::isNamed() const {
  return std::ranges::any_of(pieces_, [](const Piece& piece) {
    return std::ranges::any_of(piece.segments, [](const planner::Segment& s) { return s.entity >= 0; });
  });
}

double ProgramPath::lengthOf(int entity) const {
  double length_mm = 0.0;
  for (const Piece& piece : pieces_)
    for (const planner::Segment& segment : piece.segments)
      if (segment.entity == entity) length_mm += segment.lengthMm();
  return length_mm;
}

double ProgramPath::offsetAt(int entity, const Eigen::Vector2d& p_S_mm, const Eigen::Vector2d& normal,
                             double reach_mm) const {
  const bool is_named = has(entity);
  if (!is_named && isNamed()) return std::numeric_limits<double>::quiet_NaN();
  Crossing crossing(p_S_mm, normal, is_named ? reach_mm : std::min(reach_mm, kUnnamedReach_mm));
  for (const Piece& piece : pieces_) {
    for (const planner::Segment& segment : piece.segments) {
      if (is_named && segment.entity != entity) continue;
      const double length_mm = segment.lengthMm();
      // A chord of 0.05 mm leaves 0.3 um of a circle of 1 mm.
      const int parts = segment.isArc() ? std::max(1, static_cast<int>(std::ceil(length_mm / kChord_mm))) : 1;
      Eigen::Vector2d before = segment.start_mm;
      for (int i = 1; i <= parts; ++i) {
        const Eigen::Vector2d after = segment.at(length_mm * i / parts);
        crossing.take(before, after);
        before = after;
      }
    }
  }
  return crossing.offset_mm();
}

bool Crossing::take(const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm) {
  const Eigen::Vector2d tangent(normal_.y(), -normal_.x());
  const double before = (from_mm - p_mm_).dot(tangent);
  const double after = (to_mm - p_mm_).dot(tangent);
  if (!(before * after <= 0.0) || before == after) return false;
  const double share = before / (before - after);
  const double offset = (from_mm + share * (to_mm - from_mm) - p_mm_).dot(normal_);
  if (std::abs(offset) > reach_mm_ || std::abs(offset) >= std::abs(offset_mm_)) return false;
  offset_mm_ = offset;
  share_ = share;
  return true;
}

}  // namespace kerfbench::judge
