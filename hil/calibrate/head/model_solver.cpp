// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/model_solver.h"

#include <cmath>
#include <optional>

#include "hil/base/least_squares.h"
#include "hil/calibrate/head/backward_trace.h"
#include "hil/calibrate/head/head_parameters.h"
#include "hil/calibrate/head/head_trace.h"

namespace kerfbench::calibrate {
namespace {

trace::Head<double> plainHead(const HeadDesign& design, const HeadVector& tolerances, const double* scaled) {
  const HeadVector departures = tolerances.cwiseProduct(Eigen::Map<const HeadVector>(scaled));
  return trace::headOf<double>(design, departures.data());
}

/// Rows of the marks and then of the tolerances, each a measurement of zero departure.
class HeadResiduals {
 public:
  HeadResiduals(const HeadDesign& design, const HeadVector& tolerances, std::span<const WeighedMark> marks)
      : design_(design), tolerances_(tolerances), marks_(marks) {}

  [[nodiscard]] Eigen::Index rows() const {
    return 2 * static_cast<Eigen::Index>(marks_.size()) + kHeadColumns;
  }

  /// False where a mark does not land.
  bool operator()(const Eigen::VectorXd& scaled, Eigen::VectorXd& residuals,
                  Eigen::MatrixXd* jacobian) const {
    if (jacobian == nullptr ? !misses(scaled, residuals) : !missesAndSlopes(scaled, residuals, *jacobian))
      return false;
    residuals.tail<kHeadColumns>() = scaled;
    if (jacobian != nullptr) jacobian->bottomRows<kHeadColumns>().setIdentity();
    return true;
  }

 private:
  bool misses(const Eigen::VectorXd& scaled, Eigen::VectorXd& residuals) const {
    const trace::Head<double> head = plainHead(design_, tolerances_, scaled.data());
    Eigen::Vector2d p;
    for (std::size_t i = 0; i < marks_.size(); ++i) {
      if (!trace::landing<double>(head, marks_[i].angles_rad, p)) return false;
      setMiss(i, p, residuals);
    }
    return true;
  }

  bool missesAndSlopes(const Eigen::VectorXd& scaled, Eigen::VectorXd& residuals,
                       Eigen::MatrixXd& jacobian) const {
    const BackwardTrace head(design_, tolerances_, scaled.data());
    Eigen::Vector2d p;
    HeadJacobian slopes;
    for (std::size_t i = 0; i < marks_.size(); ++i) {
      if (!head.landing(marks_[i].angles_rad, p, slopes)) return false;
      setMiss(i, p, residuals);
      jacobian.middleRows<2>(2 * static_cast<Eigen::Index>(i)) = marks_[i].whitening_1_mm * slopes;
    }
    return true;
  }

  void setMiss(std::size_t i, const Eigen::Vector2d& p_W_mm, Eigen::VectorXd& residuals) const {
    residuals.segment<2>(2 * static_cast<Eigen::Index>(i)) =
        marks_[i].whitening_1_mm * (p_W_mm - marks_[i].measured_W_mm);
  }

  const HeadDesign& design_;
  const HeadVector& tolerances_;
  std::span<const WeighedMark> marks_;
};

}  // namespace

std::vector<ModelledMark> modelled(const HeadDesign& design, const HeadVector& tolerances,
                                   const HeadVector& scaled, std::span<const WeighedMark> marks) {
  const BackwardTrace sloped(design, tolerances, scaled.data());
  std::vector<ModelledMark> all(marks.size());
  for (std::size_t i = 0; i < marks.size(); ++i)
    all[i].lands = sloped.landing(marks[i].angles_rad, all[i].p_W_mm, all[i].by_scaled);
  return all;
}

std::vector<std::optional<Eigen::Vector2d>> landings(const HeadDesign& design, const HeadVector& tolerances,
                                                     const HeadVector& scaled,
                                                     std::span<const WeighedMark> marks) {
  const trace::Head<double> head = plainHead(design, tolerances, scaled.data());
  std::vector<std::optional<Eigen::Vector2d>> all(marks.size());
  for (std::size_t i = 0; i < marks.size(); ++i) {
    Eigen::Vector2d p;
    if (trace::landing<double>(head, marks[i].angles_rad, p)) all[i] = p;
  }
  return all;
}

std::vector<double> distancesFrom(const HeadDesign& design, const HeadVector& tolerances,
                                  const HeadVector& scaled, std::span<const WeighedMark> marks) {
  const auto here = landings(design, tolerances, scaled, marks);
  std::vector<double> distances(marks.size(), INFINITY);
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (here[i]) distances[i] = (marks[i].whitening_1_mm * (marks[i].measured_W_mm - *here[i])).norm();
  }
  return distances;
}

ModelSolution solveModel(const HeadDesign& design, const HeadVector& tolerances, const HeadVector& start,
                         std::span<const WeighedMark> marks, double loss_scale, int most_iterations) {
  const HeadResiduals residuals(design, tolerances, marks);
  base::LeastSquaresProblem problem;
  problem.parameters = kHeadColumns;
  problem.residuals = residuals.rows();
  problem.evaluate = residuals;
  if (loss_scale > 0.0) {
    problem.robust_blocks = static_cast<Eigen::Index>(marks.size());
    problem.block_rows = 2;
    problem.loss_scale = loss_scale;
  }
  base::LeastSquaresOptions options;
  options.most_iterations = most_iterations;
  options.start_radius = 1e8;
  options.function_tolerance = 1e-3;  // Only where to begin: HeadFitter goes on from there.
  const base::LeastSquaresSummary summary = base::minimise(problem, start, options);
  return {summary.x, summary.settled()};
}

}  // namespace kerfbench::calibrate
