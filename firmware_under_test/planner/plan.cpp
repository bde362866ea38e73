// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/plan.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firmware_under_test/planner/axes.h"
#include "firmware_under_test/planner/cut_order.h"
#include "firmware_under_test/planner/gcode.h"
#include "firmware_under_test/planner/program.h"
#include "firmware_under_test/planner/solve.h"

namespace kerfbench::planner {
namespace {

/// Widths of the band of equals that are tried when the belt is too fast for whole outlines: a wide band
/// jumps less, a narrow one keeps closer to the order in which the pieces leave.
constexpr double kBandsMm[] = {5.0, 15.0, 30.0, 60.0};

void require(const MachineParameters& machine, const JobParameters& job) {
  const std::vector<std::string> faults = faultsOf(machine, job);
  if (!faults.empty()) throw PlanError(fmt::format("{}", fmt::join(faults, "\n")));
}

/// From the first mark to the last: the machine jumps to the start of a unit by itself.
std::vector<Segment> trimmed(std::vector<Segment> path) {
  const auto marks = [](const Segment& segment) { return !segment.jump; };
  path.erase(std::find_if(path.rbegin(), path.rend(), marks).base(), path.end());
  path.erase(path.begin(), std::find_if(path.begin(), path.end(), marks));
  return path;
}

std::string nameOf(const Segment& segment) {
  std::string name = segment.entity >= 0 ? fmt::format("E{}", segment.entity) : std::string();
  if (segment.line > 0) name += fmt::format("{}G-code line {}", name.empty() ? "" : ", ", segment.line);
  return name;
}

/// What no belt speed can mend: places across the belt.
std::vector<std::string> lastingFaults(const std::vector<Segment>& path, const MachineParameters& machine) {
  std::vector<std::string> faults;
  for (const Segment& segment : path) {
    double low = segment.start_mm.y();
    double high = low;
    const int parts = segment.isArc() ? 4 + static_cast<int>(std::abs(segment.sweep_rad) * 50.0) : 1;
    for (int i = 0; i <= parts; ++i) {
      const double y = segment.at(segment.lengthMm() * i / parts).y();
      low = std::min(low, y);
      high = std::max(high, y);
    }
    if (!segment.jump && (low < machine.field_min_mm[1] - 1e-6 || high > machine.field_max_mm[1] + 1e-6)) {
      faults.push_back(fmt::format("{} spans y {:.3f} … {:.3f} mm, the field {:g} … {:g} mm", nameOf(segment),
                                   low, high, machine.field_min_mm[1], machine.field_max_mm[1]));
    }
  }
  return faults;
}

/// Marks for which the laser is too weak at the speed they reach.
std::vector<std::string> powerFaults(const Solution& solution, const MachineParameters& machine,
                                     const JobParameters& job) {
  std::vector<std::string> faults;
  std::set<std::string> named;
  for (const Block& block : solution.paths.front().blocks) {
    double most = 0.0;
    for (const Sample& sample : block.samples)
      most = std::max(most, powerByte(sample.marked_mm, machine, job));
    if (most < 255.5) continue;
    const std::string name =
        block.entity >= 0 ? fmt::format("E{}", block.entity) : fmt::format("G-code line {}", block.line);
    if (!named.insert(name).second) continue;
    faults.push_back(fmt::format(
        "from {}: {:g} J/mm at {:g} mm/s needs {:.1f} W, the laser has {:g} W; mark at {:.0f} mm/s at most",
        name, job.cut_energy_j_per_mm, job.mark_speed_mm_s, most / 255.0 * machine.full_power_w,
        machine.full_power_w, std::floor(0.99 * job.mark_speed_mm_s * 255.0 / most)));
  }
  return faults;
}

std::vector<std::string> processNames(const hil::Dieline& dieline) {
  int last = 0;
  for (const hil::Entity& entity : dieline.entities) last = std::max(last, entity.id);
  std::vector<std::string> names(std::size_t(last) + 1, "mark");
  for (const hil::Entity& entity : dieline.entities) {
    names[std::size_t(entity.id)] = std::string(hil::processName(entity.process));
  }
  return names;
}

}  // namespace

std::vector<std::string> faultsOf(const MachineParameters& machine, const JobParameters& job) {
  std::vector<std::string> faults;
  const auto check = [&](bool holds, const std::string& what) {
    if (!holds) faults.push_back(what);
  };
  const auto positive = [&](double value, const char* name) {
    check(std::isfinite(value) && value > 0.0, fmt::format("{} must be > 0, but is {:g}", name, value));
  };
  const auto notNegative = [&](double value, const char* name) {
    check(std::isfinite(value) && value >= 0.0, fmt::format("{} must be >= 0, but is {:g}", name, value));
  };
  if (machine.head == MachineParameters::Head::kTwoMirror) {
    positive(machine.throw_mm, "throw_mm");
    notNegative(machine.mirror_spacing_mm, "mirror_spacing_mm");
    positive(machine.mirror_step_rad, "mirror_step_rad");
  } else {
    positive(machine.gantry_step_mm, "gantry_step_mm");
  }
  for (int i = 0; i < 2; ++i) {
    const double low = machine.field_min_mm[i];
    const double high = machine.field_max_mm[i];
    check(std::isfinite(low) && std::isfinite(high) && low <= 0.0 && high >= 0.0 && low < high,
          fmt::format("the field along {} must hold the resting beam at 0, but is {:g} … {:g} mm", "xy"[i],
                      low, high));
  }
  // The delay goes to the controller as a byte of 25 us ticks.
  check(machine.tracking_delay_s >= 0.0 && machine.tracking_delay_s <= 255 * 25e-6,
        fmt::format("tracking_delay_s must be in 0 … 6.375e-3, but is {:g}", machine.tracking_delay_s));
  positive(machine.full_power_w, "full_power_w");
  positive(job.mark_speed_mm_s, "mark_speed_mm_s");
  positive(job.jump_speed_mm_s, "jump_speed_mm_s");
  positive(job.acceleration_mm_s2, "acceleration_mm_s2");
  positive(job.cut_energy_j_per_mm, "cut_energy_j_per_mm");
  check(job.half_z > 0.0 && job.half_z <= 1.0,
        fmt::format("half_z must be in (0, 1], but is {:g}", job.half_z));
  positive(job.perforation_cut_mm, "perforation_cut_mm");
  positive(job.perforation_gap_mm, "perforation_gap_mm");
  notNegative(job.kerf_radius_mm, "kerf_radius_mm");
  check(job.units >= 1, fmt::format("units must be >= 1, but is {}", job.units));
  if (job.units > 1) positive(job.pitch_mm, "pitch_mm");
  notNegative(job.belt_speed_mm_s, "belt_speed_mm_s");
  if (job.feed_by_controller) {
    positive(machine.feed_step_mm, "feed_step_mm");
    positive(job.feed_acceleration_mm_s2, "feed_acceleration_mm_s2");
    check(std::isfinite(job.web_start_x_mm), "web_start_x_mm must be a number");
  }
  if (job.stop_and_go) {
    check(job.feed_by_controller, "stop_and_go needs feed_by_controller");
    positive(job.belt_speed_mm_s, "belt_speed_mm_s");
    check(!(job.belt_speed_mm_s > feedLimit(machine)),
          fmt::format("a feed of {:g} mm/s is too fast: the feed makes no more than {:.1f} mm/s",
                      job.belt_speed_mm_s, feedLimit(machine)));
  }
  if (job.belt_speed_mm_s > 0.0) {
    positive(machine.encoder_count_mm, "encoder_count_mm");
    check(std::isfinite(machine.print_mark_sensor_x_mm), "print_mark_sensor_x_mm must be a number");
    check(std::isfinite(job.eye_mark_x_mm), "eye_mark_x_mm must be a number");
    // The follow gain is an i16 of steps per count times 4096.
    const bool gantry = machine.head == MachineParameters::Head::kGantry;
    const double per_mm =
        gantry ? 1.0 / machine.gantry_step_mm
               : 0.5 / (machine.throw_mm + machine.mirror_spacing_mm) / machine.mirror_step_rad;
    check(!(per_mm * machine.encoder_count_mm * 4096.0 > 32767.0),
          fmt::format("an encoder count of {:g} mm is {:.2f} steps; the controller follows no more than 7.99",
                      machine.encoder_count_mm, per_mm * machine.encoder_count_mm));
  }
  return faults;
}

std::string makeGcode(const hil::Dieline& dieline, const MachineParameters& machine, const JobParameters& job,
                      const PlannerFaults& faults) {
  require(machine, job);
  const auto write = [&](const OrderOptions& options) {
    return writeGcode(cutOrder(dieline, job, faults, options), processNames(dieline));
  };
  const std::string whole = write(OrderOptions{});
  if (whole.empty()) throw PlanError("the dieline holds nothing to cut");
  if (speedWhileCutting(job) <= 0.0) return whole;
  const Axes axes(machine, faults);
  const auto highest = [&](const std::string& gcode) {
    return maxBeltSpeed(trimmed(readGcode(gcode)), machine, job, axes);
  };
  double best_speed = highest(whole);
  std::string best = whole;
  for (const bool place_before_process : {false, true}) {
    for (const double band_mm : kBandsMm) {
      if (best_speed >= job.belt_speed_mm_s) return best;
      const std::string broken = write({true, place_before_process, band_mm});
      const double speed = highest(broken);
      if (speed <= best_speed) continue;
      best = broken;
      best_speed = speed;
    }
  }
  return best;
}

Plan planFromGcode(const std::string& gcode, const MachineParameters& machine, const JobParameters& job,
                   const PlannerFaults& faults) {
  require(machine, job);
  const std::vector<Segment> path = trimmed(readGcode(gcode));
  std::vector<std::string> wrong = lastingFaults(path, machine);
  if (!wrong.empty()) throw PlanError(fmt::format("{}", fmt::join(wrong, "\n")));

  const Axes axes(machine, faults);
  Plan plan;
  plan.gcode = gcode;
  const double v = speedWhileCutting(job);
  plan.max_belt_speed_mm_s = job.stop_and_go ? feedLimit(machine) : maxBeltSpeed(path, machine, job, axes);
  const SolveResult result = solve(path, machine, job, axes, v);
  if (!result.solution || (v > 0.0 && v > plan.max_belt_speed_mm_s)) {
    if (v <= 0.0) throw PlanError(result.reason);
    const std::string reason =
        result.solution ? "there is a slower speed at which it does not fit" : result.reason;
    if (plan.max_belt_speed_mm_s <= 0.0) {
      throw PlanError(fmt::format("the job fits at no belt speed, so not at {:g} mm/s: {}", v, reason));
    }
    throw PlanError(
        fmt::format("a belt speed of {:g} mm/s is too high: {}; the highest for this job is {:.2f} mm/s", v,
                    reason, plan.max_belt_speed_mm_s));
  }
  const Solution& solution = *result.solution;
  wrong = powerFaults(solution, machine, job);
  if (!wrong.empty()) throw PlanError(fmt::format("{}", fmt::join(wrong, "\n")));

  const UnitLayout& layout = solution.layoutOf(0);
  const UnitLayout& next = solution.layoutOf(job.units > 1 ? 1 : 0);
  plan.unit_time_s = (layout.catch_up_periods + layout.sheet_periods) * kPeriodS;
  int way_back = Reposition(layout.end_W_mm, v, next.park_W_mm, job, axes).periods();
  if (job.stop_and_go) way_back = std::max(way_back, feedOfPitchPeriods(job));
  plan.cycle_time_s = plan.unit_time_s + way_back * kPeriodS;
  plan.x_ref_mm = layout.x_ref_mm;
  for (const Segment& segment : path) {
    (segment.jump || segment.z == 0.0 ? plan.jump_length_mm : plan.cut_length_mm) += segment.lengthMm();
  }
  plan.program = makeProgram(solution, machine, job, faults, axes);
  return plan;
}

Plan plan(const hil::Dieline& dieline, const MachineParameters& machine, const JobParameters& job,
          const PlannerFaults& faults) {
  return planFromGcode(makeGcode(dieline, machine, job, faults), machine, job, faults);
}

}  // namespace kerfbench::planner
