// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include <Eigen/Core>

namespace kerfbench::calibrate {

/// Least number of marks from which a map follows.
inline constexpr std::size_t kLeastMarks = 5;
/// A parameter is known by the marks where its standard uncertainty is below this share of what it was before
/// them.
inline constexpr double kHeldShare = 1.0 / 3.0;

/// Marks from which no head can be calibrated; the message lists everything that is wrong, a line each.
class HeadCalibrationError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Error that all marks of a sheet have in common, by the error of the sheet's pose.
struct SharedError {
  int sheet{};  ///< Number of the sheet, unique.
  /// Shift of the measured mark by each of three independent errors of variance 1, mm.
  Eigen::Matrix<double, 2, 3> modes_mm{Eigen::Matrix<double, 2, 3>::Zero()};
};

/// One mark: what the controller was aimed at and where the beam really marked.
struct HeadObservation {
  std::optional<int> mark;  ///< Number of the mark in the job, for messages only.
  /// Input of the controller's formula: where a correction table was at work the corrected aim, (x + dx, y +
  /// dy). So marks made with different tables, or without one, are observations of one and the same head.
  Eigen::Vector2d aim_W_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d measured_W_mm{Eigen::Vector2d::Zero()};
  /// Covariance of measured_W_mm, what the marks do not share (k = 1); positive definite.
  Eigen::Matrix2d covariance_mm2{Eigen::Matrix2d::Identity()};
  std::optional<SharedError> shared;  ///< Error that the marks of a sheet share.

  /// Covariance of measured_W_mm, all of it.
  [[nodiscard]] Eigen::Matrix2d wholeCovariance_mm2() const {
    if (!shared) return covariance_mm2;
    return covariance_mm2 + shared->modes_mm * shared->modes_mm.transpose();
  }
};

/// All of it finite, with a covariance that is one.
bool isMeasured(const HeadObservation& observation);

/// A mark of the job, and one that was found on the sheet.
struct AimedMark {
  int id{};
  Eigen::Vector2d aim_W_mm{Eigen::Vector2d::Zero()};
};
struct SeenMark {
  int id{};
  Eigen::Vector2d p_mm{Eigen::Vector2d::Zero()};  ///< Place in the frame of the measurement.
  Eigen::Matrix2d covariance_mm2{Eigen::Matrix2d::Identity()};
};

struct PairingLimits {
  double missing_share{0.25};  ///< Largest share of the job's marks that may be missing; in [0, 1).
  double false_share{0.1};     ///< Largest share of doubled or foreign marks; in [0, 1).
  /// Two marks of one number within this many standard deviations of each other are one, seen twice.
  double same_sigmas{5.0};
};

struct Pairing {
  std::vector<HeadObservation> observations;  ///< Observations in the job's order.
  std::vector<int> missing;                   ///< Numbers of the job that were not found.
  std::vector<int> doubled;  ///< Found more than once, at different places: none of them is used.
  std::vector<int> merged;   ///< Found more than once at one place: their weighted mean is used.
  std::vector<int> unknown;  ///< Marks that are not of the job.
};

/// Marks of the job with those found, by their numbers.
/// @throws HeadCalibrationError beyond the limits, for a number that the job has twice, and for marks that
///   are not finite or have a covariance that is none.
Pairing pairMarks(std::span<const AimedMark> aimed, std::span<const SeenMark> seen,
                  const PairingLimits& limits = {});

}  // namespace kerfbench::calibrate
