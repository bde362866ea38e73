// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/calibrate/marks/mark_code.h"
#include "hil/calibrate/marks/mark_job.h"
#include "hil/camera/tile_source.h"
#include "hil/vision/image/camera_calibration.h"
#include "hil/vision/kerf/kerf_measurement.h"

namespace kerfbench::calibrate {

/// A mark as cut.
struct FieldMark {
  int number{};
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};  ///< Centre of the mark.
  /// Covariance of p_S_mm, mm², by noise, grid, texture and edges of its own arms: independent from mark to
  /// mark. What all marks have in common is in FieldPictures::poseCovariance().
  Eigen::Matrix2d covariance{Eigen::Matrix2d::Zero()};
  /// Map of the directions of M, as drawn, to those in S as cut: about the Jacobian of the head's error
  /// there. The unit matrix for a perfect head, det < 0 for a mirrored one.
  Eigen::Matrix2d as_cut{Eigen::Matrix2d::Identity()};
  MarkTurn turn;                                    ///< The nearest of the eight ways, as_cut rounded.
  double kerf_width_mm{};                           ///< Mean over its arms.
  Eigen::Vector2d p_V_mm{Eigen::Vector2d::Zero()};  ///< Place in the camera's plane at which it was seen, for
                                                    ///< the error of the camera's map.
};

/// Something that is not a whole mark.
struct DamagedMark {
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};
  std::string reason;  ///< "lacks an arm", "four ticks; five make a number", …
};

struct FieldPictures {
  std::vector<FieldMark> marks;  ///< Marks sorted by number, then by place; of a doubled one both are here.
  std::vector<DamagedMark> damaged;   ///< Damaged marks sorted by place.
  int strays{};                       ///< Cuts that belong to no mark: scratches, dust, other work.
  vision::UnitPose pose;              ///< Pose of the sheet on the table, by its printed marks.
  std::vector<std::string> problems;  ///< Reasons not to use any of this: no pose, unfit pictures.

  /// Error of all marks' places by the sheet's pose, as one error: covariance of what it shifts (x, y in S,
  /// mm) and turns (rad, about p_S, from x to y) them all by.
  [[nodiscard]] Eigen::Matrix3d poseCovarianceAbout(const Eigen::Vector2d& p_S_mm) const;
  /// Covariance of the shift that it makes at p_S alone.
  [[nodiscard]] Eigen::Matrix2d poseCovariance(const Eigen::Vector2d& p_S_mm) const;
};

struct FieldSearchOptions {
  double size_mm{};         ///< Size of the marks, as drawn.
  double open_gray{235.0};  ///< As KerfScanOptions.
  double beam_radius_mm{};
  double board_thickness_mm{};
  double table_sigma_mm{};
  int threads{1};  ///< The result is the same at any number.
};

/// Finds every field mark in the pictures of a sheet (unit 0), wherever and however it lies, by its own
/// shape: no place is expected. Scales within 20 % of the drawing and shears within 10 degrees are seen.
/// @throws std::invalid_argument for options out of range or tiles of another size than calibrated.
FieldPictures findFieldMarks(camera::TileSource& tiles, const vision::CameraCalibration& calibration,
                             const std::vector<RegistrationMark>& print, const FieldSearchOptions& options);

/// A wanted mark and where it was cut.
struct MarkPoint {
  WantedMark wanted;
  FieldMark cut;
  /// Landing point less wanted place, mm.
  [[nodiscard]] Eigen::Vector2d error_mm(const MarkJob& job) const {
    return cut.p_S_mm - job.wanted_S_mm(wanted);
  }
};

/// Finding of the pictures about a job.
struct MarkedField {
  std::vector<MarkPoint> points;     ///< One for each wanted mark that was found once; in order of number.
  std::vector<int> missing;          ///< Wanted, not found.
  std::vector<int> doubled;          ///< Found more than once; none of them is in points.
  std::vector<int> foreign;          ///< Found, not wanted: another job's.
  MarkTurn layout;                   ///< Turn of most marks.
  std::vector<std::string> remarks;  ///< All of this in words, and how the axes lie if not as drawn.
  /// Reasons not to use the pictures for this job: another job's sheet, two sheets mixed, too few marks,
  /// FieldPictures::problems.
  std::vector<std::string> problems;
};

/// Less than `least_share` of the marks wanted is too few.
MarkedField matchField(const MarkJob& job, const FieldPictures& pictures, double least_share = 0.5);

}  // namespace kerfbench::calibrate
