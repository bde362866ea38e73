// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerfbench::twin {

/// Method of solving the machine's equations of motion.
enum class Fidelity {
  kReference,  ///< Bullet's articulated bodies, fourth-order Runge-Kutta, 10 us.
  kFast,       ///< Exact propagation of the linear part, taken from the same Bullet model.
};

/// Lost steps of a stepper: the load pulled its rotor over to another tooth.
struct LostSteps {
  std::string axis;  ///< Name of the axis, e.g. "galvo_x".
  double time_s{};   ///< Time at which the lag passed half a tooth.
  double place{};    ///< Commanded position at that time, rad or mm of the load.
  /// Number of lost full steps; > 0: the rotor stayed behind in the direction of +; multiples of 4.
  long long full_steps{};
};

}  // namespace kerfbench::twin
