// SPDX-License-Identifier: Apache-2.0
#include "twin/machine/reference_solver.h"

#include <cmath>
#include <utility>

#include "twin/machine/divergence.h"

namespace kerfbench::twin {

void requireSane(const Mechanism& mechanism, std::span<const double> q, std::span<const double> v,
                 double time_s) {
  const std::vector<double>& most = mechanism.mostSpeeds();
  for (std::size_t i = 0; i < v.size(); ++i) {
    // The condition is written so that NaN is beyond.
    if (std::abs(v[i]) <= most[i] && std::isfinite(q[i])) continue;
    throw DivergenceError(time_s, mechanism.description().joints[i].name);
  }
}

ReferenceSolver::ReferenceSolver(std::shared_ptr<const Mechanism> mechanism, double step_s,
                                 Accelerations accelerations)
    : mechanism_(std::move(mechanism)),
      body_(mechanism_->description().joints),
      n_(mechanism_->law().joints),
      step_s_(step_s),
      accelerations_(accelerations),
      x_(mechanism_->startState()) {
  mechanism_->requireSlowerThan(step_s_);
  start_ = stage_ = x_;
  rates_.fill(x_);
  for (auto* values : {&first_force_, &force_}) values->assign(n_, 0.0);
  for (auto* pieces : {&pieces_before_, &pieces_after_}) pieces->assign(mechanism_->law().pieceCount(), 0);
  for (auto* values : {&u_begin_, &u_middle_, &u_end_}) values->assign(mechanism_->law().inputs, 0.0);
}

void ReferenceSolver::firstRate(const double* u) {
  std::vector<double>& rate = rates_[0];
  mechanism_->law().evaluate(x_.data(), u, first_force_.data(), rate.data() + 2 * n_);
  std::copy_n(x_.begin() + static_cast<std::ptrdiff_t>(n_), n_, rate.begin());
  body_.accelerations(q(), v(), first_force_, {rate.data() + n_, n_});
}

void ReferenceSolver::laterRate(const std::vector<double>& x, const double* u, std::vector<double>& rate) {
  mechanism_->law().evaluate(x.data(), u, force_.data(), rate.data() + 2 * n_);
  std::copy_n(x.begin() + static_cast<std::ptrdiff_t>(n_), n_, rate.begin());
  if (accelerations_ == Accelerations::kEveryStage) {
    body_.accelerations({x.data(), n_}, {x.data() + n_, n_}, force_, {rate.data() + n_, n_});
    return;
  }
  const auto size = static_cast<Eigen::Index>(n_);
  const auto vector = [size](const double* values) {
    return Eigen::Map<const Eigen::VectorXd>(values, size);
  };
  change_ = vector(force_.data()) - vector(first_force_.data());
  Eigen::Map<Eigen::VectorXd> acceleration(rate.data() + n_, size);
  acceleration.noalias() = mechanism_->inverseMass() * change_;
  acceleration += vector(rates_[0].data() + n_);
}

void ReferenceSolver::run(double begin_s, std::size_t steps, std::span<const DriveCommand> commands) {
  const std::size_t drives = mechanism_->law().inputs;
  for (std::size_t k = 0; k < steps; ++k) {
    stepBy(begin_s + static_cast<double>(k) * step_s_, step_s_, commands.subspan(k * drives, drives));
  }
}

// Commands within a step: the parabola through begin, middle and end.
void ReferenceSolver::commandsAt(std::span<const DriveCommand> commands, double share,
                                 std::vector<double>& u) const {
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const DriveCommand& c = commands[i];
    const double from_middle = 2.0 * share - 1.0;
    const double slope = 0.5 * (c.end - c.begin);
    const double bend = 0.5 * (c.begin + c.end) - c.middle;
    u[i] = c.middle + from_middle * (slope + bend * from_middle);
  }
}

void ReferenceSolver::stepBy(double begin_s, double step_s, std::span<const DriveCommand> commands) {
  first_known_ = false;
  advance(commands, 0.0, 0, step_s);
  requireSane(*mechanism_, q(), v(), begin_s + step_s);
}

void ReferenceSolver::advance(std::span<const DriveCommand> commands, double from_share, int halvings,
                              double step_s) {
  const ForceLaw& law = mechanism_->law();
  const double share = std::ldexp(1.0, -halvings);
  commandsAt(commands, from_share, u_begin_);
  commandsAt(commands, from_share + 0.5 * share, u_middle_);
  commandsAt(commands, from_share + share, u_end_);
  start_ = x_;
  law.observe(x_.data(), u_begin_.data(), pieces_before_.data());
  rungeKutta(step_s);
  law.observe(x_.data(), u_end_.data(), pieces_after_.data());
  if (halvings == kHalvings || pieces_after_ == pieces_before_) return;
  x_ = start_;
  first_known_ = true;  // The first half begins as the whole did.
  advance(commands, from_share, halvings + 1, 0.5 * step_s);
  advance(commands, from_share + 0.5 * share, halvings + 1, 0.5 * step_s);
}

void ReferenceSolver::rungeKutta(double step_s) {
  const std::size_t size = x_.size();
  const auto advance = [&](const std::vector<double>& rate, double by_s) {
    for (std::size_t i = 0; i < size; ++i) stage_[i] = x_[i] + by_s * rate[i];
  };
  if (!first_known_) firstRate(u_begin_.data());
  first_known_ = false;
  advance(rates_[0], 0.5 * step_s);
  laterRate(stage_, u_middle_.data(), rates_[1]);
  advance(rates_[1], 0.5 * step_s);
  laterRate(stage_, u_middle_.data(), rates_[2]);
  advance(rates_[2], step_s);
  laterRate(stage_, u_end_.data(), rates_[3]);
  for (std::size_t i = 0; i < size; ++i) {
    x_[i] += step_s / 6.0 * (rates_[0][i] + 2.0 * (rates_[1][i] + rates_[2][i]) + rates_[3][i]);
  }
}

}  // namespace kerfbench::twin
