// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "twin/description/description.h"
#include "twin/laser/power_noise.h"

namespace kerfbench::gauge {

/// What the machine that a preset has sampled does to an artefact which is burnt at a place of its field. The
/// artefact's path is prescribed, so where the machine aims is not taken from it; how its beam burns is:
///
///   static   size, roundness and slant of the beam by focus, tilt, offset and the board's height and slope;
///            the tube's power.
///   dynamic  also the tube's noise and drift in time, and the flutter of the board, which moves the spot
///            where the beam falls aslant. That is a deviation of the cut, so the truth has it as well.
class ArtefactBeam {
 public:
  /// @throws std::invalid_argument if the beam does not reach `p_W_mm`.
  ArtefactBeam(const twin::MachineDescription& machine, const Eigen::Vector2d& p_W_mm);

  /// 1/e² ellipse as of twin::Footprint.
  double radius_x_mm{}, radius_y_mm{}, correlation{};
  double power{1.0};  ///< Power of the tube as a share of what its data sheet says.
  /// Energy of creases as a multiple of what a beam of its data sheet's radius needs: who orders a crease
  /// sets its power by what the beam at hand burns.
  double crease_energy{1.0};
  double noise{}, noise_correlation_s{1e-3}, drift{};

  /// Covariance of the beam's light on the sheet, mm²: a 1/e² radius is two standard deviations.
  [[nodiscard]] Eigen::Matrix2d covariance_mm2() const;
  /// Shift of the spot by the board's flutter at a time.
  [[nodiscard]] Eigen::Vector2d flutterShift_mm(double time_s) const;

 private:
  Eigen::Vector2d shift_per_height_{Eigen::Vector2d::Zero()};
  double flutter_mm_{}, flutter_rad_s_{}, flutter_phase_rad_{};
};

}  // namespace kerfbench::gauge
