// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace kerfbench::twin {

/// Elements that act between the joints, in numbers ready for use. A state is one array
///
///     x = [q of n joints | v of n joints | m auxiliary states]
///
/// and the elements hold indices into it. Each force is continuous in the state, and affine in it within a
/// piece: which flank of a play touches, whether a friction holds or slides (and which way), which limit of a
/// servo is reached. Piece 0 is the middle one. Only a stepper's field and a friction of two directions that
/// slides are not affine.

/// Spring and damper with play on the stretch s = ratio_a q_a + ratio_b q_b + rest. With play, a flank that
/// is pressed in by d gives clamp(k d + c d', 0, 2 k d): it never pulls, and the damper does not jerk when
/// the flanks meet. Pieces: 0 between the flanks, ±1 at one of them, ±2 while the upper limit holds.
struct SpringLaw {
  std::size_t a{}, b{};
  double ratio_a{}, ratio_b{};
  double stiffness{}, damping{};
  double half_play{};
  double rest{};
};

/// Spring and damper in series with a slider: the force is k z + c v, never more than the dry limit; the
/// motion that the slider does not take is the bristle's: z' = (force - k z) / c. It holds without creep,
/// breaks loose at exactly the limit and slides with exactly the limit. With `across` the two directions
/// share one limit.
struct FrictionLaw {
  std::size_t joint{};
  std::size_t across{};
  std::size_t bristle{};  ///< Index of auxiliary state z; that of `across` is the next.
  bool plane{};           ///< True if the friction acts along `across` as well.
  double limit{};         ///< Dry limit; 0: viscous only, without a bristle.
  double stiffness{}, damping{};
  double viscous{};
};

/// Closed position loop of a servo drive, see ServoDescription.
struct ServoLaw {
  std::size_t joint{};
  std::size_t input{};
  double offset{};            ///< Offset of the command, from the start.
  double speed_per_error{};   ///< wn / (2 zeta)
  double torque_per_speed{};  ///< J 2 zeta wn
  double max_speed{}, max_torque{};
  bool limited{};  ///< True if one of the limits is finite.
  double feedforward{};
  double filter_s{};  ///< Time constant of the feedforward's filter: auxiliary state z' = (u - z) / filter_s.
  std::size_t filter{};
  double lag_s{};  ///< Lag of the current loop; > 0: an auxiliary state is the torque.
  std::size_t current{};
};

/// Field of a stepper, see StepperDescription.
struct StepperLaw {
  std::size_t joint{};
  std::size_t input{};
  double offset{};
  double holding{};
  double teeth{};
  double damping{};
  double detent{};
  bool supply_limited{};
  double supply_v{}, volt_per_speed{}, resistance{}, reactance_per_speed{}, current{};

  [[nodiscard]] double pitch() const;  ///< Pitch of a tooth, rad.
  /// Torque of the field, detent included, damping not.
  [[nodiscard]] double fieldTorque(double q, double v, double u) const;
  /// Linear part of the field's torque about tooth 0: a spring of holding * teeth.
  [[nodiscard]] double springTorque(double q, double u) const { return -holding * teeth * (q - u - offset); }
};

struct ConstantForce {
  std::size_t joint{};
  double force{};
};

class ForceLaw {
 public:
  std::size_t joints{};
  std::size_t auxiliaries{};
  std::size_t inputs{};
  std::vector<SpringLaw> springs;
  std::vector<FrictionLaw> frictions;
  std::vector<ServoLaw> servos;
  std::vector<StepperLaw> steppers;
  std::vector<ConstantForce> constants;

  using Piece = std::int8_t;  ///< Piece of an element: -1, 0 or +1; of a play -2 … +2.

  [[nodiscard]] std::size_t stateSize() const { return 2 * joints + auxiliaries; }
  [[nodiscard]] std::size_t pieceCount() const {
    return springs.size() + frictions.size() + 2 * servos.size();
  }

  /// Computes forces on the joints and rates of the auxiliary states from state and commands.
  void evaluate(const double* x, const double* u, double* force, double* rate) const;
  /// Finds the piece that each element is in.
  void observe(const double* x, const double* u, Piece* pieces) const;
  /// True if each element is in its piece of these.
  [[nodiscard]] bool isIn(const double* x, const double* u, const Piece* pieces) const;
  /// Computes as evaluate(), but in these pieces whatever the state is, and with the springs of the steppers
  /// in place of their fields: affine in x and u. Not for pieces where isAffine() is false.
  void evaluateAffine(const double* x, const double* u, const Piece* pieces, double* force,
                      double* rate) const;
  [[nodiscard]] bool isAffine(const Piece* pieces) const;

 private:
  /// Calls each(piece) for one element after the other, until it returns false.
  template <typename Each>
  void forEachPiece(const double* x, const double* u, const Each& each) const;
};

}  // namespace kerfbench::twin
