// SPDX-License-Identifier: Apache-2.0
#include "twin/optics/scan_head.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

namespace kerfbench::twin {
namespace {

// Axes of H in W as columns.
Eigen::Matrix3d orientationOf(const ScanHeadDescription& head) {
  if (!head.y_mirror_first) return Eigen::Matrix3d::Identity();
  Eigen::Matrix3d R_WH;
  R_WH.col(0) = -Eigen::Vector3d::UnitY();
  R_WH.col(1) = Eigen::Vector3d::UnitX();
  R_WH.col(2) = Eigen::Vector3d::UnitZ();
  return R_WH;
}

Eigen::Matrix3d turnedBy(const Eigen::Vector3d& rotation_rad) {
  const double angle = rotation_rad.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, rotation_rad / angle).toRotationMatrix();
}

const ScanHeadDescription& checked(const ScanHeadDescription& head, const BeamDescription& beam) {
  const std::string of_head = faultsOf(head);
  const std::string of_beam = faultsOf(beam);
  if (!of_head.empty() || !of_beam.empty()) {
    throw std::invalid_argument(of_head + (of_head.empty() || of_beam.empty() ? "" : "; ") + of_beam);
  }
  return head;
}

}  // namespace

ScanHead::ScanHead(const ScanHeadDescription& head, const BeamDescription& beam)
    : y_first_(checked(head, beam).y_mirror_first),
      focus_z_mm_(beam.focus_z_mm),
      waist_path_mm_(head.mirror_spacing_mm + head.throw_mm - beam.focus_z_mm),
      caustic_(beam.waist_radius_mm, beam.rayleigh_mm) {
  const Eigen::Matrix3d R_WH = orientationOf(head);
  const auto mirror = [&](const Eigen::Vector3d& place_H_mm, const Eigen::Vector3d& axis_H,
                          const Eigen::Vector3d& rest_H, const Eigen::Vector3d& tilt_H_rad,
                          const MirrorAlignment& alignment, Eigen::Index motor) {
    const Eigen::Vector3d axis = R_WH * (turnedBy(tilt_H_rad) * axis_H);
    const Eigen::Vector3d rest = R_WH * rest_H.normalized();
    const Eigen::Vector3d along = axis.dot(rest) * axis;
    return Mirror{R_WH * place_H_mm, axis, along, rest - along, axis.cross(rest), alignment, motor};
  };
  const MirrorAlignment& first = y_first_ ? head.y : head.x;
  const MirrorAlignment& last = y_first_ ? head.x : head.y;
  mirrors_[0] = mirror({0.0, -head.mirror_spacing_mm, head.throw_mm}, {0.0, 0.0, y_first_ ? 1.0 : -1.0},
                       {-1.0, 1.0, 0.0}, {first.axis_tilt_rad[0], first.axis_tilt_rad[1], 0.0}, first,
                       y_first_ ? 1 : 0);
  mirrors_[1] = mirror({0.0, 0.0, head.throw_mm}, {1.0, 0.0, 0.0}, {0.0, -1.0, -1.0},
                       {0.0, last.axis_tilt_rad[0], last.axis_tilt_rad[1]}, last, y_first_ ? 0 : 1);
  const Eigen::Vector3d offset_H_mm(0.0, beam.offset_mm[0], beam.offset_mm[1]);
  const Eigen::Vector3d tilt_H_rad(0.0, beam.tilt_rad[0], beam.tilt_rad[1]);
  laser_ = Ray{mirrors_[0].place_mm + R_WH * offset_H_mm,
               R_WH * (turnedBy(tilt_H_rad) * Eigen::Vector3d::UnitX()), 0.0};
  if (head.lens) {
    const LensDescription& lens = *head.lens;
    const Eigen::Vector3d axis =
        turnedBy({lens.tilt_rad[0], lens.tilt_rad[1], 0.0}) * -Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d principal_mm(lens.decentre_mm[0], lens.decentre_mm[1], lens.focal_length_mm);
    lens_ = Lens{lens, principal_mm + lens.focal_length_mm * axis, axis,
                 std::sin(LensDescription::kMaxFieldAngle_rad)};
  }
}

bool ScanHead::reflect(Ray& ray, const Mirror& mirror, double motor_rad, double least_mm) {
  const double angle = mirror.alignment.zero_rad + mirror.alignment.scale * motor_rad;
  const Eigen::Vector3d normal =  // Normal by Rodrigues' formula.
      mirror.along + std::cos(angle) * mirror.across + std::sin(angle) * mirror.quarter;
  const double approach = ray.direction.dot(normal);
  if (!(approach <= -kFlattest)) return false;
  const double ahead = (mirror.place_mm - ray.p_W_mm).dot(normal) + mirror.alignment.surface_offset_mm;
  const double distance_mm = ahead / approach;
  if (!(distance_mm >= least_mm)) return false;
  ray.p_W_mm += distance_mm * ray.direction;
  ray.path_mm += distance_mm;
  ray.direction -= 2.0 * approach * normal;
  return true;
}

std::optional<ChiefRay> ScanHead::throughLens(const Eigen::Vector3d& direction) const {
  const LensDescription& lens = lens_->description;
  const double along = direction.dot(lens_->axis);
  const Eigen::Vector3d across = direction - along * lens_->axis;
  const double sine = across.norm();
  if (!(along > 0) || !(sine <= lens_->most_sine)) return std::nullopt;
  const double field = std::asin(sine);
  const double field2 = field * field;
  const double radius_mm = lens.focal_length_mm * field * (1.0 + field2 * (lens.k1 + field2 * lens.k2));
  const double incidence = lens.incidence_ratio * field;
  const Eigen::Vector3d outwards = sine > 0 ? Eigen::Vector3d(across / sine) : Eigen::Vector3d::Zero();
  const double cosine = std::cos(incidence);
  return ChiefRay{lens_->centre_mm + radius_mm * outwards,
                  cosine * lens_->axis + std::sin(incidence) * outwards, -focus_z_mm_ / cosine,
                  -lens.focal_length_mm};
}

std::optional<BeamSpot> ScanHead::spotAt(const Eigen::Vector2d& mirror_rad,
                                         const Eigen::Vector2d& head_shift_mm, const Surface& surface,
                                         double time_s) const {
  Ray ray = laser_;
  // The tube is far: a first mirror that stands before its axis meets the beam earlier.
  if (!reflect(ray, mirrors_[0], mirror_rad[mirrors_[0].motor], -INFINITY)) return std::nullopt;
  if (!reflect(ray, mirrors_[1], mirror_rad[mirrors_[1].motor], -kOverlap_mm)) return std::nullopt;
  ChiefRay chief{ray.p_W_mm, ray.direction, waist_path_mm_ - ray.path_mm, 0.0};
  if (lens_) {
    const auto bent = throughLens(ray.direction);
    if (!bent) return std::nullopt;
    chief = *bent;
  }
  chief.p_W_mm.head<2>() += head_shift_mm;
  return caustic_.spotOn(surface, time_s, chief, kFlattest);
}

std::optional<BeamSpot> gantrySpot(const Eigen::Vector2d& p_W_mm, const BeamDescription& beam,
                                   const Surface& surface, double time_s) {
  const Eigen::Vector3d direction =
      turnedBy({beam.tilt_rad[0], beam.tilt_rad[1], 0.0}) * -Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d on_plane_mm(p_W_mm.x() + beam.offset_mm[0], p_W_mm.y() + beam.offset_mm[1], 0.0);
  const ChiefRay chief{on_plane_mm, direction, beam.focus_z_mm / direction.z(), -INFINITY};
  return BeamCaustic(beam.waist_radius_mm, beam.rayleigh_mm)
      .spotOn(surface, time_s, chief, ScanHead::kFlattest);
}

}  // namespace kerfbench::twin
