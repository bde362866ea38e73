// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/calibrate/head/observation.h"

namespace kerfbench::calibrate {

/// All marks of one sheet as one set-up of sheet and camera shows them, in the camera's plane C.
struct SheetView {
  std::string name;
  std::vector<SeenMark> marks;
};

struct ReversalOptions {
  Eigen::AlignedBox2d camera_field_mm{};  ///< Field of the camera, in C; it must hold all marks.
  int degree{3};                          ///< Degree of the camera's error; 1 … 5.
  double rejection_chance{0.05};          ///< Chance that one good mark or more is rejected; in (0, 1).
  double most_false_share{0.1};           ///< Largest share of marks that may be rejected; in [0, 0.5).
  double prior_mm{0.02};  ///< Standard deviation of each of its terms at the field's rim; > 0.
};

/// The camera's own error as polynomials over its field, without what is only a shift or a turn of its frame.
class CameraError {
 public:
  struct Term {
    std::string name;  ///< "dx: x y²"
    int degree{};
    double value_mm{};  ///< Value at the field's rim.
    double sigma_mm{};  ///< k = 1.
    bool held{};        ///< True where sigma is below a third of the prior: the views measure the term.
  };
  [[nodiscard]] const std::vector<Term>& terms() const { return terms_; }
  /// Camera's error at p_C: seen less true place.
  [[nodiscard]] Eigen::Vector2d at_mm(const Eigen::Vector2d& p_C_mm) const;
  /// Covariance of at_mm, k = 1; the prior where no view measures it.
  [[nodiscard]] Eigen::Matrix2d covarianceAt_mm2(const Eigen::Vector2d& p_C_mm) const;

 private:
  friend class Reversal;
  explicit CameraError(const ReversalOptions& options);
  /// Shift of a mark by each term, for 1 mm at the field's rim.
  [[nodiscard]] Eigen::Matrix2Xd movesAt(const Eigen::Vector2d& p_C_mm) const;
  void set(const Eigen::VectorXd& values_mm, const Eigen::MatrixXd& covariance_mm2, double prior_mm);

  Eigen::AlignedBox2d field_mm_;
  struct Power {
    int u{}, v{};
    int axis{};  ///< 0 dx, 1 dy, 2 the shear, of both.
  };
  std::vector<Power> powers_;
  std::vector<Term> terms_;
  Eigen::VectorXd values_mm_;
  Eigen::MatrixXd covariance_mm2_;
};

struct ReversalResult {
  CameraError camera;
  /// Each mark seen in any view, in the first view's frame, the camera's error taken off; of the covariance
  /// the part that marks do not share. What they share: camera.covarianceAt_mm2().
  std::vector<SeenMark> marks;
  /// Motion of the sheet in each view from where it was in the first.
  std::vector<Eigen::Isometry2d> X_CS;
  std::size_t rejected{};  ///< Marks that contradict the other views.
  double noise_ratio{};    ///< Scatter over what was said, RMS.
};

/// Separates what the camera sees wrong from where the marks are, by views of one sheet laid differently
/// (reversal: Evans, Hocken & Estler 1996). Between the views the sheet turns and the camera's error stays.
///
/// Turned by 180 degrees, terms of even degree (keystone, decentring, tilt) change their sign on the sheet:
/// the mean of both views is free of them. Those of odd degree do not change: scale, shear and radial
/// distortion stay, with their prior as uncertainty, unless a further view is turned by 90 degrees (shear) or
/// shifted (degree 3). A common scale no turning shows: that is the target's or the printed scale's matter.
///
/// Least squares over the places of all marks, the pose of each view but the first, and the camera's terms
/// with their prior. With one view the result is that view and the prior.
/// @throws HeadCalibrationError for no view, fewer than five marks common to a view and the first, marks out
///   of the camera's field or not finite, views that are no rigid motion of each other.
/// @throws std::invalid_argument for options out of range.
ReversalResult separateCamera(std::span<const SheetView> views, const ReversalOptions& options);

}  // namespace kerfbench::calibrate
