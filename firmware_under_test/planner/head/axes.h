// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "firmware_under_test/planner/job/job.h"

namespace kerfbench::planner {

/// Converts beam positions in W to axis steps: the planner's own inverse of the head, its correction table
/// included.
class Axes {
 public:
  Axes(const MachineParameters& machine, const PlannerFaults& faults);

  /// Axis positions in steps, not rounded, for the beam at p_W.
  [[nodiscard]] Eigen::Vector2d stepsAt(const Eigen::Vector2d& p_W_mm) const;
  /// Beam position at power-on, with all axes at step zero: W's origin, or with a correction table the place
  /// that needs no steps. @throws PlanError if there is none.
  [[nodiscard]] Eigen::Vector2d wakesAt() const;
  /// Place of the beam at these steps, to a thousandth of a step, looked for from a place near it.
  /// @throws PlanError if the correction table has none.
  [[nodiscard]] Eigen::Vector2d placeAt(const Eigen::Vector2d& steps,
                                        const Eigen::Vector2d& near_W_mm = Eigen::Vector2d::Zero()) const;
  /// The same to 1e-10 mm of the head's formula, and to 1e-9 mm with a correction table.
  /// @throws PlanError as above.
  [[nodiscard]] Eigen::Vector2d exactPlaceAt(const Eigen::Vector2d& steps,
                                             const Eigen::Vector2d& near_W_mm) const;
  /// Derivative d(x steps)/d(x_W) at p_W, 1/mm.
  [[nodiscard]] double xStepsPerMm(const Eigen::Vector2d& p_W_mm) const;
  /// Highest path speed on the sheet along a unit vector at which no axis exceeds its step budget while the
  /// sheet moves along +x; the same everywhere in the field. 0 if the belt alone is too fast.
  [[nodiscard]] double speedLimit(const Eigen::Vector2d& direction, double belt_speed_mm_s) const;
  /// Jacobian d(steps)/d(p_W), 1/mm; row 0 is the x axis.
  [[nodiscard]] Eigen::Matrix2d stepsPerMm(const Eigen::Vector2d& p_W_mm) const;
  /// Accelerations on the sheet along x and y that together keep each mirror within its limit, whatever the
  /// place in the field, while beam and sheet together move at up to `speed_mm_s`: the limit less the share
  /// of the head's own distortion at that speed, and for x less the share of y. Falls with speed, and may be
  /// negative: too fast. 1e12 without a limit.
  [[nodiscard]] Eigen::Vector2d accelerationBox(double speed_mm_s) const;
  /// Highest speed of the x axis, mm/s in W, and of the y axis.
  [[nodiscard]] Eigen::Vector2d axisLimits() const;
  /// Reach of the beam in W.
  [[nodiscard]] Eigen::Vector2d fieldMinMm() const {
    return {machine_.field_min_mm[0], machine_.field_min_mm[1]};
  }
  [[nodiscard]] Eigen::Vector2d fieldMaxMm() const {
    return {machine_.field_max_mm[0], machine_.field_max_mm[1]};
  }
  /// Number of the x axis in the protocol; y is the next.
  [[nodiscard]] int firstAxis() const;
  [[nodiscard]] const PlannerFaults& faults() const { return faults_; }
  [[nodiscard]] const Target& target() const { return machine_.target; }
  [[nodiscard]] const PulseSettings& pulses() const { return pulses_; }
  [[nodiscard]] double periodS() const { return machine_.target.periodS(); }
  /// Delay of the drives behind their pulses.
  [[nodiscard]] double trackingDelayS() const { return machine_.tracking_delay_s; }

 private:
  /// Steps of the head alone.
  [[nodiscard]] Eigen::Vector2d formulaAt(const Eigen::Vector2d& p_W_mm) const;
  [[nodiscard]] Eigen::Matrix2d formulaSlopes(const Eigen::Vector2d& p_W_mm) const;
  [[nodiscard]] const CorrectionTable* correction() const;
  void boundSlopesBySampling();

  /// Budget of steps for x and y, per second.
  [[nodiscard]] Eigen::Vector2d budgetPerS() const;

  MachineParameters machine_;
  PulseSettings pulses_;
  PlannerFaults faults_;
  double x_per_mm_{};    ///< Largest |d(x steps)/dx| in the field.
  double x_per_y_mm_{};  ///< Largest |d(x steps)/dy|.
  double y_per_mm_{};
  double y_per_x_mm_{};  ///< Largest |d(y steps)/dx|; zero without a table.
  /// Derivatives of the x steps along x and y, per mm, over the field.
  std::vector<Eigen::Vector2d> x_rates_;
  /// Largest second derivative of steps in the field.
  Eigen::Vector2d bend_per_mm2_{Eigen::Vector2d::Zero()};
};

}  // namespace kerfbench::planner
