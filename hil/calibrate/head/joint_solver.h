// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "hil/calibrate/head/model_solver.h"
#include "hil/calibrate/head/residual_surface.h"

namespace kerfbench::hil {

/// Before it is fitted, a coefficient of degree k of the residual surface is zero ± amplitude · decay^k.
struct SurfacePrior {
  double amplitude_mm{};
  double decay{};
  double evidence{};  ///< Logarithm of the odds against no surface.
};

/// Two rows for each mark, whitened: J of the scaled departures, and what is read as its last column,
/// measured - modelled + J · scaled there.
using WhitenedRows =
    Eigen::Matrix<double, Eigen::Dynamic, static_cast<int>(kHeadParameterCount) + 1, Eigen::RowMajor>;
/// A row for each mark, or two.
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Marks as a linear problem: reading = J · scaled departures + surface + shared errors + noise. What the
/// marks of a sheet share is no unknown of the solution: it is integrated out (Schur's complement), so that
/// all products are those of marks whose noise N is correlated within a sheet. What only depends on the marks
/// and the surface's functions is kept from one linearisation to the next.
class JointMarks {
 public:
  /// `basis`: the functions of the surface at the marks, a row for each; no columns: no surface. `shared`:
  /// two rows for each mark, whitened: how the shared errors, of variance 1, move it; no columns: none.
  JointMarks(std::vector<Eigen::Matrix2d> whitenings_1_mm, RowMatrix basis, Eigen::MatrixXd shared);
  /// `rows`: of these marks, in their order.
  void linearise(const WhitenedRows& rows);

  [[nodiscard]] Eigen::Index functions() const { return basis_.cols(); }
  /// Rows^T N⁻¹ rows, its lower part.
  [[nodiscard]] const Eigen::MatrixXd& square() const { return square_; }
  /// (Whitened basis)^T N⁻¹ rows: functions for x, then for y.
  [[nodiscard]] const Eigen::MatrixXd& crossed() const { return crossed_; }
  /// (Whitened basis)^T N⁻¹ (whitened basis), its lower part.
  [[nodiscard]] const Eigen::MatrixXd& surfaceSquare() const;
  [[nodiscard]] Eigen::VectorXd surfaceDiagonal() const;

  /// For given unknowns x the shared errors are C⁻ᵀ (reading - slopes x + w), w independent of variance 1.
  /// Slopes are by the departures, then by the surface's coefficients if it has any; reading is the last
  /// column.
  [[nodiscard]] Eigen::MatrixXd sharedSlopes() const;
  /// C⁻¹ rows^T: how w moves marks, those here or others, whose rows of `shared` these are.
  [[nodiscard]] Eigen::MatrixXd sharedReach(const Eigen::MatrixXd& rows) const;

 private:
  /// (Whitened basis)^T rows.
  template <typename Rows>
  [[nodiscard]] Eigen::MatrixXd byFunctions(const Rows& rows) const;

  std::vector<Eigen::Matrix2d> whitenings_1_mm_;
  RowMatrix basis_;
  Eigen::MatrixXd shared_;
  Eigen::LLT<Eigen::MatrixXd> shared_normal_;   ///< C C^T = 1 + shared^T shared.
  Eigen::MatrixXd shared_rows_, shared_basis_;  ///< C⁻¹ shared^T times rows, and times the whitened basis.
  Eigen::VectorXd weight_xx_, weight_xy_, weight_yy_;
  Eigen::MatrixXd square_, crossed_;
  mutable Eigen::MatrixXd surface_square_;  ///< Empty until it is asked for.
};

/// Model and surface as one linear problem with Gaussian priors: departures 0 ± tolerance, coefficients as
/// SurfacePrior. Unknowns are the scaled departures, the surface's coefficients for x, then for y.
struct JointSolution {
  Eigen::VectorXd unknowns;
  Eigen::MatrixXd covariance_root;  ///< Upper triangular L with L L^T = covariance; empty if not asked for.
};

/// `basis` is that of the marks; without a prior there is no surface.
JointSolution solveJoint(const JointMarks& marks, const SmoothBasis& basis,
                         const std::optional<SurfacePrior>& prior, bool with_covariance);

/// Decays of 0.5 … 1 for which the marks may tell of a surface: of those below, evidence is not worth its
/// work (score test).
std::vector<double> promisingDecays(const JointMarks& marks, const SmoothBasis& basis);

/// The prior with the largest marginal likelihood, of these decays and amplitudes of 0.1 µm … 10 mm; nullopt
/// where even that one has odds below 20 : 1 against no surface.
std::optional<SurfacePrior> bestSurface(const JointMarks& marks, const SmoothBasis& basis,
                                        std::span<const double> decays);

/// How far this head is from its drawing, in tolerances, by what the marks hold of it: the root of the mean
/// square that one factor to all tolerances has, given the marks (marginal likelihood; before them it is
/// 1, to a factor of 2 either way, log-normal). What the marks cannot tell is then no better and no worse
/// than the rest.
double toleranceFactor(const JointMarks& marks, const SmoothBasis& basis,
                       const std::optional<SurfacePrior>& prior);

/// Rows of d(x, y)/d(unknowns) of a mark; only of the departures without a surface.
Eigen::Matrix2Xd rowsOf(const HeadJacobian& by_scaled, const Eigen::VectorXd& basis);

}  // namespace kerfbench::hil
