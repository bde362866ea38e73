// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/job/job.h"
#include "firmware_under_test/planner/motion/speed.h"
#include "firmware_under_test/planner/motion/unit.h"

namespace kerfbench::planner {

/// Spare periods between two units: the controller takes its reference at a period's border.
inline constexpr int kSparePeriods = 2;

/// A move in W with the laser off that ends at rest; each axis takes its own least time.
class Reposition {
 public:
  /// Plans the move from p0 with speed v0 along x to p1. Speed and acceleration stay below the job's.
  Reposition(const Eigen::Vector2d& p0_W_mm, double v0_mm_s, const Eigen::Vector2d& p1_W_mm,
             const JobParameters& job, const Axes& axes);
  [[nodiscard]] int periods() const;
  [[nodiscard]] Eigen::Vector2d at(int period) const;

 private:
  AxisMove x_;
  AxisMove y_;
  double period_s_;
};

/// Timing of a job at one belt speed. Odd units differ from even ones if the job alternates.
struct Solution {
  std::vector<UnitPath> paths;  ///< Paths; one, or two if the job alternates.
  /// Layouts. Moving sheet: one for each path. Resting sheet: one for each unit.
  std::vector<UnitLayout> layouts;
  double belt_speed_mm_s{};
  [[nodiscard]] const UnitPath& pathOf(int unit) const { return paths[std::size_t(unit) % paths.size()]; }
  [[nodiscard]] const UnitLayout& layoutOf(int unit) const {
    return layouts[std::size_t(unit) % layouts.size()];
  }
};

struct SolveResult {
  std::optional<Solution> solution;
  std::string reason;  ///< Constraints that fail, if there is no solution.
};

/// Fits the path of one unit into field and pitch at a belt speed.
SolveResult solve(const std::vector<Segment>& path, const MachineParameters& machine,
                  const JobParameters& job, const Axes& axes, double belt_speed_mm_s);

/// Highest belt speed, to 0.1 %, up to which solve() has an answer at all the speeds tried; 0 if at none.
double maxBeltSpeed(const std::vector<Segment>& path, const MachineParameters& machine,
                    const JobParameters& job, const Axes& axes);

/// Speed of the sheet during the cut: none if the belt stops for it.
inline double speedWhileCutting(const JobParameters& job) {
  return job.stop_and_go ? 0.0 : job.belt_speed_mm_s;
}
/// Highest speed of the controller's feed.
double feedLimit(const MachineParameters& machine);
/// Move of the belt by one pitch, from rest to rest.
AxisMove feedOfPitch(const JobParameters& job);
int feedOfPitchPeriods(const JobParameters& job, double period_s);

/// Travel of the belt while the controller's feed speeds up.
double feedRampMm(double belt_speed_mm_s, const JobParameters& job, double period_s);
int feedRampPeriods(double belt_speed_mm_s, const JobParameters& job, double period_s);

}  // namespace kerfbench::planner
