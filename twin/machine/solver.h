// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "twin/machine/mechanism.h"

namespace kerfbench::twin {

/// Moves a mechanism from step to step.
class Solver {
 public:
  virtual ~Solver() = default;

  /// Makes one step from `begin_s`; one command for each drive, in the description's order.
  /// @throws DivergenceError with the step's end and the joint whose numbers are out of bounds.
  virtual void step(double begin_s, std::span<const DriveCommand> commands) = 0;

  /// Joint positions and velocities at the end of the last step, rad or m and per second.
  [[nodiscard]] virtual std::span<const double> q() const = 0;
  [[nodiscard]] virtual std::span<const double> v() const = 0;
};

/// Checks a state. @throws DivergenceError for the first joint whose speed is beyond its bound, or whose
/// state is not finite.
void requireSane(const Mechanism& mechanism, std::span<const double> q, std::span<const double> v,
                 double time_s);

}  // namespace kerfbench::twin
