// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "twin/signal/pulse_decoder.h"

namespace kerfbench::twin {

/// Position that a PUL/DIR input commands, as its mean over each step of the integrator. A sample instead of
/// the mean would misplace a spot by a hundred micrometres (measured); the area mean is exact for any edge
/// times.
class PulseCommand {
 public:
  /// Makes a command; `step` is in the joint's unit, rad or m.
  explicit PulseCommand(double step) : step_(step) {}

  [[nodiscard]] std::vector<StepEdge>& incoming() { return edges_; }
  /// Mean over [begin, end]. Intervals follow each other; all edges before `end_s` must be known.
  double meanOver(double begin_s, double end_s);
  /// Position at the end of the last interval.
  [[nodiscard]] double position() const { return static_cast<double>(count_) * step_; }

 private:
  double step_;
  long long count_{0};
  std::vector<StepEdge> edges_;
  std::size_t next_{0};
};

}  // namespace kerfbench::twin
