// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerfbench::twin {

/// Closed position loop of a drive, tuned by its bandwidth.
struct ServoDescription {
  double natural_frequency_rad_s{};     ///< wn; > 0 and below 1 / integrator step.
  double damping{0.7};                  ///< zeta; in (0, 5].
  double velocity_feedforward{};        ///< 0: pure tracking delay of 2 zeta / wn; 1: none at constant speed.
  double feedforward_filter_s{0.5e-3};  ///< Smooths the command's velocity, which arrives in steps; >= 0.
  double max_torque{1e9};               ///< N m, or N for a slide; > 0.
};

/// torque = J (wn² (command - q) + 2 zeta wn (ff * command velocity - qd)), limited.
/// Without feedforward the axis trails a constant speed by the time 2 zeta / wn.
class Servo {
 public:
  Servo(const ServoDescription& description, double inertia);

  /// To be called once for each step of the integrator, with the mean command of the step.
  double torque(double mean_command, double q, double qd, double step_s);
  /// Starts at rest at this command, or moving with it.
  void reset(double command, double velocity);

 private:
  ServoDescription description_;
  double inertia_;
  double last_command_{};
  double command_velocity_{};
};

}  // namespace kerfbench::twin
