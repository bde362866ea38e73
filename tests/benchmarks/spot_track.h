// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "tests/benchmarks/recorded_run.h"
#include "twin/cutter/machine_mechanism.h"
#include "twin/signal/pulse_decoder.h"

namespace kerfbench::benchmarks {

/// First milliseconds of a two-mirror machine's marks, as steps of its drives, with t = 0 just before the
/// first of them.
struct Stretch {
  twin::MachineDescription machine;
  twin::WebDescription web;
  std::vector<twin::StepEdge> steps[twin::kAxisCount];
  double length_s{};
};
Stretch stretchOf(const RecordedRun& run, double length_s);

/// Spot in W every 10 us.
using SpotTrack = std::vector<Eigen::Vector2d>;

/// Track by Runge-Kutta from pulse to pulse, 1 us at most: nothing is averaged.
SpotTrack exactTrack(const Stretch& stretch);
SpotTrack twinTrack(const Stretch& stretch, twin::Fidelity fidelity);
/// Track by stepSimulation with the command's mean over each step. 10 us must be a multiple of `step_s`.
SpotTrack bulletTrack(const Stretch& stretch, double step_s);

/// Largest distance, mm.
double largestError_mm(const SpotTrack& track, const SpotTrack& truth);

/// A Bullet world and its commands, ready to be stepped.
class BulletMachine {
 public:
  BulletMachine(const Stretch& stretch, double step_s);
  ~BulletMachine();
  void step();
  [[nodiscard]] Eigen::Vector2d spot_mm() const;
  [[nodiscard]] std::size_t joints() const;
  [[nodiscard]] double time_s() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace kerfbench::benchmarks
