// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/pdf_clip.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "hil/dieline/curve_math.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;
using Side = PdfClip::Side;

constexpr double kEdge_mm = 0.01;  // Nearer to the edge of a clip is on it.

double crossOf(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// The box that a region is, if it is one.
std::optional<Eigen::AlignedBox2d> asBox(const PdfRegion& region) {
  constexpr double kSquare_mm = 1e-6;
  if (region.polygons_mm.size() != 1) return std::nullopt;
  std::vector<Vector2d> corners = region.polygons_mm.front();
  if (corners.size() == 5 && (corners.front() - corners.back()).norm() <= kSquare_mm) corners.pop_back();
  if (corners.size() != 4) return std::nullopt;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector2d side = corners[(i + 1) % 4] - corners[i];
    const Vector2d next = corners[(i + 2) % 4] - corners[(i + 1) % 4];
    if (side.cwiseAbs().minCoeff() > kSquare_mm || std::abs(side.dot(next)) > kSquare_mm * side.norm())
      return std::nullopt;
  }
  Eigen::AlignedBox2d box;
  for (const Vector2d& corner : corners) box.extend(corner);
  return box;
}

double distanceTo(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d d = b - a;
  const double squared = d.squaredNorm();
  const double u = squared > 0 ? std::clamp((p - a).dot(d) / squared, 0.0, 1.0) : 0.0;
  return (a + u * d - p).norm();
}

template <class Visit>
void eachEdge(const PdfRegion& region, Visit visit) {
  for (const auto& polygon : region.polygons_mm) {
    for (std::size_t i = 0; i < polygon.size(); ++i) visit(polygon[i], polygon[(i + 1) % polygon.size()]);
  }
}

/// Inside, outside, or nothing on the edge.
std::optional<Side> sideOfPoint(const PdfRegion& region, const Vector2d& p) {
  int winding = 0;
  int crossings = 0;
  double nearest_mm = INFINITY;
  eachEdge(region, [&](const Vector2d& a, const Vector2d& b) {
    nearest_mm = std::min(nearest_mm, distanceTo(p, a, b));
    if ((a.y() <= p.y()) == (b.y() <= p.y())) return;
    if ((crossOf(b - a, p - a) > 0) != (b.y() > a.y())) return;
    winding += b.y() > a.y() ? 1 : -1;
    ++crossings;
  });
  if (nearest_mm <= kEdge_mm) return std::nullopt;
  const bool is_inside = region.is_even_odd ? crossings % 2 != 0 : winding != 0;
  return is_inside ? Side::kInside : Side::kOutside;
}

/// What of several pieces is seen.
struct Seen {
  bool inside{};
  bool outside{};
  [[nodiscard]] Side side() const {
    return inside && outside ? Side::kAcross : outside ? Side::kOutside : Side::kInside;
  }
};

/// A straight piece against a region: cut where it meets an edge, and looked at in the middle of each part.
void look(const PdfRegion& region, const Vector2d& from, const Vector2d& to, Seen& seen, std::size_t& work) {
  std::vector<double> cuts{0.0, 1.0};
  const Vector2d d = to - from;
  std::size_t edges = 0;
  eachEdge(region, [&](const Vector2d& a, const Vector2d& b) {
    ++edges;
    const double across = crossOf(d, b - a);
    if (across == 0) return;
    const double t = crossOf(a - from, b - a) / across;
    const double u = crossOf(a - from, d) / across;
    if (t > 0 && t < 1 && u >= 0 && u <= 1) cuts.push_back(t);
  });
  std::sort(cuts.begin(), cuts.end());
  work += edges * cuts.size();
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    // A part that is shorter than the edge is wide is on it.
    if ((cuts[i + 1] - cuts[i]) * d.norm() <= kEdge_mm && cuts.size() > 2) continue;
    const auto side = sideOfPoint(region, from + d * (cuts[i] + cuts[i + 1]) / 2);
    if (!side) continue;
    (*side == Side::kInside ? seen.inside : seen.outside) = true;
  }
}

PdfRegion regionOf(const Eigen::AlignedBox2d& box) {
  using Corner = Eigen::AlignedBox2d;
  return {{{box.corner(Corner::BottomLeft), box.corner(Corner::BottomRight), box.corner(Corner::TopRight),
            box.corner(Corner::TopLeft)}},
          false};
}

Side sideOfCurve(const PdfRegion& region, const Curve& curve, std::size_t& work) {
  const int pieces = std::holds_alternative<LineCurve>(curve) ? 1 : 64;
  Seen seen;
  Vector2d from = pointAt(curve, 0);
  for (int i = 1; i <= pieces; ++i) {
    const Vector2d to = pointAt(curve, static_cast<double>(i) / pieces);
    look(region, from, to, seen, work);
    from = to;
  }
  return seen.side();
}

}  // namespace

PdfClip PdfClip::within(PdfRegion region) const {
  PdfClip clip = *this;
  if (const auto box = asBox(region)) {
    clip.box_mm_ = box_mm_.intersection(*box);
  } else {
    clip.regions_ = std::make_shared<const Link>(Link{std::move(region), regions_, regions() + 1});
  }
  return clip;
}

Side PdfClip::sideOf(const Curve& curve, std::size_t& work) const {
  const Eigen::AlignedBox2d box_mm = boundsOf(curve);
  const Vector2d edge = Vector2d::Constant(kEdge_mm);
  const Eigen::AlignedBox2d wide(box_mm_.min() - edge, box_mm_.max() + edge);
  Side side = Side::kInside;
  ++work;
  if (box_mm_.isEmpty() || !wide.intersects(box_mm)) return Side::kOutside;
  if (!wide.contains(box_mm)) side = sideOfCurve(regionOf(box_mm_), curve, work);
  for (const Link* link = regions_.get(); link != nullptr && side != Side::kOutside;
       link = link->outer.get()) {
    const Side next = sideOfCurve(link->region, curve, work);
    if (next != Side::kInside) side = next;
  }
  return side;
}

}  // namespace kerfbench::dieline
