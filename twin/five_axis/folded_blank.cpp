// SPDX-License-Identifier: Apache-2.0
#include "twin/five_axis/folded_blank.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// How deep a point lies within a box; negative beside it.
double depthIn(const Eigen::AlignedBox2d& box, const Vector2d& p) {
  if (!box.contains(p)) return -box.exteriorDistance(p);
  return std::min((p - box.min()).minCoeff(), (box.max() - p).minCoeff());
}

}  // namespace

FoldedBlank::FoldedBlank(std::vector<BlankFace> faces, double waist_radius_mm, double rayleigh_mm)
    : faces_(std::move(faces)), waist_radius_mm_(waist_radius_mm), rayleigh_mm_(rayleigh_mm) {}

std::vector<FaceSpot> FoldedBlank::meet(const FiveAxisBeam& beam) const {
  struct Crossing {
    FaceSpot spot;
    double depth_mm{};
    double reach_mm{};
  };
  std::vector<Crossing> crossings;
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const Eigen::Isometry3d X_FW = faces_[i].X_WF.inverse();
    const Vector3d focus_mm = X_FW * beam.p_WQ_mm;
    const Vector3d k = X_FW.linear() * beam.axis_W;
    if (k.z() < kFlattest) continue;
    Crossing crossing;
    const double way_mm = focus_mm.z() / k.z();
    const double spread = way_mm / rayleigh_mm_;
    const double square_mm2 = waist_radius_mm_ * waist_radius_mm_ * (1.0 + spread * spread);
    const Vector2d aslant = k.head<2>() / k.z();
    const double xx = square_mm2 * (1.0 + aslant.x() * aslant.x());
    const double yy = square_mm2 * (1.0 + aslant.y() * aslant.y());
    crossing.spot.face = i;
    crossing.spot.past_focus_mm = way_mm;
    crossing.spot.footprint = {(focus_mm - way_mm * k).head<2>(), std::sqrt(xx), std::sqrt(yy),
                               square_mm2 * aslant.x() * aslant.y() / std::sqrt(xx * yy)};
    crossing.depth_mm = depthIn(faces_[i].outline_F_mm, crossing.spot.footprint.p_SQ_mm);
    crossing.reach_mm = kReach * std::sqrt(square_mm2 * (1.0 + aslant.squaredNorm()));
    crossings.push_back(crossing);
  }
  std::vector<FaceSpot> met;
  for (const Crossing& c : crossings) {
    const bool shadowed = std::ranges::any_of(crossings, [&](const Crossing& other) {
      return other.spot.past_focus_mm < c.spot.past_focus_mm && other.depth_mm > other.reach_mm;
    });
    if (!shadowed && c.depth_mm > -c.reach_mm) met.push_back(c.spot);
  }
  return met;
}

}  // namespace kerfbench::twin
