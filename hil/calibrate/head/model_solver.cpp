// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/model_solver.h"

#include <deque>
#include <memory>

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

#include "hil/calibrate/head/head_trace.h"

namespace kerfbench::hil {
namespace {

constexpr int kCount = static_cast<int>(kHeadParameterCount);
using Jet = ceres::Jet<double, kCount>;

trace::Head<Jet> variedHead(const HeadDesign& design, const HeadVector& tolerances, const double* scaled) {
  std::array<Jet, kHeadParameterCount> varied;
  for (int k = 0; k < kCount; ++k) {
    auto& one = varied[static_cast<std::size_t>(k)];
    one = Jet(scaled[k] * tolerances[k]);
    one.v[k] = tolerances[k];
  }
  return trace::headOf<Jet>(design, varied.data());
}

/// Builds the head once for all marks of an evaluation.
class SharedHead : public ceres::EvaluationCallback {
 public:
  SharedHead(const HeadDesign& design, const HeadVector& tolerances, const double* scaled)
      : design_(design), tolerances_(tolerances), scaled_(scaled) {}

  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override {
    if (new_evaluation_point) {
      const HeadVector departures = tolerances_.cwiseProduct(Eigen::Map<const HeadVector>(scaled_));
      plain_ = trace::headOf<double>(design_, departures.data());
      varied_is_new_ = false;
    }
    if (evaluate_jacobians && !varied_is_new_) {
      varied_ = variedHead(design_, tolerances_, scaled_);
      varied_is_new_ = true;
    }
  }
  [[nodiscard]] const trace::Head<double>& plain() const { return plain_; }
  [[nodiscard]] const trace::Head<Jet>& varied() const { return varied_; }

 private:
  const HeadDesign& design_;
  const HeadVector& tolerances_;
  const double* scaled_;
  trace::Head<double> plain_;
  trace::Head<Jet> varied_;
  bool varied_is_new_{};
};

class MarkCost : public ceres::SizedCostFunction<2, kCount> {
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
    trace::Vector2<Jet> p;
    if (!trace::landing<Jet>(head_.varied(), {Jet(mark_.angles_rad.x()), Jet(mark_.angles_rad.y())}, p))
      return false;
    HeadJacobian slopes;
    slopes << p[0].v.transpose(), p[1].v.transpose();
    residual = mark_.whitening_1_mm * (Eigen::Vector2d(p[0].a, p[1].a) - mark_.measured_W_mm);
    Eigen::Map<Eigen::Matrix<double, 2, kCount, Eigen::RowMajor>> by_scaled(jacobians[0]);
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
  options.function_tolerance = 1e-9;
  options.parameter_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  return options;
}

}  // namespace

std::vector<ModelledMark> modelled(const HeadDesign& design, const HeadVector& tolerances,
                                   const HeadVector& scaled, std::span<const WeighedMark> marks) {
  const trace::Head<Jet> head = variedHead(design, tolerances, scaled.data());
  std::vector<ModelledMark> all;
  all.reserve(marks.size());
  for (const WeighedMark& mark : marks) {
    trace::Vector2<Jet> p;
    ModelledMark one;
    one.lands = trace::landing<Jet>(head, {Jet(mark.angles_rad.x()), Jet(mark.angles_rad.y())}, p);
    if (one.lands) {
      one.p_W_mm = {p[0].a, p[1].a};
      one.by_scaled << p[0].v.transpose(), p[1].v.transpose();
    }
    all.push_back(one);
  }
  return all;
}

ModelSolution solveModel(const HeadDesign& design, const HeadVector& tolerances, const HeadVector& start,
                         std::span<const WeighedMark> marks, double loss_scale, int most_iterations) {
  ModelSolution solution{start, false};
  SharedHead shared(design, tolerances, solution.scaled.data());
  std::deque<MarkCost> costs;  // Ceres keeps their addresses.
  const std::unique_ptr<ceres::LossFunction> loss(loss_scale > 0.0 ? new ceres::CauchyLoss(loss_scale)
                                                                   : nullptr);
  ceres::NormalPrior tolerance(Eigen::MatrixXd::Identity(kCount, kCount), Eigen::VectorXd::Zero(kCount));

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

}  // namespace kerfbench::hil
