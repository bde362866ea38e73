// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <Eigen/Core>

#include "hil/calibrate/head/model_solver.h"

namespace kerfbench::calibrate {

/// The trace with its derivatives by all departures, found backwards: the spot's two coordinates are
/// differentiated by each ray in turn, from the sheet up to the laser (reverse accumulation), and at each
/// surface by what its departures do to it, which is the same for all marks. Some 600 multiplications a mark,
/// however many departures there are.
class BackwardTrace {
 public:
  /// Departures are scaled · units; derivatives are by `scaled`.
  BackwardTrace(const HeadDesign& design, const HeadVector& units, const double* scaled);

  ~BackwardTrace();

  /// False where the beam does not land.
  bool landing(const Eigen::Vector2d& angles_rad, Eigen::Vector2d& p_W_mm, HeadJacobian& by_scaled) const;

 private:
  struct Head;
  std::unique_ptr<const Head> head_;
};

}  // namespace kerfbench::calibrate
