// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/backward_trace.h"

#include <array>
#include <cmath>
#include <optional>

#include "hil/calibrate/head/dual.h"
#include "hil/calibrate/head/head_trace.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
/// Derivatives of x and y on the sheet by a vector, and by a number.
using ByVector = Eigen::Matrix<double, 2, 3>;
using ByNumber = Vector2d;

constexpr int kTilts = 3;  // Number of a mirror's parameters that turn its normal.
/// Index of its surface among a mirror's parameters, in HeadParameter's order.
constexpr int kMirrorSurface = 3;
constexpr int kMirrorZero = 4;
constexpr int kMirrorScale = 5;
constexpr int kLensParameters = 8;

constexpr Eigen::Index columnOf(HeadParameter parameter) {
  return static_cast<Eigen::Index>(indexOf(parameter));
}

template <int N>
Vector3d slopeOf(const trace::Vector3<Dual<N>>& vector, int k) {
  return {vector[0].slopes[k], vector[1].slopes[k], vector[2].slopes[k]};
}

/// The departures from `first` on as duals, the others fixed.
template <int N>
std::array<Dual<N>, kHeadParameterCount> seeded(const HeadVector& departures, HeadParameter first) {
  std::array<Dual<N>, kHeadParameterCount> duals;
  for (std::size_t k = 0; k < kHeadParameterCount; ++k)
    duals[k] = Dual<N>(departures[static_cast<Eigen::Index>(k)]);
  for (int k = 0; k < N; ++k) duals[indexOf(first) + static_cast<std::size_t>(k)].slopes[k] = 1.0;
  return duals;
}

/// x and y on the sheet by a ray.
struct ByRay {
  ByVector p, direction;
};

/// A mirror, how its tilts turn its normal, and how it met one ray.
struct SlopedMirror {
  trace::Mirror<double> mirror;
  struct Tilt {
    Vector3d along, across, quarter;
  };
  std::array<Tilt, kTilts> by_tilt;

  SlopedMirror(const HeadDesign& design, std::size_t which, const HeadVector& departures)
      : mirror(trace::mirrorOf<double>(design, which, departures.data())) {
    constexpr int kOwn = 6;
    const auto duals = seeded<kOwn>(departures, trace::firstOfMirror(mirror.motor));
    const auto sloped = trace::mirrorOf<Dual<kOwn>>(design, which, duals.data());
    for (int k = 0; k < kTilts; ++k) {
      by_tilt[static_cast<std::size_t>(k)] = {slopeOf<kOwn>(sloped.along, k), slopeOf<kOwn>(sloped.across, k),
                                              slopeOf<kOwn>(sloped.quarter, k)};
    }
  }

  struct Meeting {
    Vector3d normal{Vector3d::Zero()}, to_place_mm{Vector3d::Zero()}, direction{Vector3d::Zero()};
    double cosine{}, sine{}, approach{}, distance_mm{}, motor_rad{};
  };

  bool reflect(double motor_rad, trace::Ray<double>& ray, Meeting& m) const {
    const double angle = mirror.zero_rad + mirror.gain * motor_rad;
    m.motor_rad = motor_rad;
    m.cosine = std::cos(angle);
    m.sine = std::sin(angle);
    m.normal = mirror.along + m.cosine * mirror.across + m.sine * mirror.quarter;
    m.direction = ray.direction;
    m.approach = ray.direction.dot(m.normal);
    if (!(m.approach < -trace::kFlattest)) return false;
    m.to_place_mm = mirror.place_mm - ray.p_W_mm;
    m.distance_mm = (m.to_place_mm.dot(m.normal) + mirror.surface_mm) / m.approach;
    ray.p_W_mm += m.distance_mm * ray.direction;
    ray.direction -= (2.0 * m.approach) * m.normal;
    return true;
  }

  /// From the ray that leaves to the one that comes; the mirror's own six columns, and by its place.
  void back(const Meeting& m, ByRay& by, HeadJacobian& by_departures, ByVector& by_place) const {
    const ByNumber by_distance = by.p * m.direction;
    const ByNumber by_foot = by_distance / m.approach;  // Distance times approach.
    const ByNumber by_approach = -2.0 * (by.direction * m.normal) - m.distance_mm * by_foot;
    const ByVector by_normal = -2.0 * m.approach * by.direction + by_foot * m.to_place_mm.transpose() +
                               by_approach * m.direction.transpose();
    by_place = by_foot * m.normal.transpose();
    by.direction += m.distance_mm * by.p + by_approach * m.normal.transpose();
    by.p -= by_place;
    const ByNumber by_angle = by_normal * (m.cosine * mirror.quarter - m.sine * mirror.across);
    const auto own = columnOf(trace::firstOfMirror(mirror.motor));
    for (int k = 0; k < kTilts; ++k) {
      const Tilt& tilt = by_tilt[static_cast<std::size_t>(k)];
      by_departures.col(own + k) = by_normal * (tilt.along + m.cosine * tilt.across + m.sine * tilt.quarter);
    }
    by_departures.col(own + kMirrorSurface) = by_foot;
    by_departures.col(own + kMirrorZero) = by_angle;
    by_departures.col(own + kMirrorScale) = m.motor_rad * by_angle;
  }
};

/// A lens, what its departures do to its centre and axis, and how it met one ray.
struct SlopedLens {
  trace::Lens<double> lens;
  double focal_slope_mm{};
  std::array<Vector3d, kLensParameters> centre, axis;

  SlopedLens(const LensDesign& design, const HeadVector& departures)
      : lens(trace::lensOf<double>(design, departures.data())), focal_slope_mm(design.focal_length_mm) {
    const auto duals = seeded<kLensParameters>(departures, HeadParameter::kFocalLength);
    const auto sloped = trace::lensOf<Dual<kLensParameters>>(design, duals.data());
    for (int k = 0; k < kLensParameters; ++k) {
      centre[static_cast<std::size_t>(k)] = slopeOf<kLensParameters>(sloped.centre_mm, k);
      axis[static_cast<std::size_t>(k)] = slopeOf<kLensParameters>(sloped.axis, k);
    }
  }

  /// Dual number with derivatives by sin² of the field angle and by the incidence ratio.
  using Dual2 = Dual<2>;
  struct Meeting {
    Vector3d direction{Vector3d::Zero()}, across{Vector3d::Zero()};
    double along{}, ratio{}, field2{};
    Dual2 radius_mm, cosine, sine;  ///< The ray leaves with cosine · axis + sine · across.
  };

  bool refract(trace::Ray<double>& ray, Meeting& m) const {
    m.direction = ray.direction;
    m.along = ray.direction.dot(lens.axis);
    if (!(m.along > trace::kFlattest)) return false;
    m.across = ray.direction - m.along * lens.axis;
    const Dual2 square(m.across.squaredNorm(), 0);
    const Dual2 incidence(lens.incidence_ratio, 1);
    const Dual2 ratio = trace::arcRatio<Dual2>(square);
    const Dual2 field2 = square * ratio * ratio;
    const Dual2 incidence2 = incidence * incidence * field2;
    m.radius_mm = lens.focal_length_mm * ratio * (1.0 + field2 * (lens.k1 + field2 * lens.k2));
    m.cosine = trace::cosineOfSquare<Dual2>(incidence2);
    m.sine = incidence * ratio * trace::sineRatio<Dual2>(incidence2);
    m.ratio = ratio.value;
    m.field2 = field2.value;
    ray.p_W_mm = lens.centre_mm + m.radius_mm.value * m.across;
    ray.direction = m.cosine.value * lens.axis + m.sine.value * m.across;
    return true;
  }

  void back(const Meeting& m, ByRay& by, HeadJacobian& by_departures) const {
    const ByVector by_centre = by.p;
    const ByNumber by_radius = by.p * m.across;
    const ByNumber by_cosine = by.direction * lens.axis;
    const ByNumber by_sine = by.direction * m.across;
    const ByNumber by_square =
        by_radius * m.radius_mm.slopes[0] + by_cosine * m.cosine.slopes[0] + by_sine * m.sine.slopes[0];
    const ByVector by_across =
        m.radius_mm.value * by.p + m.sine.value * by.direction + (2.0 * by_square) * m.across.transpose();
    const ByNumber by_along = -(by_across * lens.axis);
    const ByVector by_axis =
        m.cosine.value * by.direction - m.along * by_across + by_along * m.direction.transpose();
    by.direction = by_across + by_along * lens.axis.transpose();
    by.p.setZero();  // The lens looks at the direction alone.
    const auto own = columnOf(HeadParameter::kFocalLength);
    for (int k = 0; k < kLensParameters; ++k) {
      const auto i = static_cast<std::size_t>(k);
      by_departures.col(own + k) = by_centre * centre[i] + by_axis * axis[i];
    }
    const double undistorted_mm = lens.focal_length_mm * m.ratio * m.field2;
    by_departures.col(own) += by_radius * (m.radius_mm.value / lens.focal_length_mm * focal_slope_mm);
    by_departures.col(columnOf(HeadParameter::kLensK1)) += by_radius * undistorted_mm;
    by_departures.col(columnOf(HeadParameter::kLensK2)) += by_radius * (undistorted_mm * m.field2);
    by_departures.col(columnOf(HeadParameter::kLensIncidence)) +=
        by_cosine * m.cosine.slopes[1] + by_sine * m.sine.slopes[1];
  }
};

/// Where a ray lands; all there is by it, and by the plane's six departures.
bool landAndBack(const trace::Plane<double>& plane, const trace::Ray<double>& ray, Vector2d& p_W_mm,
                 ByRay& by, HeadJacobian& by_departures) {
  const Vector3d up(-plane.slope.x(), -plane.slope.y(), 1.0);
  const double sink = ray.direction.dot(up);
  if (!(sink < -trace::kFlattest)) return false;
  const double way_mm = (plane.height_mm - ray.p_W_mm.dot(up)) / sink;
  const Vector3d spot_mm = ray.p_W_mm + way_mm * ray.direction;
  Eigen::Matrix2d turn;
  turn << plane.turn_cos, -plane.turn_sin, plane.turn_sin, plane.turn_cos;
  p_W_mm = turn * spot_mm.head<2>() + plane.shift_mm;
  const ByNumber by_height = turn * ray.direction.head<2>() / sink;
  by.p.leftCols<2>() = turn;
  by.p.col(2).setZero();
  by.p -= by_height * up.transpose();
  by.direction = way_mm * by.p;
  by_departures.col(columnOf(HeadParameter::kPlaneHeight)) = by_height;
  by_departures.col(columnOf(HeadParameter::kPlaneSlopeX)) = by_height * spot_mm.x();
  by_departures.col(columnOf(HeadParameter::kPlaneSlopeY)) = by_height * spot_mm.y();
  by_departures.col(columnOf(HeadParameter::kPlaneShiftX)) = Vector2d::UnitX();
  by_departures.col(columnOf(HeadParameter::kPlaneShiftY)) = Vector2d::UnitY();
  const Vector2d from_shift_mm = p_W_mm - plane.shift_mm;
  by_departures.col(columnOf(HeadParameter::kPlaneTurn)) = Vector2d(-from_shift_mm.y(), from_shift_mm.x());
  return true;
}

}  // namespace

struct BackwardTrace::Head {
  static constexpr int kBeam = 4;  ///< Departures of the beam: two offsets, two tilts.
  HeadVector units;
  trace::Ray<double> laser;
  std::array<trace::Ray<double>, kBeam> by_beam;
  Vector3d first_before_last;  ///< Place of the first mirror before the last, by their spacing.
  SlopedMirror first, last;
  std::optional<SlopedLens> lens;
  trace::Plane<double> plane;

  Head(const HeadDesign& design, const HeadVector& units, const HeadVector& departures);
};

BackwardTrace::Head::Head(const HeadDesign& design, const HeadVector& units_, const HeadVector& departures)
    : units(units_),
      laser(trace::laserOf<double>(design, departures.data())),
      first_before_last(-trace::drawingOf(design).ways[1]),
      first(design, 0, departures),
      last(design, 1, departures),
      plane(trace::planeOf<double>(departures.data())) {
  const auto duals = seeded<kBeam>(departures, HeadParameter::kBeamOffsetA);
  const auto sloped = trace::laserOf<Dual<kBeam>>(design, duals.data());
  for (int k = 0; k < kBeam; ++k)
    by_beam[static_cast<std::size_t>(k)] = {slopeOf<kBeam>(sloped.p_W_mm, k),
                                            slopeOf<kBeam>(sloped.direction, k)};
  if (design.lens) lens.emplace(*design.lens, departures);
}

bool BackwardTrace::landing(const Vector2d& angles_rad, Vector2d& p_W_mm, HeadJacobian& by_scaled) const {
  const Head& head = *head_;
  trace::Ray<double> ray = head.laser;
  SlopedMirror::Meeting at_first, at_last;
  SlopedLens::Meeting at_lens;
  if (!head.first.reflect(angles_rad[head.first.mirror.motor], ray, at_first)) return false;
  if (!head.last.reflect(angles_rad[head.last.mirror.motor], ray, at_last)) return false;
  if (head.lens && !head.lens->refract(ray, at_lens)) return false;

  ByRay by;
  ByVector by_first_place, by_last_place;
  if (!landAndBack(head.plane, ray, p_W_mm, by, by_scaled)) return false;
  if (head.lens) {
    head.lens->back(at_lens, by, by_scaled);
  } else {
    by_scaled.rightCols<kLensParameters>().setZero();
  }
  head.last.back(at_last, by, by_scaled, by_last_place);
  head.first.back(at_first, by, by_scaled, by_first_place);
  for (int k = 0; k < Head::kBeam; ++k) {
    const trace::Ray<double>& beam = head.by_beam[static_cast<std::size_t>(k)];
    by_scaled.col(columnOf(HeadParameter::kBeamOffsetA) + k) =
        by.p * beam.p_W_mm + by.direction * beam.direction;
  }
  // The laser goes with the first mirror, and both with the throw.
  const ByVector by_first = by_first_place + by.p;
  by_scaled.col(columnOf(HeadParameter::kThrow)) = (by_first + by_last_place).col(2);
  by_scaled.col(columnOf(HeadParameter::kMirrorSpacing)) = by_first * head.first_before_last;
  by_scaled *= head.units.asDiagonal();
  return true;
}

BackwardTrace::BackwardTrace(const HeadDesign& design, const HeadVector& units, const double* scaled)
    : head_(std::make_unique<const Head>(design, units,
                                         units.cwiseProduct(Eigen::Map<const HeadVector>(scaled)))) {}

BackwardTrace::~BackwardTrace() = default;

}  // namespace kerfbench::calibrate
