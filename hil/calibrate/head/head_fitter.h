// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/calibrate/head/head_fit.h"
#include "hil/calibrate/head/joint_solver.h"
#include "hil/calibrate/head/model_solver.h"

namespace kerfbench::calibrate {

/// The steps of fitHead().
class HeadFitter {
 public:
  HeadFitter(std::span<const HeadObservation> observations, const NominalHead& nominal,
             const HeadDesign& design, const HeadFitOptions& options);
  HeadFit fit();

 private:
  void weighMarks();
  void gatherShared();
  /// Leaves out what is far from where the drawing and the axes put it.
  void dropFarMarks();
  void fitRobustly();
  /// Finds where the controller must be aimed for the field's rim: the surface must not end before, its
  /// border is a bend that no table follows.
  void reachRim();
  /// Least squares and rejection in turn until the set of marks stays; `settled`: the largest last step, in
  /// tolerances.
  void settle(int degree, double settled);
  /// Least squares by whole steps; false if they do not settle: then all is as the marks have it at the
  /// start.
  bool solve(double settled);
  /// Least squares from the start by steps that each reduce the misfit.
  void solveDamped(double settled);
  void setBasis(int degree);
  void linearise();
  /// Marks that are used, with the basis's functions if there is a prior, unless they are gathered already.
  void gather();
  void forgetGathered() {
    solver_.reset();
    gathered_.reset();
  }
  void relinearise();
  /// Tolerances as far from the drawing as the marks show this head to be.
  void scaleTolerances();
  /// Holds each mark against what the others predict; true if the set changed.
  bool judge(bool may_return);
  [[nodiscard]] int degreeFor(std::size_t marks) const;
  [[nodiscard]] std::optional<SurfacePrior> surfaceThatTheMarksWant(int degree);
  void refuseTooMany() const;
  HeadFit result() const;
  void reportParameters(HeadFit& fit) const;
  void setNoiseRatio(HeadFit& fit) const;
  void setErrorRoots(HeadFit& fit) const;

  /// Marks that are used. Their noise includes what the model cannot describe, so that it does not pull the
  /// model alone.
  [[nodiscard]] std::vector<WeighedMark> usedMarks() const;
  /// Two rows for each mark, those of marks that are used.
  template <typename Rows>
  [[nodiscard]] Rows usedOf(const Rows& rows) const;
  /// Whitened: what is left of each mark, and how the fit's independent modes move it, two columns a mark.
  void predictMarks(Eigen::VectorXd& residuals, Eigen::MatrixXd& modes) const;
  /// The surface's part in both.
  void addSurface(Eigen::VectorXd& residuals, Eigen::MatrixXd& modes) const;
  /// Shifts of the surface by the modes along x and along y, mm, a column for each mark.
  struct SurfaceModes {
    Eigen::MatrixXd x, y;
  };
  [[nodiscard]] SurfaceModes surfaceModes() const;
  [[nodiscard]] std::size_t usedCount() const;
  [[nodiscard]] bool usedLand() const;
  [[nodiscard]] Eigen::AlignedBox2d areaOfAims() const;

  std::span<const HeadObservation> observations_;
  NominalHead nominal_;
  HeadDesign design_;
  HeadFitOptions options_;
  AxisMap axes_;
  HeadVector tolerances_;
  std::vector<WeighedMark> marks_;
  std::vector<Eigen::Matrix2d> noise_mm2_;
  std::vector<bool> used_;
  HeadVector scaled_{HeadVector::Zero()};
  Eigen::AlignedBox2d reach_mm_;
  std::optional<SmoothBasis> basis_;
  /// Shifts of all marks by the sheets' shared errors, whitened: three columns a sheet.
  Eigen::MatrixXd shared_;
  RowMatrix basis_values_;  ///< Values at all aims, a row each.
  std::optional<SurfacePrior> prior_;
  WhitenedRows rows_;                             ///< Rows of all marks,
  HeadVector linearised_at_{HeadVector::Zero()};  ///< at these scaled departures.
  std::vector<bool> lands_;
  std::optional<JointMarks> gathered_;
  std::optional<JointSolver> solver_;  ///< Solver of these rows, from solve() until they change.
  JointSolution joint_;
  std::vector<HeadMarkFinding> findings_;
  double unmodelled_mm_{};  ///< Standard deviation of what the model cannot describe, before the fit.
  double tolerance_factor_{1.0};
  double noise_chi2_{}, noise_freedom_{};
};

}  // namespace kerfbench::calibrate
