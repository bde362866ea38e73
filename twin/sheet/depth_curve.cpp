// SPDX-License-Identifier: Apache-2.0
#include "twin/sheet/depth_curve.h"

#include <algorithm>
#include <cmath>

namespace kerfbench::twin {
namespace {

double between(double from, double to, double share) { return from + (to - from) * share; }

}  // namespace

DepthCurve::DepthCurve(const BoardDescription& board)
    : points_(board.depth_curve), cut_fluence_j_mm2_(board.cut_fluence_j_mm2) {
  if (points_.empty()) points_ = {{0.0, 0.0}, {1.0, 1.0}};
}

double DepthCurve::depthAt(double fluence_j_mm2) const {
  const double share = fluence_j_mm2 / cut_fluence_j_mm2_;
  if (share >= 1.0) return 1.0;
  if (!(share > points_.front().fluence_share)) return 0.0;
  const auto above = std::ranges::upper_bound(points_, share, {}, &DepthPoint::fluence_share);
  const DepthPoint& a = *std::prev(above);
  return between(a.depth_share, above->depth_share,
                 (share - a.fluence_share) / (above->fluence_share - a.fluence_share));
}

double DepthCurve::unboundedDepthAt(double fluence_j_mm2) const {
  const double share = fluence_j_mm2 / cut_fluence_j_mm2_;
  const auto along = [share](const DepthPoint& a, const DepthPoint& b) {
    return between(a.depth_share, b.depth_share,
                   (share - a.fluence_share) / (b.fluence_share - a.fluence_share));
  };
  if (share <= points_.front().fluence_share) return along(points_[0], points_[1]);
  if (share >= 1.0) return along(points_[points_.size() - 2], points_.back());
  return depthAt(fluence_j_mm2);
}

double DepthCurve::fluenceFor_j_mm2(double depth_share) const {
  if (depth_share >= 1.0) return cut_fluence_j_mm2_;
  if (!(depth_share > 0.0)) return points_.front().fluence_share * cut_fluence_j_mm2_;
  const auto above = std::ranges::upper_bound(points_, depth_share, {}, &DepthPoint::depth_share);
  const DepthPoint& a = *std::prev(above);
  return cut_fluence_j_mm2_ * between(a.fluence_share, above->fluence_share,
                                      (depth_share - a.depth_share) / (above->depth_share - a.depth_share));
}

}  // namespace kerfbench::twin
