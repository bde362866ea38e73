// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "hil/calibrate/head/head_parameters.h"

namespace kerfbench::calibrate {

/// Two rows for each mark, whitened: J of the scaled departures, and what is read as its last column,
/// measured
/// - modelled.
using WhitenedRows =
    Eigen::Matrix<double, Eigen::Dynamic, static_cast<int>(kHeadParameterCount) + 1, Eigen::RowMajor>;
/// A row for each mark, or two.
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Marks as a linear problem: reading = J · step of the scaled departures + surface + shared errors + noise.
/// What the marks of a sheet share is no unknown of the solution: it is integrated out (Schur's complement),
/// so that all products are those of marks whose noise N is correlated within a sheet. What only depends on
/// the marks and the surface's functions is kept from one linearisation to the next.
class JointMarks {
 public:
  /// `basis`: the functions of the surface at the marks, a row for each; no columns: no surface. `shared`:
  /// two rows for each mark, whitened: how the shared errors, of variance 1, move it; no columns: none.
  JointMarks(std::vector<Eigen::Matrix2d> whitenings_1_mm, RowMatrix basis, Eigen::MatrixXd shared);
  /// `rows`: of these marks, in their order. `home`: the step that leads to the drawing.
  void linearise(const WhitenedRows& rows, const HeadVector& home);

  [[nodiscard]] const HeadVector& home() const { return home_; }

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
  HeadVector home_{HeadVector::Zero()};
  Eigen::MatrixXd square_, crossed_;
  mutable Eigen::MatrixXd surface_square_;  ///< Empty until it is asked for.
};

}  // namespace kerfbench::calibrate
