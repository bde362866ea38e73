// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/support/unfolded_head.h"

#include <cmath>

#include <Eigen/Geometry>

namespace kerfbench::validation {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using Eigen::Vector4d;

Matrix3d turn(const Vector3d& rotation_rad) {
  const double angle = rotation_rad.norm();
  if (angle == 0.0) return Matrix3d::Identity();
  Matrix3d k;  // Cross-product matrix of Rodrigues' formula.
  const Vector3d u = rotation_rad / angle;
  k << 0.0, -u.z(), u.y(), u.z(), 0.0, -u.x(), -u.y(), u.x(), 0.0;
  return Matrix3d::Identity() + std::sin(angle) * k + (1.0 - std::cos(angle)) * k * k;
}

// Reflects homogeneous points at the plane n · p = n · place + offset.
Matrix4d mirrorImage(const Vector3d& place, const Vector3d& axis, const Vector3d& rest,
                     const Vector3d& tilt_rad, const twin::MirrorAlignment& alignment, double motor_rad) {
  const Matrix3d tilt = turn(tilt_rad);
  const double angle = alignment.zero_rad + alignment.scale * motor_rad;
  // The axis is tilted; the mirror is glued on so that at rest it stands as drawn.
  const Vector3d n = turn(angle * (tilt * axis)) * rest.normalized();
  Matrix4d image = Matrix4d::Identity();
  image.topLeftCorner<3, 3>() -= 2.0 * n * n.transpose();
  image.topRightCorner<3, 1>() = 2.0 * (n.dot(place) + alignment.surface_offset_mm) * n;
  return image;
}

Eigen::Vector2d throughLens(const twin::LensDescription& lens, const Vector3d& direction) {
  const Matrix3d tilt = turn({lens.tilt_rad[0], lens.tilt_rad[1], 0.0});
  const Vector3d d = tilt.transpose() * direction;  // Direction as the lens sees it.
  const double radius = std::hypot(d.x(), d.y());
  const double field = std::atan2(radius, -d.z());
  const double r =
      lens.focal_length_mm * (field + lens.k1 * std::pow(field, 3) + lens.k2 * std::pow(field, 5));
  const Vector3d out = radius > 0.0 ? Vector3d(d.x() / radius, d.y() / radius, 0.0) : Vector3d::Zero();
  const Vector3d principal(lens.decentre_mm[0], lens.decentre_mm[1], lens.focal_length_mm);
  const Vector3d hit = principal + tilt * (Vector3d(0.0, 0.0, -lens.focal_length_mm) + r * out);
  const double incidence = lens.incidence_ratio * field;
  const Vector3d leaves = tilt * (std::sin(incidence) * out - std::cos(incidence) * Vector3d::UnitZ());
  return (hit - hit.z() / leaves.z() * leaves).head<2>();
}

}  // namespace

Eigen::Vector2d unfoldedSpot_mm(const twin::ScanHeadDescription& head, const twin::BeamDescription& beam,
                                const twin::SurfaceDescription& plane, const Eigen::Vector2d& mirror_rad) {
  const double d = head.mirror_spacing_mm;
  const double l = head.throw_mm;
  const auto& first_tilt = head.y_mirror_first ? head.y.axis_tilt_rad : head.x.axis_tilt_rad;
  const auto& last_tilt = head.y_mirror_first ? head.x.axis_tilt_rad : head.y.axis_tilt_rad;
  Matrix4d first, last;
  Vector3d origin, ray;
  if (head.y_mirror_first) {
    // Axes: Hx = -Wy, Hy = +Wx.
    first = mirrorImage({-d, 0, l}, {0, 0, 1}, {1, 1, 0}, {first_tilt[1], -first_tilt[0], 0.0}, head.y,
                        mirror_rad.y());
    last = mirrorImage({0, 0, l}, {0, -1, 0}, {-1, 0, -1}, {last_tilt[0], 0.0, last_tilt[1]}, head.x,
                       mirror_rad.x());
    origin = {-d + beam.offset_mm[0], 0.0, l + beam.offset_mm[1]};
    ray = turn({beam.tilt_rad[0], 0.0, beam.tilt_rad[1]}) * Vector3d(0, -1, 0);
  } else {
    first = mirrorImage({0, -d, l}, {0, 0, -1}, {-1, 1, 0}, {first_tilt[0], first_tilt[1], 0.0}, head.x,
                        mirror_rad.x());
    last = mirrorImage({0, 0, l}, {1, 0, 0}, {0, -1, -1}, {0.0, last_tilt[0], last_tilt[1]}, head.y,
                       mirror_rad.y());
    origin = {0.0, -d + beam.offset_mm[0], l + beam.offset_mm[1]};
    ray = turn({0.0, beam.tilt_rad[0], beam.tilt_rad[1]}) * Vector3d(1, 0, 0);
  }
  const Matrix4d both = last * first;
  const Vector3d p = (both * Vector4d(origin.x(), origin.y(), origin.z(), 1.0)).head<3>();
  const Vector3d u = both.topLeftCorner<3, 3>() * ray;
  if (head.lens) return throughLens(*head.lens, u);
  const Vector3d normal(-plane.slope[0], -plane.slope[1], 1.0);
  return (p + (plane.height_mm - normal.dot(p)) / normal.dot(u) * u).head<2>();
}

}  // namespace kerfbench::validation
