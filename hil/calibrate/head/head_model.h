// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "hil/calibrate/head/head_parameters.h"
#include "hil/calibrate/head/nominal_head.h"

namespace kerfbench::calibrate {

/// A scan head above a sheet by vector ray trace, for fitting: where the beam lands for given mirror angles
/// and departures from the drawing.
///
/// The drawing, in W, X mirror first: the beam comes along +x, meets the X mirror at (0, -d, L), whose axis
/// points down, goes on along +y to the Y mirror at (0, 0, L), whose axis points along +x, and from there
/// straight down; positive angles move the spot along +x and +y. Y mirror first: the beam comes along -y,
/// meets the Y mirror at (-d, 0, L), whose axis points up, goes on along +x to the X mirror at (0, 0, L),
/// whose axis points along -y. A lens is drawn with its principal point at height f above W's origin and
/// looks at the direction of the beam alone.
///
/// Departures: a mirror's axis a is drawn a + A (a × n) + B n, normalised, with n its normal at rest and A, B
/// the two tilts; n is made normal to it again, turned about it by zero + (1 + scale) · angle, and leant
/// towards it by the face tilt. The face stands before the axis along its normal. The beam's horizontal and
/// upward directions are those normal to it as drawn. The sheet is z = height + slope · p; what lands at p is
/// measured at R(turn) p + shift.
///
/// Shares nothing with the twin's optics, nor with the controller's.
class HeadModel {
 public:
  /// @throws std::invalid_argument as check(design).
  explicit HeadModel(const HeadDesign& design);

  [[nodiscard]] const HeadDesign& design() const { return design_; }

  /// Landing point of the beam, nullopt where there is none: a mirror from behind, a sheet never met, a field
  /// angle of 90 degrees.
  [[nodiscard]] std::optional<Eigen::Vector2d> landing_W_mm(const Eigen::Vector2d& angles_rad,
                                                            const HeadVector& departures) const;

  struct AngleSlopes {
    Eigen::Vector2d p_W_mm{Eigen::Vector2d::Zero()};
    Eigen::Matrix2d by_angles{Eigen::Matrix2d::Zero()};  ///< mm/rad.
  };
  struct DepartureSlopes {
    Eigen::Vector2d p_W_mm{Eigen::Vector2d::Zero()};
    Eigen::Matrix<double, 2, static_cast<int>(kHeadParameterCount)> by_departures;  ///< mm per their unit.
  };
  /// Spot of a pair of angles with its derivatives, by automatic differentiation.
  [[nodiscard]] std::optional<AngleSlopes> angleSlopesAt(const Eigen::Vector2d& angles_rad,
                                                         const HeadVector& departures) const;
  [[nodiscard]] std::optional<DepartureSlopes> departureSlopesAt(const Eigen::Vector2d& angles_rad,
                                                                 const HeadVector& departures) const;

 private:
  HeadDesign design_;
};

}  // namespace kerfbench::calibrate
