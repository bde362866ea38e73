// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "twin/machine/mechanism.h"

namespace kerfbench::benchmarks {

/// A mechanism without the twin's solvers: the same bodies and joints in a btMultiBodyDynamicsWorld, the same
/// forces applied before each stepSimulation. First order in the step, whatever is done outside. Bullet's
/// defaults that would falsify a machine (damping, velocity clamp, sleep) are off.
class BulletWorld {
 public:
  explicit BulletWorld(std::shared_ptr<const twin::Mechanism> mechanism);
  ~BulletWorld();
  BulletWorld(const BulletWorld&) = delete;
  BulletWorld& operator=(const BulletWorld&) = delete;

  /// Makes one step; one command for each drive, constant over the step.
  void step(double step_s, std::span<const double> commands);
  [[nodiscard]] std::span<const double> q() const { return {state_.data(), joints_}; }

 private:
  struct World;
  std::shared_ptr<const twin::Mechanism> mechanism_;
  std::unique_ptr<World> world_;
  std::size_t joints_;
  std::vector<double> state_;  ///< State as in twin::ForceLaw.
  std::vector<double> force_, rate_;
};

}  // namespace kerfbench::benchmarks
