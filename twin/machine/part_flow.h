// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "twin/machine/linear_flow.h"
#include "twin/machine/mechanism_part.h"
#include "twin/machine/solver.h"

namespace kerfbench::twin {

/// Moves one part of a mechanism by fixed steps.
///
/// Within a piece of its forces a part is linear, and its flow over a step is a matrix that is made once. A
/// stepper's field is its linear spring about the tooth it is at, in that matrix, and the rest as an input: a
/// step with the input as it begins, then one with the parabola through the input at begin, middle and end of
/// that (an exponential collocation, Hochbruck & Ostermann 2010, ch. 2). A step that begins and ends in
/// different pieces, and one in which a sheet slides in two directions, is done by Runge-Kutta in kSubsteps.
class PartFlow {
 public:
  static constexpr int kSubsteps = 8;

  PartFlow(MechanismPart part, double step_s);

  [[nodiscard]] const MechanismPart& part() const { return part_; }
  [[nodiscard]] const double* q() const { return state_.data(); }
  [[nodiscard]] const double* v() const { return state_.data() + part_.law.joints; }

  /// `commands` of the whole mechanism.
  void step(std::span<const DriveCommand> commands);

  /// Steps so far that were done by Runge-Kutta: each costs as much as dozens of others.
  [[nodiscard]] std::uint64_t substepped() const { return substepped_; }

 private:
  struct Field {
    double pitch{};
    long long tooth{};  ///< That the linear spring is about.
  };
  struct Regime {
    std::uint64_t key{};
    LinearFlow flow;
  };

  [[nodiscard]] std::uint64_t regimeAt(const double* x, const double* u);
  const LinearFlow* flowOf(std::uint64_t key);
  [[nodiscard]] double* inputs() { return state_.data() + states_ + 1; }
  [[nodiscard]] double* fields() { return inputs() + part_.law.inputs; }
  void meetTeeth();
  [[nodiscard]] double beyondSpring(const StepperLaw& law, double q, double v);
  void addFields(const LinearFlow& flow);
  void substep();
  void rate(const double* x, const double* u, double* rate);

  MechanismPart part_;
  double step_s_;
  std::size_t states_;
  bool has_pieces_;
  /// x, then the constant 1, commands, and what the steppers' fields are beyond their springs. A step ruins
  /// what follows x in next_, and sets it anew in state_.
  std::vector<double> state_, next_;
  std::vector<double> u_begin_, u_end_;
  std::vector<Field> teeth_;
  std::vector<ForceLaw::Piece> pieces_;
  std::vector<std::unique_ptr<Regime>> regimes_;
  const Regime* last_{nullptr};
  std::uint64_t substepped_{0};
  // Runge-Kutta's scratch.
  std::array<std::vector<double>, 4> rates_;
  std::vector<double> stage_, force_, u_stage_;
};

}  // namespace kerfbench::twin
