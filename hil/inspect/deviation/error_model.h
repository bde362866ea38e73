// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/inspect/evidence/evidence.h"

namespace kerfbench::inspect {

/// The readings of one entity of one unit, and how they may be wrong:
///
///     reading_i = true_i + noise_i + shared_i · e
///
/// noise_i has the caliper's own sigma_i and the correlation q^|i - j| within a segment. e are independent
/// standard normal draws that many readings have in common: the first eight belong to the line (what the grid
/// of pixels and the model of the flanks leave, one for each eighth of a turn that it may run in: on a
/// straight line all readings share one, around a circle they change), the next three to the unit (how it was
/// found to lie by its marks), the next to the tiles (where the table stopped, two for each tile: all
/// readings in it move alike), the others to camera and table and so to all units: the modes of the camera's
/// calibration, the scale of the table, and three more by how deep in the board kerfs are seen and how
/// aslant.
struct ReadingLine {
  static constexpr Eigen::Index kLine = 8;
  static constexpr Eigen::Index kPose = 3;
  static constexpr Eigen::Index kOwn = kLine + kPose;  ///< Before the tiles.
  static constexpr Eigen::Index kScale = 1;            ///< After the modes of the camera.
  static constexpr Eigen::Index kSight = 3;            ///< After the scale of the table.

  std::size_t kerf{};  ///< Index in KerfScan::entities.
  int unit{};
  std::vector<std::size_t> caliper;  ///< Index in EntityKerf::calipers of each reading, ascending.
  std::vector<int> tile;  ///< Picture that each reading comes from; empty if its error does not matter.
  std::vector<double> reading_mm;
  std::vector<double> sigma_mm;  ///< Standard deviation of the noise.
  std::vector<std::size_t>
      segment;  ///< First reading of each run of neighbouring stations; ends with size().
  double q{};   ///< Correlation of the noise of two neighbouring stations, 0 … 0.95.
  /// Columns of the tiles that its readings come from, each by its place among ErrorModel::tiles: of a web of
  /// many units a line knows two or three tiles.
  std::vector<Eigen::Index> tiles;
  Eigen::MatrixXd shared;  ///< Readings x (kOwn + tiles + modes of the camera + kScale + kSight), mm.

  [[nodiscard]] std::size_t size() const { return reading_mm.size(); }
  [[nodiscard]] Eigen::Index tileColumns() const { return static_cast<Eigen::Index>(tiles.size()); }
  /// Whether two readings share the table's error.
  [[nodiscard]] bool sameTile(std::size_t a, std::size_t b) const {
    return tile.empty() || tile[a] == tile[b];
  }
  /// Which of the line's own errors a reading on a curve of this tangent has.
  [[nodiscard]] static Eigen::Index directionOf(const Eigen::Vector2d& tangent);
};

/// The lines, one for each of KerfScan::entities in order, and what they have in common.
struct ErrorModel {
  std::vector<ReadingLine> lines;  ///< All of them, unless `make` makes them; may be empty.
  Eigen::Index tiles{};            ///< Columns of the tiles.
  Eigen::Index modes{};            ///< Columns of tiles and camera, all that are no line's or unit's own.
  /// Standard uncertainty of an extreme by what the estimator leaves that no scatter tells and no part of
  /// this model holds, such as a bump that is narrower than a window.
  double estimator_mm{};
  /// Whether all lines are one run of readings of one trend, as the frames of a cut are: then how many places
  /// compete to be the worst is known as well as the trend. Else a worst is at least as uncertain as the
  /// place where it is read, DeviationEstimate::worst_u_place.
  bool trends{};
  double correlation_mm{};  ///< Length over which the noise along a line falls to 1/e; 0 if it is white.

  /// What of a line is asked for: with kReadings, ReadingLine::tiles and ::shared, nine tenths of it, are
  /// left empty.
  enum class Part { kReadings, kAll };
  /// Makes a line each time that it is asked for, where those of a long run would fill the memory. Several
  /// threads may ask. Empty: `lines` has all.
  std::function<ReadingLine(std::size_t line, Part part)> make{};
  std::size_t made{};  ///< Number of lines that `make` makes.

  [[nodiscard]] std::size_t size() const { return make ? made : lines.size(); }
  [[nodiscard]] ReadingLine line(std::size_t number, Part part = Part::kAll) const {
    return make ? make(number, part) : lines[number];
  }
};

/// Offsets that the path is judged by: found, away from joints, a number.
bool judgesOffset(const vision::Caliper& c);

/// Pose errors from UnitPose::covariance, turned into shifts of the sheet under the caliper; calibration
/// errors from the modes of the kerf camera where each caliper was looked at; there the depth at which the
/// kerf is seen moves it by its own uncertainty times the slope of the line of sight. Part of them cancels,
/// as the marks are seen through the same lens; that is not counted. Each tile may lie where the table did
/// not mean to stop: that shifts all of its readings alike; an error of the table's scale moves them away
/// from the middle of their unit's marks. The marks are seen in tiles too; what cancels by that is not
/// counted either. Lines are made when they are asked for; `evidence` must outlive the model.
ErrorModel errorModelOf(const Evidence& evidence);

/// Correlation of the noise of neighbours from third differences of readings in units of their own sigma,
/// pooled over `series` of one pitch each; it makes the differences of neighbours smaller than sigma says.
/// Steps are clipped at 3 sigma. 0 if there are fewer than 30 differences.
class NeighbourCorrelation {
 public:
  void add(std::span<const double> series);
  /// Once, after the last series.
  double value();

 private:
  std::vector<double> squares_;
};
double neighbourCorrelation(const std::vector<std::vector<double>>& series);

/// Shifts of the plane by the modes of a camera, on a grid over the area of its calibration.
class ModeField {
 public:
  explicit ModeField(const vision::CameraCalibration& calibration);
  [[nodiscard]] Eigen::Index modes() const { return static_cast<Eigen::Index>(shift_mm_.size()); }
  /// Shift of the point p for one standard deviation of a mode; beyond the area as at its rim.
  [[nodiscard]] Eigen::Vector2d at(Eigen::Index mode, const Eigen::Vector2d& p_mm) const;

 private:
  static constexpr int kNodes = 13;
  Eigen::AlignedBox2d area_mm_;
  std::vector<std::vector<Eigen::Vector2d>> shift_mm_;
};

}  // namespace kerfbench::inspect
