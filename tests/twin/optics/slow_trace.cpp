// SPDX-License-Identifier: Apache-2.0
#include "slow_trace.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <tuple>

namespace kerfbench::twin::test {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Line = Eigen::ParametrizedLine<double, 3>;
using Plane = Eigen::Hyperplane<double, 3>;

Matrix3d turn(const Vector3d& rotation_rad) {
  return AngleAxisd(rotation_rad.norm(), rotation_rad.stableNormalized()).toRotationMatrix();
}

// Surface of the mirror in H: turned about the axis through `place`, then moved along its own normal.
Plane surfaceOf(const Vector3d& place, const Vector3d& axis, const Vector3d& rest, double angle,
                double before_axis_mm) {
  const Vector3d normal = AngleAxisd(angle, axis).toRotationMatrix() * rest;
  return {normal, place + before_axis_mm * normal};
}

Line mirrored(const Line& ray, const Plane& surface, double& path_mm) {
  const double distance = ray.intersectionParameter(surface);
  path_mm += distance;
  const Vector3d n = surface.normal();
  const Matrix3d householder = Matrix3d::Identity() - 2.0 * n * n.transpose();
  return {ray.pointAt(distance), householder * ray.direction()};
}

// Signed distance along the ray to the board, by bisection between 400 mm before and behind z = 0.
double distanceTo(const Board& board, const Line& ray) {
  const auto above = [&](double s) {
    const Vector3d p = ray.pointAt(s);
    return p.z() - board(p.head<2>());
  };
  const double to_plane = -ray.origin().z() / ray.direction().z();
  double near = to_plane - 400.0;
  double far = to_plane + 400.0;
  if (!(above(near) > 0 && above(far) < 0)) throw std::logic_error("slowTrace: the beam misses the board");
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (near + far);
    (above(middle) > 0 ? near : far) = middle;
  }
  return 0.5 * (near + far);
}

// Ray in the focal plane and its distance from there to the waist.
std::pair<Line, double> focused(const LensDescription& lens, double focus_z_mm, const Vector3d& direction) {
  Isometry3d X_WLens = Isometry3d::Identity();  // Lens frame: principal point, z up along the axis.
  X_WLens.translation() = Vector3d(lens.decentre_mm[0], lens.decentre_mm[1], lens.focal_length_mm);
  X_WLens.linear() = turn({lens.tilt_rad[0], lens.tilt_rad[1], 0.0});
  const Vector3d k = X_WLens.linear().transpose() * direction;
  const double field = std::atan2(k.head<2>().norm(), -k.z());
  const double azimuth = std::atan2(k.y(), k.x());
  const double t2 = field * field;
  const double radius = lens.focal_length_mm * field * (1.0 + lens.k1 * t2 + lens.k2 * t2 * t2);
  const double incidence = lens.incidence_ratio * field;
  const Vector3d p(radius * std::cos(azimuth), radius * std::sin(azimuth), -lens.focal_length_mm);
  const Vector3d out(std::sin(incidence) * std::cos(azimuth), std::sin(incidence) * std::sin(azimuth),
                     -std::cos(incidence));
  const Line ray(p, out);
  const Plane waists(Vector3d::UnitZ(), Vector3d(0.0, 0.0, focus_z_mm - lens.focal_length_mm));
  return {Line(X_WLens * p, X_WLens.linear() * out), ray.intersectionParameter(waists)};
}

}  // namespace

SlowSpot slowTrace(const ScanHeadDescription& head, const BeamDescription& beam,
                   const Eigen::Vector2d& mirror_rad, const Board& board, const Eigen::Vector2d& offset_mm) {
  const double turned_rad = head.y_mirror_first ? -0.5 * std::numbers::pi : 0.0;
  const Matrix3d R_WH = AngleAxisd(turned_rad, Vector3d::UnitZ()).toRotationMatrix();
  const MirrorAlignment& first = head.y_mirror_first ? head.y : head.x;
  const MirrorAlignment& last = head.y_mirror_first ? head.x : head.y;
  const double first_rad = first.zero_rad + first.scale * mirror_rad[head.y_mirror_first ? 1 : 0];
  const double last_rad = last.zero_rad + last.scale * mirror_rad[head.y_mirror_first ? 0 : 1];
  const Vector3d first_axis = head.y_mirror_first ? Vector3d(0, 0, 1) : Vector3d(0, 0, -1);

  const Vector3d first_place(0.0, -head.mirror_spacing_mm, head.throw_mm);
  const Vector3d last_place(0.0, 0.0, head.throw_mm);
  const Plane first_surface =
      surfaceOf(first_place, turn({first.axis_tilt_rad[0], first.axis_tilt_rad[1], 0}) * first_axis,
                Vector3d(-1, 1, 0).normalized(), first_rad, first.surface_offset_mm);
  const Plane last_surface =
      surfaceOf(last_place, turn({0, last.axis_tilt_rad[0], last.axis_tilt_rad[1]}) * Vector3d(1, 0, 0),
                Vector3d(0, -1, -1).normalized(), last_rad, last.surface_offset_mm);

  const Matrix3d R_HBeam = turn({0, beam.tilt_rad[0], beam.tilt_rad[1]});
  const Vector3d entry = first_place + Vector3d(0, beam.offset_mm[0], beam.offset_mm[1]) +
                         R_HBeam * Vector3d(0, offset_mm[0], offset_mm[1]);
  SlowSpot spot;
  const Line laser(entry, R_HBeam * Vector3d::UnitX());
  const Line between = mirrored(laser, first_surface, spot.path_mm);
  const Line after = mirrored(between, last_surface, spot.path_mm);
  Line ray(R_WH * after.origin(), R_WH * after.direction());
  double to_waist_mm = head.mirror_spacing_mm + head.throw_mm - beam.focus_z_mm - spot.path_mm;
  if (head.lens) std::tie(ray, to_waist_mm) = focused(*head.lens, beam.focus_z_mm, ray.direction());
  const double distance = distanceTo(board, ray);
  spot.p_W_mm = ray.pointAt(distance);
  spot.direction = ray.direction();
  spot.path_mm += distance;
  spot.defocus_mm = distance - to_waist_mm;
  return spot;
}

}  // namespace kerfbench::twin::test
