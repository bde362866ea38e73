// SPDX-License-Identifier: Apache-2.0
#pragma once

// The ray trace of HeadModel, once for numbers and once for automatic differentiation.

#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/calibrate/head/head_parameters.h"
#include "hil/calibrate/head/nominal_head.h"

namespace kerfbench::calibrate::trace {

template <typename T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <typename T>
using Vector2 = Eigen::Matrix<T, 2, 1>;

/// Steeper incidence than this cosine, on mirrors and sheet, or the beam does not count as reflected.
inline constexpr double kFlattest = 0.05;

// Functions of the square of an angle or sine: smooth at zero, where a root has no derivative.

/// asin(s) / s of s².
template <typename T>
T arcRatio(const T& square) {
  using std::asin;
  using std::sqrt;
  if (square < 1e-3) {
    return 1.0 + square * (1.0 / 6 + square * (3.0 / 40 + square * (5.0 / 112 + square * (35.0 / 1152))));
  }
  const T root = sqrt(square);
  return asin(root) / root;
}

/// sin(a) / a of a².
template <typename T>
T sineRatio(const T& square) {
  using std::sin;
  using std::sqrt;
  if (square < 1e-3) {
    return 1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0)));
  }
  const T root = sqrt(square);
  return sin(root) / root;
}

/// cos(a) of a².
template <typename T>
T cosineOfSquare(const T& square) {
  using std::cos;
  using std::sqrt;
  if (square < 1e-3) {
    return 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0)));
  }
  return cos(sqrt(square));
}

template <typename T>
struct Ray {
  Vector3<T> p_W_mm, direction;
};

template <typename T>
struct Mirror {
  Vector3<T> place_mm;
  Vector3<T> along, across, quarter;  ///< The normal's part along the axis; at rest; a quarter turn later.
  T surface_mm, zero_rad, gain;
  int motor{};  ///< 0 X, 1 Y.
};

template <typename T>
struct Lens {
  Vector3<T> centre_mm, axis;
  T focal_length_mm, k1, k2, incidence_ratio;
};

/// The sheet, and the frame in which it is measured.
template <typename T>
struct Plane {
  T height_mm;
  Vector2<T> slope, shift_mm;
  T turn_cos, turn_sin;
};

/// A head with its departures, ready to be traced.
template <typename T>
struct Head {
  Ray<T> laser;
  std::array<Mirror<T>, 2> mirrors;  ///< Mirrors in the order in which the beam meets them.
  std::optional<Lens<T>> lens;
  Plane<T> plane;
};

/// Mirrors as drawn, and directions of the beam before, between and after them.
struct Drawing {
  std::array<Eigen::Vector3d, 3> ways;
  std::array<Eigen::Vector3d, 2> axes;
  std::array<int, 2> motors;
};

inline Drawing drawingOf(const HeadDesign& design) {
  using V = Eigen::Vector3d;
  if (design.y_mirror_first)
    return {{-V::UnitY(), V::UnitX(), -V::UnitZ()}, {V::UnitZ(), -V::UnitY()}, {1, 0}};
  return {{V::UnitX(), V::UnitY(), -V::UnitZ()}, {-V::UnitZ(), V::UnitX()}, {0, 1}};
}

template <typename T>
Vector3<T> lean(const Eigen::Vector3d& from, const T& a, const Eigen::Vector3d& towards_a, const T& b,
                const Eigen::Vector3d& towards_b) {
  const Vector3<T> leant = from.cast<T>() + a * towards_a.cast<T>() + b * towards_b.cast<T>();
  return leant.normalized();
}

/// The mirror's six departures are in a row, from here on.
inline HeadParameter firstOfMirror(int motor) {
  return motor == 0 ? HeadParameter::kXAxisTiltA : HeadParameter::kYAxisTiltA;
}

template <typename T>
Vector3<T> placeOf(const HeadDesign& design, const Drawing& drawing, std::size_t which, const T* departures) {
  const T throw_mm = design.throw_mm + departures[indexOf(HeadParameter::kThrow)];
  const Vector3<T> last_mm(T(0.0), T(0.0), throw_mm);
  if (which == 1) return last_mm;
  const T spacing_mm = design.mirror_spacing_mm + departures[indexOf(HeadParameter::kMirrorSpacing)];
  return last_mm - spacing_mm * drawing.ways[1].cast<T>();
}

/// `which`: 0 or 1, as the beam meets them.
template <typename T>
Mirror<T> mirrorOf(const HeadDesign& design, std::size_t which, const T* departures) {
  using std::sqrt;
  const Drawing drawing = drawingOf(design);
  const Eigen::Vector3d& axis = drawing.axes[which];
  const Eigen::Vector3d rest = (drawing.ways[which + 1] - drawing.ways[which]).normalized();
  const int motor = drawing.motors[which];
  const T* const own = departures + indexOf(firstOfMirror(motor));
  const Vector3<T> leant = lean<T>(axis, own[0], axis.cross(rest), own[1], rest);
  const Vector3<T> across = (rest.cast<T>() - rest.cast<T>().dot(leant) * leant).normalized();
  const T length = sqrt(1.0 + own[2] * own[2]);
  Mirror<T> mirror;
  mirror.place_mm = placeOf<T>(design, drawing, which, departures);
  mirror.along = leant * (own[2] / length);
  mirror.across = across / length;
  mirror.quarter = leant.cross(across) / length;
  mirror.surface_mm = own[3];
  mirror.zero_rad = own[4];
  mirror.gain = 1.0 + own[5];
  mirror.motor = motor;
  return mirror;
}

template <typename T>
Lens<T> lensOf(const LensDesign& design, const T* departures) {
  const auto at = [&](HeadParameter parameter) -> const T& { return departures[indexOf(parameter)]; };
  Lens<T> lens;
  lens.focal_length_mm = design.focal_length_mm * (1.0 + at(HeadParameter::kFocalLength));
  lens.k1 = design.k1_1_rad2 + at(HeadParameter::kLensK1);
  lens.k2 = design.k2_1_rad4 + at(HeadParameter::kLensK2);
  lens.incidence_ratio = design.incidence_ratio + at(HeadParameter::kLensIncidence);
  lens.axis = lean<T>(-Eigen::Vector3d::UnitZ(), at(HeadParameter::kLensTiltX), Eigen::Vector3d::UnitX(),
                      at(HeadParameter::kLensTiltY), Eigen::Vector3d::UnitY());
  const Vector3<T> principal_mm(at(HeadParameter::kLensDecentreX), at(HeadParameter::kLensDecentreY),
                                lens.focal_length_mm);
  lens.centre_mm = principal_mm + lens.focal_length_mm * lens.axis;
  return lens;
}

template <typename T>
Ray<T> laserOf(const HeadDesign& design, const T* departures) {
  const auto at = [&](HeadParameter parameter) -> const T& { return departures[indexOf(parameter)]; };
  const Drawing drawing = drawingOf(design);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d beside = up.cross(drawing.ways[0]);
  Ray<T> laser;
  laser.p_W_mm = placeOf<T>(design, drawing, 0, departures) +
                 at(HeadParameter::kBeamOffsetA) * beside.cast<T>() +
                 at(HeadParameter::kBeamOffsetB) * up.cast<T>();
  laser.direction =
      lean<T>(drawing.ways[0], at(HeadParameter::kBeamTiltA), beside, at(HeadParameter::kBeamTiltB), up);
  return laser;
}

template <typename T>
Plane<T> planeOf(const T* departures) {
  using std::cos;
  using std::sin;
  const auto at = [&](HeadParameter parameter) -> const T& { return departures[indexOf(parameter)]; };
  return {at(HeadParameter::kPlaneHeight),
          {at(HeadParameter::kPlaneSlopeX), at(HeadParameter::kPlaneSlopeY)},
          {at(HeadParameter::kPlaneShiftX), at(HeadParameter::kPlaneShiftY)},
          cos(at(HeadParameter::kPlaneTurn)),
          sin(at(HeadParameter::kPlaneTurn))};
}

/// `departures`: kHeadParameterCount of them, in their units.
template <typename T>
Head<T> headOf(const HeadDesign& design, const T* departures) {
  Head<T> head{laserOf<T>(design, departures),
               {mirrorOf<T>(design, 0, departures), mirrorOf<T>(design, 1, departures)},
               std::nullopt,
               planeOf<T>(departures)};
  if (design.lens) head.lens = lensOf<T>(*design.lens, departures);
  return head;
}

template <typename T>
bool reflect(const Mirror<T>& mirror, const T& motor_rad, Ray<T>& ray) {
  using std::cos;
  using std::sin;
  const T angle = mirror.zero_rad + mirror.gain * motor_rad;
  const Vector3<T> normal = mirror.along + cos(angle) * mirror.across + sin(angle) * mirror.quarter;
  const T approach = ray.direction.dot(normal);
  if (!(approach < -kFlattest)) return false;
  const Vector3<T> to_place_mm = mirror.place_mm - ray.p_W_mm;
  const T distance_mm = (to_place_mm.dot(normal) + mirror.surface_mm) / approach;
  ray.p_W_mm += distance_mm * ray.direction;
  ray.direction -= (2.0 * approach) * normal;
  return true;
}

template <typename T>
bool refract(const Lens<T>& lens, Ray<T>& ray) {
  const T along = ray.direction.dot(lens.axis);
  if (!(along > kFlattest)) return false;
  const Vector3<T> across = ray.direction - along * lens.axis;
  const T ratio = arcRatio<T>(across.squaredNorm());
  const T field2 = across.squaredNorm() * ratio * ratio;
  const T radius_mm = lens.focal_length_mm * ratio * (1.0 + field2 * (lens.k1 + field2 * lens.k2));
  const T incidence2 = lens.incidence_ratio * lens.incidence_ratio * field2;
  ray.p_W_mm = lens.centre_mm + radius_mm * across;
  ray.direction = cosineOfSquare<T>(incidence2) * lens.axis +
                  (lens.incidence_ratio * ratio * sineRatio<T>(incidence2)) * across;
  return true;
}

/// Point where a ray meets the sheet, as measured; false where there is none.
template <typename T>
bool land(const Plane<T>& plane, const Ray<T>& ray, Vector2<T>& p_W_mm) {
  const T sink =
      ray.direction.z() - plane.slope.x() * ray.direction.x() - plane.slope.y() * ray.direction.y();
  if (!(sink < -kFlattest)) return false;
  const T above =
      plane.height_mm + plane.slope.x() * ray.p_W_mm.x() + plane.slope.y() * ray.p_W_mm.y() - ray.p_W_mm.z();
  const T way_mm = above / sink;
  const T x = ray.p_W_mm.x() + way_mm * ray.direction.x();
  const T y = ray.p_W_mm.y() + way_mm * ray.direction.y();
  p_W_mm = Vector2<T>(plane.turn_cos * x - plane.turn_sin * y + plane.shift_mm.x(),
                      plane.turn_sin * x + plane.turn_cos * y + plane.shift_mm.y());
  return true;
}

/// Landing point of the beam, as measured; false where there is none.
template <typename T>
bool landing(const Head<T>& head, const Vector2<T>& angles_rad, Vector2<T>& p_W_mm) {
  Ray<T> ray = head.laser;
  for (const Mirror<T>& mirror : head.mirrors) {
    if (!reflect<T>(mirror, angles_rad[mirror.motor], ray)) return false;
  }
  if (head.lens && !refract<T>(*head.lens, ray)) return false;
  return land<T>(head.plane, ray, p_W_mm);
}

}  // namespace kerfbench::calibrate::trace
