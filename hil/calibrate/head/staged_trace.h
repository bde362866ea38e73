// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <Eigen/Core>

#include "hil/calibrate/head/model_solver.h"

namespace kerfbench::hil {

/// The trace with its derivatives by all departures, in three stages: each is differentiated by its own few
/// departures and the ray that enters it, and the chain rule joins them. A third of the work of carrying 32
/// derivatives through.
class StagedTrace {
 public:
  /// Departures are scaled · units; derivatives are by `scaled`.
  StagedTrace(const HeadDesign& design, const HeadVector& units, const double* scaled);

  ~StagedTrace();

  /// False where the beam does not land.
  bool landing(const Eigen::Vector2d& angles_rad, Eigen::Vector2d& p_W_mm, HeadJacobian& by_scaled) const;

 private:
  struct Stages;
  std::unique_ptr<const Stages> stages_;
};

}  // namespace kerfbench::hil
