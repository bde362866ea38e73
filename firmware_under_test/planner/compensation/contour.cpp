// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/compensation/contour.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firmware_under_test/planner/compensation/curves.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

/// Two places of a contour that are nearer than this along it belong to one joint.
constexpr double kOneJointMm = 0.02;
constexpr double kNoLengthMm = 1e-9;
constexpr std::size_t kMostNames = 4;

bool finite(const Segment& s) {
  return s.start_mm.allFinite() && s.end_mm.allFinite() && s.centre_mm.allFinite() &&
         std::isfinite(s.sweep_rad);
}

void requireSound(const Segment& segment, double join_mm) {
  if (!finite(segment)) {
    throw CompensationError(entityNames({segment.entity}) + " holds a number that is not finite");
  }
  if (!segment.isArc()) return;
  const double difference =
      (segment.start_mm - segment.centre_mm).norm() - (segment.end_mm - segment.centre_mm).norm();
  if (!(segment.radiusMm() > kNoLengthMm)) {
    throw CompensationError(placeName({segment.entity}, segment.start_mm) + ": an arc without a radius");
  }
  if (std::abs(difference) > join_mm) {
    throw CompensationError(fmt::format("{}: the arc's ends lie {:.4f} mm apart in radius",
                                        placeName({segment.entity}, segment.start_mm), std::abs(difference)));
  }
}

/// Corrects an arc to one circle through both ends, which move along their radius, and to the sweep that
/// leads from one to the other.
Segment trueArc(Segment arc) {
  const double r = arc.radiusMm();
  const Vector2d from = arc.start_mm - arc.centre_mm;
  const Vector2d to = arc.end_mm - arc.centre_mm;
  if (from.norm() != to.norm()) {
    arc.start_mm = arc.centre_mm + r * from.normalized();
    arc.end_mm = arc.centre_mm + r * to.normalized();
  }
  const double between = std::atan2(cross(from, to), from.dot(to));
  arc.sweep_rad += std::remainder(between - arc.sweep_rad, 2.0 * std::numbers::pi);
  return arc;
}

Segment bridge(const Segment& a, const Segment& b) {
  Segment line;
  line.start_mm = a.end_mm;
  line.end_mm = b.start_mm;
  line.entity = a.entity;
  line.z = a.z;
  return line;
}

/// Turns and scales the segment a little so that its ends are these.
Segment pinned(const Segment& segment, const Vector2d& start, const Vector2d& end) {
  Segment moved = segment;
  moved.start_mm = start;
  moved.end_mm = end;
  if (!segment.isArc()) return moved;
  const Vector2d chord = end - start;
  moved.centre_mm =
      start + 0.5 * (chord + Vector2d(-chord.y(), chord.x()) / std::tan(0.5 * segment.sweep_rad));
  return moved;
}

/// True if no point of the segment moves by much more than its end does.
bool bearsPinning(const Segment& segment, double gap_mm) {
  const double chord = (segment.end_mm - segment.start_mm).norm();
  return chord > 10.0 * gap_mm &&
         (!segment.isArc() || chord > 0.5 * segment.radiusMm() || std::abs(segment.sweep_rad) < 1.0);
}

/// Moves the end of a to the start of b; returns the line that has to go between them, if one has to.
std::optional<Segment> join(Segment& a, Segment& b, double join_mm) {
  const double gap = (b.start_mm - a.end_mm).norm();
  if (gap == 0.0) return std::nullopt;
  if (gap > join_mm) {
    throw CompensationError(
        fmt::format("{}: a gap of {:.4f} mm", placeName({a.entity, b.entity}, a.end_mm), gap));
  }
  const bool moves_a = bearsPinning(a, gap) && !(a.isArc() && !b.isArc() && bearsPinning(b, gap));
  if (moves_a) {
    a = pinned(a, a.start_mm, b.start_mm);
  } else if (bearsPinning(b, gap)) {
    b = pinned(b, a.end_mm, b.end_mm);
  } else {
    return bridge(a, b);
  }
  return std::nullopt;
}

struct Located {
  const Segment* segment;
  Eigen::AlignedBox2d box;
  std::size_t contour;
  double begin_mm;    ///< Arc length of the segment's start along the contour.
  double contour_mm;  ///< Length of the whole contour.
};

double lengthOf(const Contour& contour) {
  double length = 0.0;
  for (const Segment& segment : contour.segments) length += segment.lengthMm();
  return length;
}

std::vector<Located> located(const std::vector<Contour>& contours) {
  std::vector<Located> all;
  for (std::size_t c = 0; c < contours.size(); ++c) {
    double at = 0.0;
    const double length = lengthOf(contours[c]);
    for (const Segment& segment : contours[c].segments) {
      Eigen::AlignedBox2d box = boxOf(segment);
      box.min().array() -= kTouchMm;
      box.max().array() += kTouchMm;
      all.push_back({&segment, box, c, at, length});
      at += segment.lengthMm();
    }
  }
  return all;
}

/// True if the meeting of two segments of one contour at p is just the joint between them.
bool isJoint(const Located& a, const Located& b, const Vector2d& p, bool closed) {
  if (a.contour != b.contour) return false;
  const double sa = a.begin_mm + stationMm(*a.segment, p);
  const double sb = b.begin_mm + stationMm(*b.segment, p);
  const double apart = std::abs(sa - sb);
  // The limit keeps a short contour from being all joint.
  const double limit = std::min(kOneJointMm, 0.1 * a.contour_mm);
  return apart < limit || (closed && a.contour_mm - apart < limit);
}

}  // namespace

std::string entityNames(const std::vector<int>& entities) {
  std::vector<std::string> names;
  for (const int entity : entities) {
    if (entity < 0) continue;
    const std::string name = fmt::format("E{}", entity);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  if (names.empty()) return "the contour";
  if (names.size() <= kMostNames) return fmt::format("{}", fmt::join(names, " and "));
  const std::size_t more = names.size() - kMostNames;
  names.resize(kMostNames);
  return fmt::format("{} and {} more", fmt::join(names, ", "), more);
}

std::string placeName(const std::vector<int>& entities, const Vector2d& p_mm) {
  return fmt::format("{} at ({:.3f}, {:.3f})", entityNames(entities), p_mm.x(), p_mm.y());
}

Contour healed(Contour contour, double join_mm) {
  std::vector<Segment> sound;
  for (const Segment& segment : contour.segments) {
    requireSound(segment, join_mm);
    if (segment.lengthMm() > kNoLengthMm)
      sound.push_back(segment.isArc() && !segment.isCircle() ? trueArc(segment) : segment);
  }
  contour.segments.clear();
  if (sound.size() == 1 && sound.front().isCircle()) {
    sound.front().end_mm = sound.front().start_mm;
    contour.closed = true;
    contour.segments = sound;
    return contour;
  }
  const std::size_t joints = sound.empty() ? 0 : sound.size() - (contour.closed ? 0 : 1);
  std::vector<std::optional<Segment>> between(sound.size());
  for (std::size_t i = 0; i < joints; ++i) {
    between[i] = join(sound[i], sound[(i + 1) % sound.size()], join_mm);
  }
  for (std::size_t i = 0; i < sound.size(); ++i) {
    contour.segments.push_back(sound[i]);
    if (between[i]) contour.segments.push_back(*between[i]);
  }
  return contour;
}

std::vector<std::string> contactFaults(const std::vector<Contour>& contours) {
  const std::vector<Located> all = located(contours);
  std::vector<std::string> faults;
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      const Located& a = all[i];
      const Located& b = all[j];
      if (!a.box.intersects(b.box)) continue;
      const std::vector<Vector2d> met = meetings(*a.segment, *b.segment);
      const auto contact = std::find_if(met.begin(), met.end(), [&](const Vector2d& p) {
        return !isJoint(a, b, p, contours[a.contour].closed);
      });
      if (contact == met.end()) continue;
      faults.push_back(fmt::format(
          "{}: the cut {}, so that no side of it is the inside",
          placeName({a.segment->entity, b.segment->entity}, *contact),
          a.contour == b.contour ? "crosses, touches or runs back over itself" : "meets another one"));
      if (faults.size() == kMostFaults) return faults;
    }
  }
  return faults;
}

}  // namespace kerfbench::planner
