// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "twin/machine/mechanism.h"

namespace kerfbench::twin {

/// Moves a mechanism from step to step.
class Solver {
 public:
  virtual ~Solver() = default;

  /// Makes `steps` steps from `begin_s`. `commands`: one for each drive, in the description's order, for the
  /// first step, then for the second, …
  /// @throws DivergenceError with a step's end and the joint whose numbers are out of bounds.
  virtual void run(double begin_s, std::size_t steps, std::span<const DriveCommand> commands) = 0;
  /// Makes one step.
  void step(double begin_s, std::span<const DriveCommand> commands) { run(begin_s, 1, commands); }

  /// Joint positions and velocities at the end of the last step, rad or m and per second.
  [[nodiscard]] virtual std::span<const double> q() const = 0;
  [[nodiscard]] virtual std::span<const double> v() const = 0;
};

/// Checks a state. @throws DivergenceError for the first joint whose speed is beyond its bound, or whose
/// state is not finite.
void requireSane(const Mechanism& mechanism, std::span<const double> q, std::span<const double> v,
                 double time_s);

}  // namespace kerfbench::twin
