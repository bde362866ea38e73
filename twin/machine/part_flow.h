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
  [[nodiscard]] const double* q() const { return state_; }
  [[nodiscard]] const double* v() const { return state_ + part_.law.joints; }

  /// Makes steps, each with the next `drives` commands: those of the whole mechanism. Returns how many; fewer
  /// than `steps` if the one after them diverges, see requireSane(): it is the last that was made.
  std::size_t run(std::size_t steps, std::span<const DriveCommand> commands, std::size_t drives);

  /// Number of steps so far that were halved: each costs as much as a dozen others.
  [[nodiscard]] std::uint64_t halved() const { return halved_; }

 private:
  static constexpr double kNowhere = -1.0;
  struct Field {
    double pitch{};
    long long tooth{};  ///< Tooth about which the linear spring acts.
  };
  /// Pieces of the elements with kinks, in which the part is linear.
  struct Regime {
    std::vector<ForceLaw::Piece> pieces;
    bool affine{};
    /// Flows by halvings of the step; made when needed.
    std::array<std::unique_ptr<LinearFlow>, kHalvings + 1> flows;
  };
  /// Share of a step that is advanced at once.
  struct Stretch {
    double from{};
    int halvings{};
    [[nodiscard]] double share() const { return 1.0 / static_cast<double>(1U << halvings); }
    [[nodiscard]] bool holds(double place) const { return place >= from && place < from + share(); }
  };

  void findKinks();
  /// Finds the regime of a state.
  Regime& regimeAt(const double* x, const double* u);
  /// True if a state is in the present regime.
  [[nodiscard]] bool staysAt(const double* x, const double* u) const;
  /// Makes a flow of the present regime; nullptr where the part is not affine.
  const LinearFlow* newFlow(int halvings);
  void setPieces(const Regime& regime);
  [[nodiscard]] std::unique_ptr<LinearFlow> makeFlow(double step_s) const;
  /// Commands at a share of the present step.
  void commandsAt(double share, std::vector<double>& u) const;
  void step(const DriveCommand* commands);
  [[nodiscard]] bool sane() const;
  /// Advances over a stretch at once; false if there is a kink in it and it can be halved.
  bool cross(const Stretch& stretch);
  /// Advances over a stretch by its halves. One that holds the aim, where a kink is expected, is halved
  /// without a trial; the aim may be wrong, or kNowhere.
  void crossInHalves(const Stretch& stretch, double aim);
  /// Place of the kink in the step from state_ to next_, by interpolation: the middle of a shortest stretch.
  [[nodiscard]] double kinkPlace();
  /// Sets next_ to the state at the end of the stretch; false if that needs a shorter one.
  bool propagate(const Stretch& stretch);
  [[nodiscard]] double* inputs() { return state_ + states_ + 1; }
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
  double* state_;
  double* next_;
  std::vector<double> memory_;             ///< Memory of the two.
  const DriveCommand* commands_{nullptr};  ///< Commands of the present step.
  std::vector<double> u_begin_, u_end_;    ///< Inputs at both ends of the stretch.
  std::vector<Field> teeth_;
  /// Pieces of all elements, and of those with kinks; scratch.
  std::vector<ForceLaw::Piece> pieces_, kink_pieces_;
  std::vector<std::unique_ptr<Regime>> regimes_;
  Regime* regime_{nullptr};  ///< Regime of the state with commands u_end_.
  std::uint64_t halved_{0};
  // Scratch of Runge-Kutta.
  std::array<std::vector<double>, 4> rates_;
  std::vector<double> stage_, force_, u_stage_;
};

}  // namespace kerfbench::twin
