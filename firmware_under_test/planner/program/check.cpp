// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/program/check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <fmt/format.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/order/cut_twice.h"
#include "firmware_under_test/planner/program/cross_cut.h"
#include "firmware_under_test/planner/program/job_issues.h"
#include "firmware_under_test/planner/program/program.h"
#include "firmware_under_test/planner/program/room.h"

namespace kerfbench::planner {
namespace {

/// Longest unit; bounds the memory of a plan: 4.5 million periods.
constexpr double kLongestUnitS = 3600.0;

std::string nameOf(int entity, int line) {
  std::string name = entity >= 0 ? fmt::format("E{}", entity) : std::string();
  if (line > 0) name += fmt::format("{}G-code line {}", name.empty() ? "" : ", ", line);
  return name;
}

void addLines(const std::string& text, std::vector<std::string>& lines) {
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    if (to > from) lines.push_back(text.substr(from, to - from));
    from = to + 1;
  }
}

/// Upper bound of the time, as if every move began and ended at rest.
double longestS(const std::vector<Segment>& path, const JobParameters& job, const Axes& axes) {
  const double axis_mm_s = axes.axisLimits().minCoeff();
  double sum = 0.0;
  for (const Segment& segment : path) {
    const double speed = std::min(segment.jump ? job.jump_speed_mm_s : job.mark_speed_mm_s, axis_mm_s);
    sum += segment.lengthMm() / speed + 2.0 * std::sqrt(segment.lengthMm() / job.acceleration_mm_s2);
  }
  return sum;
}

/// Run-ups that leave the field across the belt; marks are checked by outsideAcross().
std::vector<std::string> runUpFaults(const UnitPath& unit, const MachineParameters& machine) {
  double low_mm = unit.start_S_mm.y(), high_mm = low_mm;
  for (const Block& block : unit.blocks) {
    for (const Sample& sample : block.samples) {
      low_mm = std::min(low_mm, sample.p_S_mm.y());
      high_mm = std::max(high_mm, sample.p_S_mm.y());
    }
  }
  if (low_mm >= machine.field_min_mm[1] - 1e-9 && high_mm <= machine.field_max_mm[1] + 1e-9) return {};
  return {fmt::format(
      "run-ups take the beam to y {:.3f} … {:.3f} mm, the field {:g} … {:g} mm: a slower mark or a "
      "higher acceleration takes less",
      low_mm, high_mm, machine.field_min_mm[1], machine.field_max_mm[1])};
}

std::string markName(const Block& block) {
  return block.entity >= 0 ? fmt::format("E{}", block.entity) : fmt::format("G-code line {}", block.line);
}

/// Marks that the power model's laser is too weak for.
std::vector<std::string> tooWeak(const UnitPath& unit, const MachineParameters& machine,
                                 const JobParameters& job) {
  std::vector<std::string> faults;
  std::set<std::string> named;
  for (const Block& block : unit.blocks) {
    const Sample* worst = nullptr;
    PowerModel::Setting most;
    for (const Sample& sample : block.samples) {
      if (sample.marked_mm <= 0.0) continue;
      const PowerModel::Setting setting = powerSetting(sample, machine, job);
      if (setting.limit != PowerModel::Limit::kMost || setting.wanted_w <= most.wanted_w) continue;
      most = setting;
      worst = &sample;
    }
    if (worst == nullptr || !named.insert(markName(block)).second) continue;
    const double depth_mm = job.power->depthOf(worst->z, job.half_z);
    faults.push_back(fmt::format(
        "from {}: {:g} mm deep at {:.1f} mm/s needs {:.1f} W, {} gives {:g} W, enough for {:.3f} mm; mark at "
        "{:.1f} mm/s at most",
        markName(block), depth_mm, worst->marked_mm / worst->z / machine.target.periodS(), most.wanted_w,
        job.power->laser().name, most.power_w, most.depth_mm,
        std::floor(job.power->speedsFor(depth_mm).highest_mm_s * 10.0) / 10.0));
  }
  return faults;
}

}  // namespace

std::vector<std::string> outsideAcross(const std::vector<Segment>& path, const MachineParameters& machine) {
  constexpr std::size_t kMostFaults = 100;
  std::vector<std::string> faults;
  for (const Segment& segment : path) {
    if (faults.size() == kMostFaults) {
      faults.emplace_back("and more marks may lie outside the field");
      break;
    }
    double low = segment.start_mm.y();
    double high = low;
    const int parts = segment.isArc() ? 4 + static_cast<int>(std::abs(segment.sweep_rad) * 50.0) : 1;
    for (int i = 0; i <= parts; ++i) {
      const double y = segment.at(segment.lengthMm() * i / parts).y();
      low = std::min(low, y);
      high = std::max(high, y);
    }
    if (!segment.jump && (low < machine.field_min_mm[1] - 1e-6 || high > machine.field_max_mm[1] + 1e-6)) {
      faults.push_back(fmt::format("{} spans y {:.3f} … {:.3f} mm, the field {:g} … {:g} mm",
                                   nameOf(segment.entity, segment.line), low, high, machine.field_min_mm[1],
                                   machine.field_max_mm[1]));
    }
  }
  return faults;
}

std::vector<std::string> powerFaults(const UnitPath& unit, const MachineParameters& machine,
                                     const JobParameters& job) {
  if (job.power) return tooWeak(unit, machine, job);
  std::vector<std::string> faults;
  std::set<std::string> named;
  for (const Block& block : unit.blocks) {
    double most = 0.0;
    for (const Sample& sample : block.samples) most = std::max(most, powerByte(sample, machine, job));
    if (most < 255.5) continue;
    const std::string name = markName(block);
    if (!named.insert(name).second) continue;
    faults.push_back(fmt::format(
        "from {}: {:g} J/mm at {:g} mm/s needs {:.1f} W, the laser has {:g} W; mark at {:.0f} mm/s at most",
        name, job.cut_energy_j_per_mm, job.mark_speed_mm_s, most / 255.0 * machine.full_power_w,
        machine.full_power_w, std::floor(0.99 * job.mark_speed_mm_s * 255.0 / most)));
  }
  return faults;
}

std::vector<std::string> powerWarnings(const UnitPath& unit, const MachineParameters& machine,
                                       const JobParameters& job) {
  if (!job.power) return {};
  struct Slow {
    double length_mm{}, depth_mm{};
    int periods{};
  };
  std::map<double, Slow> by_z;
  for (const Block& block : unit.blocks) {
    for (const Sample& sample : block.samples) {
      if (sample.marked_mm <= 0.0) continue;
      const PowerModel::Setting setting = powerSetting(sample, machine, job);
      if (setting.limit != PowerModel::Limit::kLeast) continue;
      Slow& slow = by_z[sample.z];
      slow.length_mm += sample.marked_mm / sample.z;
      slow.depth_mm = std::max(slow.depth_mm, setting.depth_mm);
      ++slow.periods;
    }
  }
  std::vector<std::string> warnings;
  for (const auto& [z, slow] : by_z) {
    const double wanted_mm = job.power->depthOf(z, job.half_z);
    warnings.push_back(
        fmt::format("Z{:g}: below {:.1f} mm/s {} gives no less than {:g} W: {:.3f} mm of way in {} periods "
                    "get up to {:.3f} mm "
                    "deep, {:g} mm are wanted",
                    z, job.power->speedsFor(wanted_mm).lowest_mm_s, job.power->laser().name,
                    job.power->laser().least_w, slow.length_mm, slow.periods, slow.depth_mm, wanted_mm));
  }
  return warnings;
}

CheckResult checkJob(const std::string& gcode, const MachineParameters& machine, const JobParameters& job,
                     const PlannerFaults& faults) {
  CheckResult result;
  result.errors = jobIssues(machine, job);
  const bool usable = result.errors.empty();
  std::vector<Segment> path;
  try {
    path = unitOf(readGcode(gcode));
  } catch (const PlanError& error) {
    addLines(error.what(), result.errors);
    return result;
  }
  result.warnings = cutTwice(path);
  if (!usable) return result;
  const auto add = [&](std::vector<std::string> more) {
    result.errors.insert(result.errors.end(), more.begin(), more.end());
  };
  add(outsideAcross(path, machine));

  const Axes axes(machine, faults);
  const double longest_s = longestS(path, job, axes);
  if (!(longest_s <= kLongestUnitS)) {
    add({fmt::format("a unit would take up to {:.0f} s at these speeds; {:g} s may be planned", longest_s,
                     kLongestUnitS)});
    return result;
  }
  const double v = speedWhileCutting(job);
  SolveResult solved = solve(path, machine, job, axes, v);
  result.max_belt_speed_mm_s = job.stop_and_go ? feedLimit(machine) : maxBeltSpeed(path, machine, job, axes);
  const double highest = result.max_belt_speed_mm_s;
  if (v <= 0.0) {
    if (!solved.solution) addLines(solved.reason, result.errors);
  } else if (!solved.solution || v > highest) {
    std::string reason = solved.solution ? "there is a slower speed at which it does not fit" : solved.reason;
    if (const auto cut = crossCutOf(path, machine, job)) {
      for (const std::string& fault : cut->faults()) reason += fmt::format("; {}", fault);
    }
    result.errors.push_back(
        highest > 0.0
            ? fmt::format(
                  "a belt speed of {:g} mm/s is too high: {}; the highest for this job is {:.2f} mm/s", v,
                  reason, highest)
            : fmt::format("the job fits at no belt speed, so not at {:g} mm/s: {}", v, reason));
  }
  auto unit = planUnit(path, job, axes, v);
  if (!unit) unit = planUnit(path, job, axes, 0.0);  // A weak laser is too weak on a resting sheet, too.
  if (unit) {
    add(powerFaults(*unit, machine, job));
    if (job.run_up_mm != 0.0) add(runUpFaults(*unit, machine));
    const std::vector<std::string> slow = powerWarnings(*unit, machine, job);
    result.warnings.insert(result.warnings.end(), slow.begin(), slow.end());
  }
  if (solved.solution && result.errors.empty()) add(beltRangeFaults(*solved.solution, machine, job, axes));
  if (result.errors.empty()) result.solution = std::move(solved.solution);
  return result;
}

}  // namespace kerfbench::planner
