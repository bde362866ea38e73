// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "twin/machine/part_flow.h"
#include "twin/machine/solver.h"

namespace kerfbench::twin {

/// Solver with exact propagation of the linear part of the mechanism, part by part, see PartFlow. Masses come
/// from Bullet and forces from the same ForceLaw as the reference's.
class FastSolver final : public Solver {
 public:
  /// Makes the solver. @throws std::invalid_argument if the mechanism is too fast for the step, or a part too
  /// large.
  FastSolver(std::shared_ptr<const Mechanism> mechanism, double step_s);

  /// Runs part by part, each through all steps: they have nothing to do with each other.
  void run(double begin_s, std::size_t steps, std::span<const DriveCommand> commands) override;

  [[nodiscard]] std::span<const double> q() const override { return q_; }
  [[nodiscard]] std::span<const double> v() const override { return v_; }
  /// Number of steps of all parts in which a force had a kink.
  [[nodiscard]] std::uint64_t halved() const;

 private:
  void gather(const PartFlow& flow);

  std::shared_ptr<const Mechanism> mechanism_;
  double step_s_;
  std::vector<PartFlow> parts_;
  std::vector<std::size_t> made_;  ///< Steps of the last run that each part made; scratch.
  std::vector<double> q_, v_;
};

}  // namespace kerfbench::twin
