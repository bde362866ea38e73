// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/pdf_path.h"

#include <algorithm>
#include <cmath>

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;

constexpr double kNothing_mm = 1e-4;  // Rounding of decimals; as much as an SVG's closing may miss.

bool isNothing(const Curve& curve) {
  if (const auto* line = std::get_if<LineCurve>(&curve))
    return (line->end_mm - line->start_mm).norm() <= kNothing_mm;
  const auto* bezier = std::get_if<BezierCurve>(&curve);
  return bezier != nullptr &&
         (bezier->control_mm.colwise() - bezier->control_mm.col(0)).colwise().norm().maxCoeff() <=
             kNothing_mm;
}

}  // namespace

void PdfPath::moveTo(const Vector2d& p_mm) {
  // The last of several points in a row counts.
  if (!steps_.empty() && steps_.back() == Step::kMove) {
    points_mm_.back() = p_mm;
  } else {
    steps_.push_back(Step::kMove);
    points_mm_.push_back(p_mm);
  }
  start_mm_ = point_mm_ = p_mm;
  has_point_ = true;
}

bool PdfPath::lineTo(const Vector2d& p_mm) {
  if (!has_point_) return false;
  steps_.push_back(Step::kLine);
  points_mm_.push_back(p_mm);
  point_mm_ = p_mm;
  ++size_;
  return true;
}

bool PdfPath::curveTo(const Vector2d& p1_mm, const Vector2d& p2_mm, const Vector2d& p_mm) {
  if (!has_point_) return false;
  steps_.push_back(Step::kCurve);
  points_mm_.insert(points_mm_.end(), {p1_mm, p2_mm, p_mm});
  point_mm_ = p_mm;
  ++size_;
  return true;
}

bool PdfPath::close() {
  if (!has_point_) return false;
  steps_.push_back(Step::kClose);
  point_mm_ = start_mm_;
  ++size_;
  return true;
}

void PdfPath::clear() {
  steps_.clear();
  points_mm_.clear();
  has_point_ = false;
  size_ = 0;
}

std::vector<Curve> PdfPath::curves(std::size_t& dots) const {
  std::vector<Curve> curves;
  curves.reserve(size_);
  Vector2d start = Vector2d::Zero();
  Vector2d at = start;
  std::size_t used = 0;
  std::size_t before = 0;  // Curves in front of this subpath.
  bool has_steps = false;  // Whether it has any step behind its first point.
  const auto add = [&](Curve curve) {
    has_steps = true;
    if (!isNothing(curve)) curves.push_back(std::move(curve));
  };
  const auto finish = [&] {
    if (has_steps && curves.size() == before) ++dots;
    has_steps = false;
    before = curves.size();
  };
  for (const Step step : steps_) {
    switch (step) {
      case Step::kMove:
        finish();
        start = at = points_mm_[used++];
        break;
      case Step::kLine:
        add(LineCurve{at, points_mm_[used]});
        at = points_mm_[used++];
        break;
      case Step::kCurve: {
        BezierCurve bezier;
        bezier.control_mm << at, points_mm_[used], points_mm_[used + 1], points_mm_[used + 2];
        add(bezier);
        at = points_mm_[used + 2];
        used += 3;
        break;
      }
      case Step::kClose:
        add(LineCurve{at, start});
        at = start;
        finish();
        break;
    }
  }
  finish();
  return curves;
}

PdfRegion PdfPath::region(bool is_even_odd) const {
  constexpr int kPieces = 64;  // A quarter of a circle of 100 mm departs from its polygon by 7.5 um.
  PdfRegion region{{}, is_even_odd};
  std::size_t used = 0;
  Vector2d start = Vector2d::Zero();
  bool is_closed = false;
  for (const Step step : steps_) {
    if (step == Step::kClose) {
      is_closed = true;
      continue;
    }
    if (step == Step::kMove || is_closed) region.polygons_mm.emplace_back();
    if (step != Step::kMove && is_closed) region.polygons_mm.back().push_back(start);
    is_closed = false;
    auto& polygon = region.polygons_mm.back();
    if (step == Step::kCurve) {
      BezierCurve bezier;
      bezier.control_mm << polygon.back(), points_mm_[used], points_mm_[used + 1], points_mm_[used + 2];
      for (int i = 1; i <= kPieces; ++i) polygon.push_back(pointAt(bezier, static_cast<double>(i) / kPieces));
      used += 3;
    } else {
      polygon.push_back(points_mm_[used++]);
    }
    if (step == Step::kMove) start = polygon.back();
  }
  std::erase_if(region.polygons_mm, [](const auto& polygon) { return polygon.size() < 2; });
  return region;
}

}  // namespace kerfbench::dieline
