// SPDX-License-Identifier: Apache-2.0
#include "twin/drive/servo.h"

#include <algorithm>
#include <cmath>

namespace kerfbench::twin {

Servo::Servo(const ServoDescription& description, double inertia)
    : description_(description), inertia_(inertia) {}

void Servo::reset(double command, double velocity) {
  last_command_ = command;
  command_velocity_ = velocity;
}

double Servo::torque(double mean_command, double q, double qd, double step_s) {
  const double raw_velocity = (mean_command - last_command_) / step_s;
  last_command_ = mean_command;
  const double share = description_.feedforward_filter_s > 0
                           ? 1.0 - std::exp(-step_s / description_.feedforward_filter_s)
                           : 1.0;
  command_velocity_ += share * (raw_velocity - command_velocity_);
  const double wn = description_.natural_frequency_rad_s;
  const double wanted = inertia_ * (wn * wn * (mean_command - q) +
                                    2.0 * description_.damping * wn *
                                        (description_.velocity_feedforward * command_velocity_ - qd));
  return std::clamp(wanted, -description_.max_torque, description_.max_torque);
}

}  // namespace kerfbench::twin
