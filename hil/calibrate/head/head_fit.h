// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil/calibrate/head/axis_check.h"
#include "hil/calibrate/head/head_model.h"
#include "hil/calibrate/head/head_parameters.h"
#include "hil/calibrate/head/nominal_head.h"
#include "hil/calibrate/head/observation.h"
#include "hil/calibrate/head/residual_surface.h"

namespace kerfbench::calibrate {

struct HeadFitOptions {
  HeadTolerances tolerances{};
  /// Field to correct, in W. The surface covers it, and all marks. Empty: the marks alone.
  Eigen::AlignedBox2d field_W_mm{};
  /// Axes that are exchanged or run backwards are a fault of the wiring and refused; true: fitted all the
  /// same.
  bool accept_axes{false};
  /// Count the rounding of the aims to whole steps as noise of the marks, independent from one to the next.
  /// Marks of a row whose mirror stands at one and the same angle share it: lay them out so that they do not,
  /// or hand over NominalHead::nearestAim_W_mm() where a mark is made at rest, and say false.
  bool round_steps{true};
  /// Chance that one good mark or more of a fit is rejected; in (0, 1).
  double rejection_chance{0.05};
  double most_false_share{0.1};  ///< More marks may not be rejected; in [0, 0.5).
  int most_surface_degree{12};   ///< 0: no residual surface; <= 30.
};

/// Finding of a fit about one parameter.
struct HeadParameterFinding {
  HeadParameter which{};
  double value{};        ///< Departure from the design.
  double sigma{};        ///< k = 1, after the fit.
  double prior_sigma{};  ///< Standard deviation before the fit: the tolerance.
  /// The marks hold it: sigma is below a third of the tolerance.
  bool held{};
  /// Another parameter with the same effect on these marks (|correlation| > 0.7), for one that is not held;
  /// nullopt where there is none.
  std::optional<HeadParameter> mixed_with;
};

/// Fate of one observation, in the order given.
struct HeadMarkFinding {
  bool used{};
  /// Measured less fitted, where the sheet's shared error is taken as the fit has it.
  Eigen::Vector2d residual_mm{Eigen::Vector2d::Zero()};
  /// Squared distance from what all others and the tolerances predict there, in standard deviations:
  /// chi-square of two degrees of freedom for a good mark.
  double distance2{};
};

/// Smooth residual over the model, on mm of the sheet as a function of the aim.
struct HeadSurface {
  SmoothBasis basis;
  double amplitude_mm{};  ///< Standard deviation of a coefficient of degree zero before the fit.
  double decay{};         ///< Factor by which it falls from degree to degree.
  double evidence{};      ///< Logarithm of the odds for this surface against none.
};

/// A head as measured. Immutable.
class HeadFit {
 public:
  /// Landing point of the beam for an aim.
  struct Spot {
    Eigen::Vector2d p_W_mm{Eigen::Vector2d::Zero()};
    Eigen::Matrix2d by_aim{Eigen::Matrix2d::Identity()};
  };

  [[nodiscard]] const NominalHead& nominal() const { return nominal_; }
  [[nodiscard]] const HeadModel& model() const { return model_; }
  [[nodiscard]] const AxisMap& axes() const { return axes_; }
  [[nodiscard]] const HeadVector& departures() const { return departures_; }
  [[nodiscard]] const std::optional<HeadSurface>& surface() const { return surface_; }
  [[nodiscard]] const std::vector<HeadParameterFinding>& parameters() const { return parameters_; }
  [[nodiscard]] const std::vector<HeadMarkFinding>& marks() const { return marks_; }
  [[nodiscard]] std::size_t rejected() const;
  /// Scatter of the marks over their stated scatter, RMS; near 1 if both model and noise are right.
  [[nodiscard]] double noiseRatio() const { return noise_ratio_; }
  /// The ratio is larger than chance explains (1 %): all uncertainties were multiplied by it.
  [[nodiscard]] bool noiseScaled() const { return noise_scaled_; }

  /// Landing point of the beam for the controller's aim; nullopt where there is none.
  [[nodiscard]] std::optional<Spot> spotOf(const Eigen::Vector2d& aim_W_mm) const;
  /// Aim for which the beam lands at p_W, to 1e-9 mm; nullopt where none was found.
  [[nodiscard]] std::optional<Eigen::Vector2d> aimFor(const Eigen::Vector2d& p_W_mm) const;
  /// Covariance of spotOf() for model and surface together, k = 1; noise of a further mark is not in it.
  [[nodiscard]] std::optional<Eigen::Matrix2d> covarianceAt_mm2(const Eigen::Vector2d& aim_W_mm) const;
  /// Columns are independent, of variance 1: for aims p and q, modesAt(p) modesAt(q)^T is the covariance
  /// between both spots, mm².
  [[nodiscard]] std::optional<Eigen::Matrix2Xd> modesAt(const Eigen::Vector2d& aim_W_mm) const;

  /// Errors of spotOf() by where they come from. Columns are independent, of variance 1; together they are
  /// covarianceAt_mm2(). With C the covariance of the unknowns, P that of the priors and N = C⁻¹ - P⁻¹ what
  /// the marks hold: C N C is what the noise of the marks and of their sheets' places makes, C P⁻¹ C what the
  /// head's distance from drawing and data sheets makes. The latter is no better known than these.
  struct ErrorModes {
    Eigen::Matrix2Xd by_marks_mm;       ///< Noise of the marks, and their sheets' places.
    Eigen::Matrix2Xd by_tolerances_mm;  ///< Departures from the drawing, one tolerance each.
    Eigen::Matrix2Xd by_surface_mm;     ///< The residual surface's prior; no columns without a surface.
  };
  [[nodiscard]] std::optional<ErrorModes> errorModesAt(const Eigen::Vector2d& aim_W_mm) const;

 private:
  friend class HeadFitter;
  HeadFit(const NominalHead& nominal, const HeadDesign& design) : nominal_(nominal), model_(design) {}

  NominalHead nominal_;
  HeadModel model_;
  AxisMap axes_;
  HeadVector departures_{HeadVector::Zero()};
  std::optional<HeadSurface> surface_;
  Eigen::MatrixX2d coefficients_mm_;  ///< Coefficients of the surface, for x and y.
  /// Columns of L with L L^T = covariance of departures and coefficients (x, then y).
  Eigen::MatrixXd covariance_root_;
  /// Roots of the same by where they come from; their products add up to it.
  Eigen::MatrixXd root_by_marks_, root_by_tolerances_, root_by_surface_;
  std::vector<HeadParameterFinding> parameters_;
  std::vector<HeadMarkFinding> marks_;
  double noise_ratio_{1.0};
  bool noise_scaled_{};
};

/// Fits a head to marks, all of any number of sheets together.
///
/// 1. Axes: refused unless they are as the controller has them (identifyAxes), or accept_axes.
/// 2. Model: least squares over marks and tolerances, the latter weighted as measurements of zero, and what
///    the model cannot describe (tolerances.unmodelled_share) as noise of the marks; Cauchy's loss at the
///    scale of the median mark, narrowed until it settles, then none.
/// 3. Model and surface jointly, by Gauss and Newton from there, the surface with what it may be (the same
///    share) as its prior. Where that does not settle, 4 at the start, then damped steps (Levenberg and
///    Marquardt). What the marks of a sheet share (SharedError) is estimated with them: three errors
///    a sheet, integrated out, so that the more marks a sheet has the less they hide it.
/// 4. False marks: each is held against what all others and the priors predict there. distance2 above the
///    quantile of chi-square that a good one of n passes with chance 1 - rejection_chance / n is rejected,
///    the worst first; a rejected one that fits later comes back.
/// 5. With 40 marks or more the surface's amplitude and decay are those of the largest evidence (marginal
///    likelihood); there is none unless the odds are 20 : 1 against none. Then 3 and 4 again.
/// 6. Covariance of model and surface together: inverse of the normal matrix, priors included, so never
///    singular. It is scaled up where the marks scatter more than stated.
///
/// Deterministic. Marks whose ray lands nowhere in the design are rejected as false.
/// @throws HeadCalibrationError with everything that is wrong: fewer than five marks, values that are not
///   finite, wired axes, more false marks than allowed, no convergence.
/// @throws std::invalid_argument for options, formula or design out of range.
HeadFit fitHead(std::span<const HeadObservation> observations, const NominalHead& nominal,
                const HeadDesign& design, const HeadFitOptions& options = {});

}  // namespace kerfbench::calibrate
