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
/// is pressed in by d gives clamp(k d + c d', 0, 2 k d): it never pulls, and the damper doesn't hit out when
/// they meet. Pieces: 0 between the flanks, ±1 at one of them, ±2 while the upper limit holds.
struct SpringLaw {
  std::size_t a{}, b{};
  double ratio_a{}, ratio_b{};
  double stiffness{}, damping{};
  double half_play{};
  double rest{};
};

/// Spring and damper in series with a slider: the force is k z + c v, never more than the dry limit, and
/// what the slider doesn't give is the bristle's: z' = (force - k z) / c. It holds without creep, breaks
/// loose at exactly the limit and slides with exactly the limit. With `across` the two directions share one
/// limit.
struct FrictionLaw {
  std::size_t joint{};
  std::size_t across{};
  std::size_t bristle{};  ///< Auxiliary state z; that of `across` is the next.
  bool plane{};           ///< With `across`.
  double limit{};         ///< 0: viscous only, without a bristle.
  double stiffness{}, damping{};
  double viscous{};
};

/// See ServoDescription.
struct ServoLaw {
  std::size_t joint{};
  std::size_t input{};
  double offset{};            ///< Offset of the command, from the start.
  double speed_per_error{};   ///< wn / (2 zeta)
  double torque_per_speed{};  ///< J 2 zeta wn
  double max_speed{}, max_torque{};
  bool limited{};  ///< One of them is finite.
  double feedforward{};
  double filter_s{};  ///< With feedforward: auxiliary state z' = (u - z) / filter.
  std::size_t filter{};
  double lag_s{};  ///< > 0: auxiliary state is the torque.
  std::size_t current{};
};

/// See StepperDescription.
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
  /// The field's torque, detent included, damping not.
  [[nodiscard]] double fieldTorque(double q, double v, double u) const;
  /// Its linear part about tooth 0: a spring of holding * teeth.
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

  using Piece = std::int8_t;  ///< -1, 0 or +1; of a play -2 … +2.

  [[nodiscard]] std::size_t stateSize() const { return 2 * joints + auxiliaries; }
  [[nodiscard]] std::size_t pieceCount() const {
    return springs.size() + frictions.size() + 2 * servos.size();
  }

  /// Forces on the joints and rates of the auxiliary states, from state and commands.
  void evaluate(const double* x, const double* u, double* force, double* rate) const;
  /// In which piece each element is.
  void observe(const double* x, const double* u, Piece* pieces) const;
  /// As evaluate(), but in these pieces whatever the state is, and with the springs of the steppers for their
  /// fields: affine in x and u. Not for pieces where isAffine() is false.
  void evaluateAffine(const double* x, const double* u, const Piece* pieces, double* force,
                      double* rate) const;
  [[nodiscard]] bool isAffine(const Piece* pieces) const;
};

}  // namespace kerfbench::twin
