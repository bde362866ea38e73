// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "twin/base/print_layout.h"

namespace kerfbench::vision {

/// A motion in the plane: q = R(angle) p + shift.
struct PlaneMotion {
  Eigen::Vector2d shift_mm{Eigen::Vector2d::Zero()};
  double angle_rad{};

  [[nodiscard]] Eigen::Matrix2d rotation() const;
  [[nodiscard]] Eigen::Vector2d operator*(const Eigen::Vector2d& p_mm) const;
  [[nodiscard]] Eigen::Vector2d inverse(const Eigen::Vector2d& q_mm) const;
};

/// A mark of the layout and where it was seen.
struct MarkPair {
  Eigen::Vector2d p_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d q_mm{Eigen::Vector2d::Zero()};
  double sigma_mm{};  ///< Standard uncertainty of q_mm per axis; 0: not known.
};

struct MotionFit {
  PlaneMotion motion;
  double rms_mm{};  ///< NaN with one pair.
  int pairs{};      ///< Number of pairs that were used.
  /// Covariance of shift x, shift y and angle: mm², mm rad, rad². See motionCovariance().
  Eigen::Matrix3d covariance{Eigen::Matrix3d::Zero()};
};

/// Motion by least squares. One pair keeps angle_guess_rad. @throws std::invalid_argument without a pair.
PlaneMotion fitMotion(std::span<const MarkPair> pairs, double angle_guess_rad);

/// Covariance of fitMotion's (shift x, shift y, angle) by the pairs' own sigma_mm, checked against how well
/// the marks agree: chi² of the residuals and six degrees of belief in the sigmas decide the scale. Without
/// sigmas the residuals alone tell. The angle of one pair is not measured: its row is zero.
Eigen::Matrix3d motionCovariance(std::span<const MarkPair> pairs, const PlaneMotion& motion);

/// Motion without pairs that disagree with the others by more than limit_mm. Of two pairs that disagree with
/// each other, the one nearer to `expected` is kept.
MotionFit fitMotionRobust(std::vector<MarkPair> pairs, const PlaneMotion& expected, double limit_mm);

struct ConstellationQuery {
  const PrintLayout* print{};
  int first_unit{};
  int last_unit{};             ///< Inclusive: units that the seen marks may belong to.
  int anchor_last_unit{};      ///< A seen mark is taken in turn for one of first_unit ... this unit.
  double max_angle_rad{0.03};  ///< Around expected.angle_rad.
  double tolerance_mm{0.5};
  PlaneMotion expected;   ///< Motion that is expected of the web; S of unit 0.
  double max_shift_mm{};  ///< Largest distance from `expected`, at the mark itself; infinity where nothing is
                          ///< known.
  bool
      prefer_least_advanced{};  ///< Takes the smallest x of equally good ones, as for a web that just enters.
  /// Returns whether a mark at this place would have been seen; expected but unseen marks speak against a
  /// motion.
  std::function<bool(const Eigen::Vector2d& q_mm)> in_view;
};

struct Constellation {
  PlaneMotion motion;  ///< Motion of the web.
  int matched{};
  int expected{};  ///< Marks of the layout that should be in view.
};

/// The motion of the web that explains the seen marks best.
std::optional<Constellation> matchConstellation(std::span<const Eigen::Vector2d> seen_mm,
                                                const ConstellationQuery& query);

/// Centre of mark `index` of a unit, in S of unit 0.
Eigen::Vector2d markOnWeb(const PrintLayout& print, int unit, std::size_t index);

}  // namespace kerfbench::vision
