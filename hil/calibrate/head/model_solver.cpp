// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/model_solver.h"

#include <cmath>
#include <deque>
#include <memory>
#include <optional>

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

#include "hil/calibrate/head/backward_trace.h"
#include "hil/calibrate/head/head_parameters.h"
#include "hil/calibrate/head/head_trace.h"

namespace kerfbench::calibrate {
namespace {

trace::Head<double> plainHead(const HeadDesign& design, const HeadVector& tolerances, const double* scaled) {
  const HeadVector departures = tolerances.cwiseProduct(Eigen::Map<const HeadVector>(scaled));
  return trace::headOf<double>(design, departures.data());
}

/// Builds the head once for all marks of an evaluation.
class SharedHead : public ceres::EvaluationCallback {
 public:
  SharedHead(const HeadDesign& design, const HeadVector& tolerances, const double* scaled)
      : design_(design), tolerances_(tolerances), scaled_(scaled) {}

  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override {
    if (new_evaluation_point) {
      plain_ = plainHead(design_, tolerances_, scaled_);
      sloped_.reset();
    }
    if (evaluate_jacobians && !sloped_) sloped_.emplace(design_, tolerances_, scaled_);
  }
  [[nodiscard]] const trace::Head<double>& plain() const { return plain_; }
  [[nodiscard]] const BackwardTrace& sloped() const { return *sloped_; }

 private:
  const HeadDesign& design_;
  const HeadVector& tolerances_;
  const double* scaled_;
  trace::Head<double> plain_;
  std::optional<BackwardTrace> sloped_;
};

class MarkCost : public ceres::SizedCostFunction<2, kHeadColumns> {
 public:
  MarkCost(const SharedHead& head, const WeighedMark& mark) : head_(head), mark_(mark) {}

  bool Evaluate(const double* const* /*parameters*/, double* residuals, double** jacobians) const override {
    Eigen::Map<Eigen::Vector2d> residual(residuals);
    if (jacobians == nullptr || jacobians[0] == nullptr) {
      Eigen::Vector2d p;
      if (!trace::landing<double>(head_.plain(), mark_.angles_rad, p)) return false;
      residual = mark_.whitening_1_mm * (p - mark_.measured_W_mm);
      return true;
    }
    Eigen::Vector2d p;
    HeadJacobian slopes;
    if (!head_.sloped().landing(mark_.angles_rad, p, slopes)) return false;
    residual = mark_.whitening_1_mm * (p - mark_.measured_W_mm);
    Eigen::Map<Eigen::Matrix<double, 2, kHeadColumns, Eigen::RowMajor>> by_scaled(jacobians[0]);
    by_scaled = mark_.whitening_1_mm * slopes;
    return true;
  }

 private:
  const SharedHead& head_;
  const WeighedMark& mark_;
};

ceres::Solver::Options solverOptions(int most_iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = most_iterations;
  options.initial_trust_region_radius = 1e8;
  options.function_tolerance = 1e-3;  // Only where to begin: HeadFitter goes on from there.
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  return options;
}

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
  ModelSolution solution{start, false};
  SharedHead shared(design, tolerances, solution.scaled.data());
  std::deque<MarkCost> costs;  // Ceres keeps their addresses.
  const std::unique_ptr<ceres::LossFunction> loss(loss_scale > 0.0 ? new ceres::CauchyLoss(loss_scale)
                                                                   : nullptr);
  ceres::NormalPrior tolerance(Eigen::MatrixXd::Identity(kHeadColumns, kHeadColumns),
                               Eigen::VectorXd::Zero(kHeadColumns));

  ceres::Problem::Options owned_here;
  owned_here.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  owned_here.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  owned_here.evaluation_callback = &shared;
  ceres::Problem problem(owned_here);
  for (const WeighedMark& mark : marks) {
    costs.emplace_back(shared, mark);
    problem.AddResidualBlock(&costs.back(), loss.get(), solution.scaled.data());
  }
  problem.AddResidualBlock(&tolerance, nullptr, solution.scaled.data());
  ceres::Solver::Summary summary;
  ceres::Solve(solverOptions(most_iterations), &problem, &summary);
  solution.converged = summary.termination_type == ceres::CONVERGENCE;
  return solution;
}

}  // namespace kerfbench::calibrate
