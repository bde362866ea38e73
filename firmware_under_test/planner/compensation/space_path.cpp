// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/compensation/space_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Geometry>

#include "firmware_under_test/planner/compensation/contour.h"
#include "firmware_under_test/planner/geometry/angles.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNoFoldLengthMm = 1e-6;
constexpr double kFoldTooNearMm = 1e-6;
/// Angles below which a line runs along the fold, and a turn is one by 180°.
constexpr double kAlongRad = 0.1 * kDeg;

struct Line {
  Vector3d a;
  Vector3d b;
  Vector3d u;   ///< Unit vector from a to b.
  Vector3d n;   ///< Unit vector perpendicular to u.
  Vector3d nu;  ///< Unit vector to the beam's side in the plane.
  double length{};
};

/// Path of the beam round the end of one line and the begin of the next.
struct Corner {
  double cut_first_mm{};
  double cut_second_mm{};
  std::vector<SpacePoint> points;
  SpaceJointReport report;
};

std::string placeOf(const SpaceContour& contour, std::size_t point) {
  const Vector3d& p = contour.points[point].p_mm;
  const std::string where = fmt::format("({:.3f}, {:.3f}, {:.3f})", p.x(), p.y(), p.z());
  if (point < contour.file_lines.size()) return fmt::format("line {}: {}", contour.file_lines[point], where);
  return fmt::format("point {} {}", point + 1, where);
}

/// Lets one fault of all of a curve's chords through.
class OncePerCurve {
 public:
  bool isNew(const SpaceContour& contour, std::size_t line) {
    const SpaceCurve* curve = contour.curveOf(line);
    const bool known = curve != nullptr && curve == last_;
    last_ = curve;
    return !known;
  }

 private:
  const SpaceCurve* last_{};
};

std::vector<Line> linesOf(const SpaceContour& contour, const SpaceLimits& limits,
                          std::vector<std::string>& faults) {
  std::vector<Line> lines;
  OncePerCurve told;
  const double side = contour.side == Side::kLeft ? 1.0 : -1.0;
  for (std::size_t i = 0; i + 1 < contour.points.size(); ++i) {
    const SpacePoint& from = contour.points[i];
    Line line{from.p_mm, contour.points[i + 1].p_mm, {}, {}, {}, 0.0};
    const auto fault = [&](const std::string& what) {
      if (told.isNew(contour, i)) faults.push_back(placeOf(contour, i) + ": " + what);
    };
    if (!line.a.allFinite() || !line.b.allFinite() || !from.axis.allFinite()) {
      fault("a number is not finite");
      continue;
    }
    line.length = (line.b - line.a).norm();
    if (line.length < kNoFoldLengthMm) {
      fault("a line of no length begins here");
      continue;
    }
    if (std::abs(from.axis.norm() - 1.0) > 0.01) {
      fault(fmt::format("the axis is no unit vector, its length is {:.4f}", from.axis.norm()));
      continue;
    }
    line.u = (line.b - line.a) / line.length;
    const double askew = std::asin(std::clamp(from.axis.normalized().dot(line.u), -1.0, 1.0)) / kDeg;
    if (std::abs(askew) > limits.askew_deg) {
      fault(fmt::format("the axis stands {:.2f}° off the right angle to its line", std::abs(askew)));
      continue;
    }
    line.n = (from.axis - from.axis.dot(line.u) * line.u).normalized();
    line.nu = side * line.n.cross(line.u);
    lines.push_back(line);
  }
  return lines;
}

/// Corner in one plane: shortened, extended, or two corners on tangents where it turns away by more than 90°.
Corner planeCorner(const Line& in, const Line& out, double radius_mm, double side) {
  Corner corner;
  corner.report.joint = SpaceJoint::kPlanar;
  corner.report.corner.omega_rad = kPi;
  const double turn = side * std::atan2(in.n.dot(in.u.cross(out.u)), in.u.dot(out.u));
  const double reach = radius_mm * std::tan(0.5 * std::abs(turn));
  const Vector3d foot = in.b + radius_mm * in.nu;
  if (turn > 0.0) {
    corner.cut_first_mm = corner.cut_second_mm = reach;
    corner.points.push_back({foot - reach * in.u, in.n});
  } else if (-turn < 0.5 * kPi + 1e-9) {
    corner.points.push_back({foot + reach * in.u, in.n});
  } else {
    const double half = radius_mm * std::tan(-0.25 * turn);
    corner.points.push_back({foot + half * in.u, in.n});
    corner.points.push_back({out.a + radius_mm * out.nu - half * out.u, in.n});
  }
  return corner;
}

/// The two half planes at a fold, or the reason why no path leads round it.
struct Fold {
  Vector3d along;  ///< Direction of the fold on the offsets' side.
  Vector3d h1;     ///< Direction from the fold into the plane of AB.
  Vector3d h2;
  FoldCorner corner;
  std::string fault;
};

Fold foldOf(const Line& in, const Line& out, const SpaceLimits& limits) {
  Fold fold;
  const auto refuse = [&](std::string why) {
    fold.fault = std::move(why);
    return fold;
  };
  const Vector3d m = in.n.cross(out.n).normalized();
  fold.along = in.nu.dot(m) > 0.0 ? m : Vector3d(-m);
  const double alpha = std::acos(std::clamp(in.u.dot(fold.along), -1.0, 1.0));
  const double beta = std::acos(std::clamp(-out.u.dot(fold.along), -1.0, 1.0));
  for (const double angle : {alpha, beta}) {
    if (std::min(angle, kPi - angle) < kAlongRad)
      return refuse("a line runs along the fold between its planes");
  }
  const auto across = [&](const Vector3d& v) {
    return Vector3d((v - v.dot(fold.along) * fold.along).normalized());
  };
  fold.h1 = across(-in.u);
  fold.h2 = across(out.u);
  double omega = std::atan2(fold.h2.dot(in.n), fold.h2.dot(fold.h1));
  if (omega < 0.0) omega += 2.0 * kPi;
  const double deg = omega / kDeg;
  const Vector3d expected = std::sin(omega) * fold.h1 - std::cos(omega) * in.n;
  if (out.n.dot(expected) < 0.5) return refuse("the axis changes to the other face of the sheet");
  if (deg < limits.narrowest_deg - 1e-6) {
    return refuse(fmt::format("{:.2f}° between the planes: below {:g}° the head has no room", deg,
                              limits.narrowest_deg));
  }
  if (deg > 360.0 - limits.pierced_deg) {
    return refuse(fmt::format("{:.2f}° round the edge: above {:g}° the beam pierces the second plane", deg,
                              360.0 - limits.pierced_deg));
  }
  fold.corner = {alpha, beta, omega};
  return fold;
}

/// Joint over a fold by either law; nullopt where the paper's text gives no points.
std::optional<FoldPath> jointBy(JointLaw law, const FoldCorner& corner, double radius_mm) {
  if (law == JointLaw::kOurs) return foldPath(corner, radius_mm);
  PaperPath paper = paperPath(corner, radius_mm);
  if (!paper.exists) return std::nullopt;
  return FoldPath{paper.cut_first_mm, paper.cut_second_mm,     std::move(paper.first),
                  paper.fold_mm,      std::move(paper.second), false};
}

Corner foldCorner(const Line& in, const Line& out, const Fold& fold, const FoldPath& path) {
  Corner corner;
  corner.cut_first_mm = path.cut_first_mm;
  corner.cut_second_mm = path.cut_second_mm;
  const Vector3d& b = in.b;
  for (const Vector2d& p : path.first) {
    corner.points.push_back({b + p.x() * fold.along + p.y() * fold.h1, in.n});
  }
  corner.points.push_back({b + path.fold_mm * fold.along, in.n});
  corner.points.push_back({b + path.fold_mm * fold.along, out.n});
  for (auto p = path.second.rbegin(); p != path.second.rend(); ++p) {
    corner.points.push_back({b + p->x() * fold.along + p->y() * fold.h2, out.n});
  }
  corner.report.corner = fold.corner;
  corner.report.joint = fold.corner.joint();
  corner.report.number = fold.corner.number();
  corner.report.drawn_back = path.drawn_back;
  return corner;
}

/// A point of a contour, the lines that meet there, and how a path shall lead round it.
struct MeetingLines {
  std::size_t point;
  const Line& in;
  const Line& out;
  double radius_mm;
  JointLaw law;
};

Corner cornerAt(const SpaceContour& contour, const MeetingLines& joint, const SpaceLimits& limits,
                std::vector<std::string>& faults) {
  const auto& [point, in, out, radius_mm, law] = joint;
  Corner corner;
  const double between = std::atan2(in.n.cross(out.n).norm(), in.n.dot(out.n)) / kDeg;
  if (between <= limits.planar_deg) {
    if (std::acos(std::clamp(in.u.dot(out.u), -1.0, 1.0)) > kPi - kAlongRad) {
      faults.push_back(placeOf(contour, point) + ": the contour turns back on itself");
      return corner;
    }
    corner = planeCorner(in, out, radius_mm, contour.side == Side::kLeft ? 1.0 : -1.0);
  } else if (between > 180.0 - 1e-6) {
    faults.push_back(placeOf(contour, point) + ": the planes lie back to back, or face to face");
  } else {
    const Fold fold = foldOf(in, out, limits);
    const std::optional<FoldPath> path =
        fold.fault.empty() ? jointBy(law, fold.corner, radius_mm) : std::nullopt;
    if (path) {
      corner = foldCorner(in, out, fold, *path);
    } else {
      faults.push_back(placeOf(contour, point) + ": " +
                       (fold.fault.empty() ? "the paper's joint of fixed length has no point here: no place "
                                             "of the other offset is at the radius"
                                           : fold.fault));
    }
  }
  corner.report.point = point;
  return corner;
}

/// Finds pieces of path that come nearer than the radius to a line of the contour.
void checkClear(const SpaceContour& contour, const std::vector<Line>& lines, const SpacePath& path,
                double radius_mm, std::vector<std::string>& faults) {
  OncePerCurve told;
  for (std::size_t j = 0; j < lines.size(); ++j) {
    const Line& line = lines[j];
    Eigen::AlignedBox3d box(line.a);
    box.extend(line.b);
    double nearest = radius_mm - kFoldTooNearMm;
    Vector3d where = Vector3d::Zero();
    for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
      const Vector3d& p = path.points[i].p_mm;
      const Vector3d& q = path.points[i + 1].p_mm;
      Eigen::AlignedBox3d piece(p);
      piece.extend(q);
      if (box.exteriorDistance(piece) >= radius_mm) continue;
      const double d = distanceMm(p, q, line.a, line.b);
      if (d >= nearest) continue;
      nearest = d;
      where = 0.5 * (p + q);
    }
    if (nearest < radius_mm - kFoldTooNearMm && told.isNew(contour, j)) {
      faults.push_back(
          fmt::format("{}: the path comes as near as {:.4f} mm to the line that begins here, about ({:.3f}, "
                      "{:.3f}, {:.3f})",
                      placeOf(contour, j), nearest, where.x(), where.y(), where.z()));
    }
  }
}

/// Finds lines that are shorter than what the joints at their ends take.
void checkLengths(const SpaceContour& contour, const std::vector<Line>& lines,
                  const std::vector<Corner>& corners, std::vector<std::string>& faults) {
  OncePerCurve told;
  const bool closed = corners.size() == lines.size();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double begin = i > 0 ? corners[i - 1].cut_second_mm : (closed ? corners.back().cut_second_mm : 0.0);
    const double end = i < corners.size() ? corners[i].cut_first_mm : 0.0;
    if (begin + end <= lines[i].length - kNoFoldLengthMm || !told.isNew(contour, i)) continue;
    const char* what = contour.curveOf(i) != nullptr
                           ? "the curve is tighter than the radius on the beam's side, or ends in a corner "
                             "there; a chord"
                           : "the line";
    faults.push_back(fmt::format("{}: {} is {:.4f} mm long, its joints take {:.4f} mm of it",
                                 placeOf(contour, i), what, lines[i].length, begin + end));
  }
}

/// Puts the offset lines and their joints together.
SpacePath joined(const std::vector<Line>& lines, const std::vector<Corner>& corners, double radius_mm) {
  SpacePath path;
  const bool closed = corners.size() == lines.size();
  path.points.push_back(closed ? corners.back().points.back()
                               : SpacePoint{lines.front().a + radius_mm * lines.front().nu, lines.front().n});
  for (const Corner& corner : corners) {
    path.joints.push_back(corner.report);
    path.joints.back().first_path_point = path.points.size();
    path.joints.back().path_points = corner.points.size();
    path.points.insert(path.points.end(), corner.points.begin(), corner.points.end());
  }
  if (!closed) path.points.push_back({lines.back().b + radius_mm * lines.back().nu, lines.back().n});
  return path;
}

void throwIfAny(std::vector<std::string> faults) {
  if (faults.empty()) return;
  if (faults.size() > kMostFaults) {
    const std::size_t more = faults.size() - kMostFaults;
    faults.resize(kMostFaults);
    faults.push_back(fmt::format("and {} more", more));
  }
  throw CompensationError(fmt::format("{}", fmt::join(faults, "\n")));
}

}  // namespace

double distanceMm(const Vector3d& a0, const Vector3d& a1, const Vector3d& b0, const Vector3d& b1) {
  // The least of |r + s d1 - t d2| over the unit square is on the border lines, or the inner minimum if it is
  // inside.
  const Vector3d d1 = a1 - a0;
  const Vector3d d2 = b1 - b0;
  const Vector3d r = a0 - b0;
  const auto toLine = [](const Vector3d& p, const Vector3d& from, const Vector3d& d) {
    const double square = d.squaredNorm();
    const double t = square > 0.0 ? std::clamp((p - from).dot(d) / square, 0.0, 1.0) : 0.0;
    return (p - from - t * d).norm();
  };
  double least = std::min({toLine(a0, b0, d2), toLine(a1, b0, d2), toLine(b0, a0, d1), toLine(b1, a0, d1)});
  const double det = d1.squaredNorm() * d2.squaredNorm() - d1.dot(d2) * d1.dot(d2);
  if (det > 1e-18 * d1.squaredNorm() * d2.squaredNorm()) {
    const double s = (d1.dot(d2) * d2.dot(r) - d2.squaredNorm() * d1.dot(r)) / det;
    const double t = (d1.squaredNorm() * d2.dot(r) - d1.dot(d2) * d1.dot(r)) / det;
    if (s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0) least = std::min(least, (r + s * d1 - t * d2).norm());
  }
  return least;
}

const SpaceCurve* SpaceContour::curveOf(std::size_t point) const {
  for (const SpaceCurve& curve : curves) {
    if (point >= curve.first_point && point < curve.first_point + curve.chords) return &curve;
  }
  return nullptr;
}

SpacePath offsetInSpace(const SpaceContour& contour, double radius_mm, const SpaceLimits& limits,
                        JointLaw law) {
  if (!(radius_mm > 0.0) || !std::isfinite(radius_mm)) {
    throw CompensationError(fmt::format("the spot's radius must be > 0, but is {:g} mm", radius_mm));
  }
  if (contour.points.size() < 2) throw CompensationError("a contour needs two points");
  std::vector<std::string> faults;
  const std::vector<Line> lines = linesOf(contour, limits, faults);
  throwIfAny(faults);

  const std::size_t n = lines.size();
  const bool closed = n > 2 && (lines.front().a - lines.back().b).norm() < kNoFoldLengthMm;
  std::vector<Corner> corners;
  for (std::size_t i = 0; i + 1 < n + (closed ? 1 : 0); ++i) {
    const MeetingLines meeting{i + 1, lines[i], lines[(i + 1) % n], radius_mm, law};
    corners.push_back(cornerAt(contour, meeting, limits, faults));
  }
  throwIfAny(faults);
  checkLengths(contour, lines, corners, faults);
  throwIfAny(faults);

  SpacePath path = joined(lines, corners, radius_mm);
  checkClear(contour, lines, path, radius_mm, law == JointLaw::kPaper ? path.burns : faults);
  throwIfAny(faults);
  return path;
}

}  // namespace kerfbench::planner
