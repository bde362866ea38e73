// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
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
/// different pieces is halved until its kink lies within step / 2^kHalvings: at a play's flank a kink that is
/// missed by t costs (w t)² / 2 of the speed, 3e-5 for 4 kHz. A sheet that slides in two directions is not
/// linear in any piece and is done by Runge-Kutta.
class PartFlow {
 public:
  static constexpr int kHalvings = 5;

  PartFlow(MechanismPart part, double step_s);

  [[nodiscard]] const MechanismPart& part() const { return part_; }
  [[nodiscard]] const double* q() const { return state_.data(); }
  [[nodiscard]] const double* v() const { return state_.data() + part_.law.joints; }

  /// Makes one step; `commands` are those of the whole mechanism.
  void step(std::span<const DriveCommand> commands);

  /// Number of steps so far that were halved: each costs as much as a dozen others.
  [[nodiscard]] std::uint64_t halved() const { return halved_; }

 private:
  struct Field {
    double pitch{};
    long long tooth{};  ///< Tooth about which the linear spring acts.
  };
  struct Regime {
    std::uint64_t key{};
    bool affine{};
    /// Flows by halvings of the step; made when needed.
    std::array<std::unique_ptr<LinearFlow>, kHalvings + 1> flows;
  };
  /// Share of a step that is advanced at once.
  struct Stretch {
    double from{};
    int halvings{};
    [[nodiscard]] double share() const { return 1.0 / static_cast<double>(1U << halvings); }
  };

  void findKinks();
  /// Pieces as one number, see setPieces().
  [[nodiscard]] std::uint64_t regimeAt(const double* x, const double* u);
  [[nodiscard]] std::uint64_t regimeNow();
  /// Flow of a regime; nullptr where the part is not affine.
  const LinearFlow* flowOf(std::uint64_t key, int halvings);
  Regime& regimeOf(std::uint64_t key);
  void setPieces(std::uint64_t key);
  [[nodiscard]] std::unique_ptr<LinearFlow> makeFlow(double step_s) const;
  void commandsAt(double share, std::vector<double>& u) const;
  void advance(const Stretch& stretch);
  /// Sets next_ to the state at the end of the stretch; false if that needs a shorter one.
  bool propagate(const Stretch& stretch, std::uint64_t key);
  [[nodiscard]] double* inputs() { return state_.data() + states_ + 1; }
  [[nodiscard]] double* fields() { return inputs() + part_.law.inputs; }
  void meetTeeth();
  [[nodiscard]] double beyondSpring(const StepperLaw& law, double q, double v);
  void addFields(const LinearFlow& flow, double step_s);
  void rungeKutta(const Stretch& stretch);
  void rate(const double* x, const double* u, double* rate);

  MechanismPart part_;
  double step_s_;
  std::size_t states_;
  ForceLaw kinked_;                 ///< Elements of the part's law that have pieces.
  std::vector<std::size_t> kinks_;  ///< Places of these elements' pieces among all pieces.
  /// State x, then the constant 1, commands, and the excess of the steppers' fields over their springs. A
  /// step ruins all after x in next_, and sets it anew in state_.
  std::vector<double> state_, next_;
  std::vector<double> u_from_, u_to_;    ///< Inputs at both ends of the step.
  std::vector<double> u_begin_, u_end_;  ///< Inputs at both ends of the stretch.
  std::uint64_t key_{};                  ///< Regime of the state with commands u_key_.
  std::vector<double> u_key_;
  std::vector<Field> teeth_;
  /// Pieces of all elements, and of those with kinks; scratch.
  std::vector<ForceLaw::Piece> pieces_, kink_pieces_;
  std::vector<std::unique_ptr<Regime>> regimes_;
  Regime* last_{nullptr};
  std::uint64_t halved_{0};
  // Scratch of Runge-Kutta.
  std::array<std::vector<double>, 4> rates_;
  std::vector<double> stage_, force_, u_stage_;
};

}  // namespace kerfbench::twin
