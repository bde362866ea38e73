// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerfbench::twin {

/// How the machine's equations of motion are solved.
enum class Fidelity {
  kReference,  ///< Bullet's articulated bodies, fourth-order Runge-Kutta, 10 us.
  kFast,       ///< Exact propagation of the linear part, taken from the same Bullet model.
};

/// A stepper has let go: the load pulled its rotor over to another tooth.
struct LostSteps {
  std::string axis;        ///< E.g. "galvo_x".
  double time_s{};         ///< When the lag passed half a tooth.
  double place{};          ///< Commanded position then, rad or mm of the load.
  long long full_steps{};  ///< > 0: the rotor stayed behind in the direction of +; multiples of 4.
};

}  // namespace kerfbench::twin
