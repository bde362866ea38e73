// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerfbench::twin {

struct LaserDescription {
  double full_power_w{100.0};  ///< At duty 1; > 0.
  double rise_time_s{20e-6};   ///< Time constant of the tube's first-order response; >= 0.
  double gate_delay_s{0.0};  ///< From the pins to the tube's demand; >= 0. Applied by whoever reads the pins.
};

/// A CO2 tube: gate and PWM in, power out.
class Laser {
 public:
  explicit Laser(const LaserDescription& description) : description_(description) {}
  /// `demand`: mean over the step of gate and PWM both high, 0…1. Returns the energy emitted in the step, J.
  double step(double demand, double step_s);
  [[nodiscard]] double power_w() const { return power_w_; }  ///< At the end of the last step.

 private:
  LaserDescription description_;
  double power_w_{0.0};
};

}  // namespace kerfbench::twin
