// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "twin/machine/solver.h"

namespace kerfbench::twin {

/// Classical fourth-order Runge-Kutta over Bullet's articulated-body algorithm. A step in which a force has a
/// kink (it begins and ends in different pieces, see ForceLaw) is halved until the kink lies within step /
/// 2^kHalvings, because there Runge-Kutta falls back to second order.
class ReferenceSolver final : public Solver {
 public:
  enum class Accelerations {
    /// Articulated bodies at the first stage of a step, M^-1 times the change of force at the others. Exact
    /// for
    /// a Mechanism, whose mass matrix is constant, at a third of the cost.
    kOnceAStep,
    kEveryStage,  ///< Articulated bodies at every stage; assumes nothing.
  };

  static constexpr int kHalvings = 5;

  /// Makes the solver. @throws std::invalid_argument if the mechanism is too fast for the step.
  ReferenceSolver(std::shared_ptr<const Mechanism> mechanism, double step_s,
                  Accelerations accelerations = Accelerations::kOnceAStep);

  void run(double begin_s, std::size_t steps, std::span<const DriveCommand> commands) override;
  /// Makes a step of another length, not above the solver's own.
  void stepBy(double begin_s, double step_s, std::span<const DriveCommand> commands);

  [[nodiscard]] std::span<const double> q() const override { return {x_.data(), n_}; }
  [[nodiscard]] std::span<const double> v() const override { return {x_.data() + n_, n_}; }
  /// Whole state, see ForceLaw; for tests.
  [[nodiscard]] std::span<double> state() { return x_; }

 private:
  /// Advances from a share of the commands' step on; step_s is the length of this stretch.
  void advance(std::span<const DriveCommand> commands, double from_share, int halvings, double step_s);
  void rungeKutta(double step_s);
  void commandsAt(std::span<const DriveCommand> commands, double share, std::vector<double>& u) const;
  void firstRate(const double* u);
  void laterRate(const std::vector<double>& x, const double* u, std::vector<double>& rate);

  std::shared_ptr<const Mechanism> mechanism_;
  Multibody body_;
  std::size_t n_;
  double step_s_;
  Accelerations accelerations_;
  std::vector<double> x_, start_, stage_;
  std::array<std::vector<double>, 4> rates_;
  bool first_known_{false};  ///< True if rates_[0] and first_force_ are those of x_ already.
  std::vector<double> first_force_, force_;
  Eigen::VectorXd change_;
  std::vector<double> u_begin_, u_middle_, u_end_;
  std::vector<ForceLaw::Piece> pieces_before_, pieces_after_;
};

}  // namespace kerfbench::twin
