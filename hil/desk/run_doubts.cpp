// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/run_doubts.h"

#include <algorithm>

#include <fmt/format.h>

namespace kerfbench::desk {
namespace {

/// Share of the asked speed below which the axes are said to be too slow for it.
constexpr double kSlowShare = 0.5;
/// Grey values below which the glowing spot is hardly seen. A label on two-mirror-300 with the release for
/// 25 us ticks has 5 and is INVALID (spot_seen), with the one for 1 us ticks 22 and is seen in each frame.
constexpr double kFaint_gray = 10.0;

/// The median of the power that is set while the laser is on, W; 0: it never is.
double usualPower_w(const planner::UnitMotion& motion, double full_power_w) {
  std::vector<int> bytes;
  for (const planner::UnitPeriod& period : motion.periods)
    if (period.power.value_or(0) > 0) bytes.push_back(*period.power);
  if (bytes.empty()) return 0.0;
  const auto middle = bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2);
  std::ranges::nth_element(bytes, middle);
  return *middle / 255.0 * full_power_w;
}

}  // namespace

std::vector<std::string> runDoubts(const scenario::Case& test_case, const planner::MachineParameters& machine,
                                   const planner::JobParameters& job, const planner::UnitMotion& motion,
                                   const planner::Axes& axes) {
  std::vector<std::string> doubts;
  const double axis_mm_s = axes.axisLimits().minCoeff();
  if (axis_mm_s < kSlowShare * job.mark_speed_mm_s) {
    doubts.push_back(fmt::format(
        "the release makes at most {} steps of an axis in {:g} ms, which on this machine is {:.0f} "
        "mm/s of the {:g} mm/s that are asked: choose a release with quicker steps "
        "(controller-native-galvo for digital galvos), or ask for less",
        machine.target.max_steps, 1e3 * machine.target.periodS(), axis_mm_s, job.mark_speed_mm_s));
  }
  const double power_w = usualPower_w(motion, machine.full_power_w);
  const double gray = test_case.machine.glow_gray_per_w * power_w;
  if (power_w > 0.0 && gray < kFaint_gray && !test_case.scenario.firmware.onRealPins()) {
    doubts.push_back(fmt::format(
        "at the usual {:.1f} W of {:g} W the spot glows by about {:.0f} of 255 grey values in the spot "
        "camera: "
        "a run will hardly see it and may be INVALID (spot_seen); mark faster, since power grows with speed, "
        "or choose a machine with a weaker laser",
        power_w, machine.full_power_w, gray));
  }
  return doubts;
}

}  // namespace kerfbench::desk
