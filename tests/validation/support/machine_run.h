// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "tests/validation/support/motion.h"
#include "twin/cutter/machine_model.h"

namespace kerfbench::validation {

/// Spot of a machine while pulses command a motion.
struct MachineRun {
  std::vector<double> time_s;            ///< Time of each step's end, from the motion's begin.
  std::vector<Eigen::Vector2d> spot_mm;  ///< NaN where the beam misses the board.
  std::vector<twin::LostSteps> lost;     ///< Lost steps, with times from the motion's begin.
};

/// Runs mirrors or gantry through `motion` and `tail_s` longer. Mirrors get the pulses of S4's formula on the
/// nominal head. Before, they go slowly to the motion's start and come to rest.
MachineRun runMachine(const twin::MachineDescription& machine, const twin::WebDescription& web,
                      const Motion& motion, double tail_s, twin::Fidelity fidelity);

/// A web at rest without print.
twin::WebDescription restingWeb();

}  // namespace kerfbench::validation
