// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/plan.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "firmware_under_test/controller/protocol.h"
#include "firmware_under_test/planner/axes.h"
#include "firmware_under_test/planner/check.h"
#include "firmware_under_test/planner/correction.h"
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

/// Of a correction table; a fifth of what a cut may be off.
constexpr double kCoarsestMm = 0.01;
/// Orders that are shorter must fit at this share of the belt speed as well.
constexpr double kSpareSpeed = 1.1;
/// Whether an order fits takes a plan of the whole unit.
constexpr int kMostQuestions = 300;

/// Drawings that no sheet can hold, or of which there is too much to be put in order.
void requireSane(const hil::Dieline& dieline) {
  constexpr std::size_t kMostEntities = 20'000;
  constexpr double kFarthestMm = 1e5;
  std::string faults;
  int count = 0;
  if (dieline.entities.size() > kMostEntities)
    throw PlanError(fmt::format("the drawing holds {} entities; {} can be put in order",
                                dieline.entities.size(), kMostEntities));
  for (const hil::Entity& entity : dieline.entities) {
    if (entity.process == hil::Process::kIgnore) continue;
    double farthest = 0.0;
    bool finite = true;
    for (int i = 0; i <= 16; ++i) {
      const Eigen::Vector2d p = hil::pointAt(entity.curve, i / 16.0);
      finite = finite && p.allFinite();
      farthest = std::max(farthest, p.cwiseAbs().maxCoeff());
    }
    if (finite && farthest <= kFarthestMm) continue;
    if (++count > 20) continue;
    faults += fmt::format("{}E{}{}: reaches {} mm, out of all bounds", faults.empty() ? "" : "\n", entity.id,
                          entity.origin.empty() ? "" : " (" + entity.origin + ")",
                          finite ? fmt::format("{:g}", farthest) : "no number of");
  }
  if (count > 20) faults += fmt::format("\nand {} more", count - 20);
  if (!faults.empty()) throw PlanError(faults);
}

const std::string& needed(const std::string& gcode) {
  if (gcode.empty()) throw PlanError("the dieline holds nothing to cut");
  return gcode;
}

std::vector<Segment> withJumps(const std::vector<std::vector<Segment>>& pieces) {
  std::vector<Segment> path;
  for (const std::vector<Segment>& piece : pieces) {
    for (const Segment& segment : piece) {
      if (!path.empty() && (segment.start_mm - path.back().end_mm).norm() > kJoinMm) {
        Segment jump;
        jump.jump = true;
        jump.start_mm = path.back().end_mm;
        jump.end_mm = segment.start_mm;
        path.push_back(jump);
      }
      path.push_back(segment);
    }
  }
  return path;
}

/// The table against head and field.
std::vector<std::string> correctionFaults(const MachineParameters& machine) {
  const CorrectionTable& table = *machine.correction;
  const Eigen::AlignedBox2d area = table.area_mm();
  const Eigen::Vector2d low(machine.field_min_mm[0], machine.field_min_mm[1]);
  const Eigen::Vector2d high(machine.field_max_mm[0], machine.field_max_mm[1]);
  std::vector<std::string> faults;
  if (!area.contains(low) || !area.contains(high)) {
    faults.push_back(fmt::format(
        "{}: covers x {:g} … {:g}, y {:g} … {:g} mm; the field is x {:g} … {:g}, y {:g} … {:g} mm",
        table.name(), area.min().x(), area.max().x(), area.min().y(), area.max().y(), low.x(), high.x(),
        low.y(), high.y()));
  }
  const Axes axes(machine, {});
  const CorrectionTable::Coarseness coarse = table.coarseness();
  const double unit_mm = table.unit() == CorrectionTable::Unit::kMm
                             ? 1.0
                             : 1.0 / axes.stepsPerMm(coarse.p_W_mm).diagonal().cwiseAbs().minCoeff();
  if (!(coarse.error * unit_mm <= kCoarsestMm)) {
    faults.push_back(
        fmt::format("{}: too coarse for its bends: near ({:g}, {:g}) mm two cubics through its nodes differ "
                    "by {:.4f} mm; {:g} mm may be",
                    table.name(), coarse.p_W_mm.x(), coarse.p_W_mm.y(), coarse.error * unit_mm, kCoarsestMm));
  }
  constexpr int kParts = 64;
  for (int i = 0; i < (kParts + 1) * (kParts + 1); ++i) {
    const int row = i / (kParts + 1);
    const Eigen::Vector2d share(i % (kParts + 1) / double(kParts), row / double(kParts));
    const Eigen::Vector2d p = low + share.cwiseProduct(high - low);
    const Eigen::Matrix2d slopes = axes.stepsPerMm(p);
    if (slopes(0, 0) > 0.0 && slopes(1, 1) > 0.0 && slopes.determinant() > 0.0) continue;
    faults.push_back(
        fmt::format("{}: not monotonic: at ({:g}, {:g}) mm the beam would go back where it should go on",
                    table.name(), p.x(), p.y()));
    break;
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
  // The upper bounds are beyond every machine; they keep what is computed from the numbers a number.
  const auto positive = [&](double value, const char* name, double most = 1e6, double least = 0.0) {
    check(std::isfinite(value) && value > 0.0, fmt::format("{} must be > 0, but is {:g}", name, value));
    check(!(value > most), fmt::format("{} must be at most {:g}, but is {:g}", name, most, value));
    check(!(value > 0.0 && value < least),
          fmt::format("{} must be at least {:g}, but is {:g}", name, least, value));
  };
  const auto notNegative = [&](double value, const char* name) {
    check(std::isfinite(value) && value >= 0.0, fmt::format("{} must be >= 0, but is {:g}", name, value));
    check(!(value > 1e6), fmt::format("{} must be at most 1e+06, but is {:g}", name, value));
  };
  if (machine.head == MachineParameters::Head::kTwoMirror) {
    positive(machine.throw_mm, "throw_mm", 1e6, 0.1);
    notNegative(machine.mirror_spacing_mm, "mirror_spacing_mm");
    positive(machine.mirror_step_rad, "mirror_step_rad", 0.1, 1e-9);
    notNegative(machine.mirror_acceleration_rad_s2, "mirror_acceleration_rad_s2");
  } else if (machine.head == MachineParameters::Head::kFTheta) {
    positive(machine.focal_length_mm, "focal_length_mm", 1e6, 0.1);
    positive(machine.mirror_step_rad, "mirror_step_rad", 0.1, 1e-9);
    notNegative(machine.mirror_acceleration_rad_s2, "mirror_acceleration_rad_s2");
  } else {
    positive(machine.gantry_step_mm, "gantry_step_mm", 1e3, 1e-6);
  }
  for (int i = 0; i < 2; ++i) {
    const double low = machine.field_min_mm[i];
    const double high = machine.field_max_mm[i];
    check(low >= -1e5 && high <= 1e5 && low <= 0.0 && high >= 0.0 && low < high,
          fmt::format("the field along {} must hold the resting beam at 0, but is {:g} … {:g} mm", "xy"[i],
                      low, high));
  }
  if (faults.empty() && machine.correction) {
    const std::vector<std::string> wrong = correctionFaults(machine);
    faults.insert(faults.end(), wrong.begin(), wrong.end());
  }
  check(machine.tracking_delay_s >= 0.0 && machine.tracking_delay_s <= machine.target.longestDelayS(),
        fmt::format(
            "tracking_delay_s must be in 0 … {:g}, by which this controller can delay the laser, but is {:g}",
            machine.target.longestDelayS(), machine.tracking_delay_s));
  check(machine.laser_lag_s >= 0.0 && machine.laser_lag_s <= 1.0,
        fmt::format("laser_lag_s must be in 0 … 1, but is {:g}", machine.laser_lag_s));
  for (std::string& fault : driveFaults(machine.target, machine.drives)) faults.push_back(std::move(fault));
  positive(machine.full_power_w, "full_power_w");
  positive(job.mark_speed_mm_s, "mark_speed_mm_s", 1e6, 1e-3);
  positive(job.jump_speed_mm_s, "jump_speed_mm_s", 1e6, 1e-3);
  positive(job.acceleration_mm_s2, "acceleration_mm_s2", 1e9, 1e-3);
  notNegative(job.jump_acceleration_mm_s2, "jump_acceleration_mm_s2");
  check(job.jump_radius_mm == kRadiusOfDrawing ||
            (std::isfinite(job.jump_radius_mm) && job.jump_radius_mm >= 0.0),
        fmt::format("jump_radius_mm must be >= 0, or {:g} for that of the drawing, but is {:g}",
                    kRadiusOfDrawing, job.jump_radius_mm));
  if (!job.power) positive(job.cut_energy_j_per_mm, "cut_energy_j_per_mm");
  check(std::isfinite(job.jerk_mm_s3) && job.jerk_mm_s3 >= 0.0,
        fmt::format("jerk_mm_s3 must be >= 0, but is {:g}", job.jerk_mm_s3));
  if (job.power_loop) {
    check(job.power != nullptr, "a loop on the measured power needs a material and a laser");
    positive(machine.power_quantum_j, "power_quantum_j", 1e3, 1e-6);
    // The controller looks back over so many ticks, the gate's delay and its own tick among them.
    const double longest_s = (KB_POWER_DELAY_MAX - 2) * machine.target.tick_s;
    check(machine.power_delay_s >= 0.0 && machine.power_delay_s + machine.tracking_delay_s <= longest_s,
          fmt::format("power_delay_s, {:g}, and tracking_delay_s must be in 0 … {:g} together",
                      machine.power_delay_s, longest_s));
    // The controller counts to 255, also of a tube that makes half as much again.
    const double full_w = job.power == nullptr ? 0.0 : job.power->laser().power.greatest().y;
    const double edges = full_w * machine.target.periodS() / (2.0 * machine.power_quantum_j);
    check(job.power == nullptr || (edges >= 16.0 && edges <= 160.0 * (1.0 + 1e-9)),
          fmt::format(
              "at full power the power meter sends {:.1f} edges in a period; the loop works with 16 … 160",
              edges));
  }
  check(job.half_z > 0.0 && job.half_z <= 1.0,
        fmt::format("half_z must be in (0, 1], but is {:g}", job.half_z));
  positive(job.perforation_cut_mm, "perforation_cut_mm", 1e6, 0.01);
  positive(job.perforation_gap_mm, "perforation_gap_mm", 1e6, 0.01);
  notNegative(job.kerf_radius_mm, "kerf_radius_mm");
  check(job.units >= 1 && job.units <= 1'000'000,
        fmt::format("units must be in 1 … 1000000, but is {}", job.units));
  if (job.units > 1) positive(job.pitch_mm, "pitch_mm");
  notNegative(job.belt_speed_mm_s, "belt_speed_mm_s");
  if (job.feed_by_controller) {
    positive(machine.feed_step_mm, "feed_step_mm", 1e3, 1e-6);
    positive(job.feed_acceleration_mm_s2, "feed_acceleration_mm_s2", 1e9, 1e-3);
    check(std::abs(job.web_start_x_mm) <= 1e9, "web_start_x_mm must be a number within ±1e9");
  }
  if (job.stop_and_go) {
    check(job.feed_by_controller, "stop_and_go needs feed_by_controller");
    positive(job.belt_speed_mm_s, "belt_speed_mm_s");
    check(!(job.belt_speed_mm_s > feedLimit(machine)),
          fmt::format("a feed of {:g} mm/s is too fast: the feed makes no more than {:.1f} mm/s",
                      job.belt_speed_mm_s, feedLimit(machine)));
  }
  if (job.belt_speed_mm_s > 0.0) {
    positive(machine.encoder_count_mm, "encoder_count_mm", 1e3, 1e-6);
    check(std::abs(machine.print_mark_sensor_x_mm) <= 1e6,
          "print_mark_sensor_x_mm must be a number within ±1e6");
    check(std::abs(job.eye_mark_x_mm) <= 1e6, "eye_mark_x_mm must be a number within ±1e6");
    // The follow gain is an i16 of steps per count times 4096.
    const double per_mm = !faults.empty() ? 0.0 : Axes(machine, {}).xStepsPerMm(Eigen::Vector2d::Zero());
    check(!(per_mm * machine.encoder_count_mm * 4096.0 > 32767.0),
          fmt::format("an encoder count of {:g} mm is {:.2f} steps; the controller follows no more than 7.99",
                      machine.encoder_count_mm, per_mm * machine.encoder_count_mm));
  }
  return faults;
}

std::string makeGcode(const hil::Dieline& dieline, const MachineParameters& machine, const JobParameters& job,
                      const PlannerFaults& faults) {
  require(machine, job);
  requireSane(dieline);
  const auto write = [&](const std::vector<Stop>& order) {
    return writeGcode(piecesOf(order, job), processNames(dieline));
  };
  if (job.order == JobParameters::Order::kDrawn) return needed(write(drawnOrder(dieline, job, faults)));
  std::vector<Stop> order = nearestOrder(dieline, job, faults, OrderOptions{});
  std::string best = needed(write(order));
  if (speedWhileCutting(job) <= 0.0) {
    return job.order == JobParameters::Order::kShortest ? write(shortened(std::move(order), {}, 0)) : best;
  }
  const Axes axes(machine, faults);
  const auto highest = [&](const std::string& gcode) {
    return maxBeltSpeed(unitOf(readGcode(gcode)), machine, job, axes);
  };
  double best_speed = highest(best);
  for (const bool place_before_process : {false, true}) {
    for (const double band_mm : kBandsMm) {
      if (best_speed >= job.belt_speed_mm_s) break;
      std::vector<Stop> broken = nearestOrder(dieline, job, faults, {true, place_before_process, band_mm});
      const std::string text = write(broken);
      const double speed = highest(text);
      if (speed <= best_speed) continue;
      best = text;
      best_speed = speed;
      order = std::move(broken);
    }
  }
  if (job.order != JobParameters::Order::kShortest || best_speed < job.belt_speed_mm_s) return best;
  // The line may run faster than it is said to, so a shorter way must not cost all the room there was.
  const double spare_speed = std::min(best_speed, kSpareSpeed * job.belt_speed_mm_s);
  const auto fits = [&](const std::vector<Stop>& candidate) {
    const std::vector<Segment> path = withJumps(piecesOf(candidate, job));
    return solve(path, machine, job, axes, job.belt_speed_mm_s).solution.has_value() &&
           solve(path, machine, job, axes, spare_speed).solution.has_value();
  };
  const std::string shorter = write(shortened(order, fits, kMostQuestions));
  return highest(shorter) >= job.belt_speed_mm_s ? shorter : best;
}

Plan planFromGcode(const std::string& gcode, const MachineParameters& machine, const JobParameters& job,
                   const PlannerFaults& faults) {
  const CheckResult checked = checkJob(gcode, machine, job, faults);
  if (!checked.solution) throw PlanError(fmt::format("{}", fmt::join(checked.errors, "\n")));
  const std::vector<Segment> path = unitOf(readGcode(gcode));
  const Axes axes(machine, faults);
  const double v = speedWhileCutting(job);
  const Solution& solution = *checked.solution;
  Plan plan;
  plan.gcode = gcode;
  plan.max_belt_speed_mm_s = checked.max_belt_speed_mm_s;

  const UnitLayout& layout = solution.layoutOf(0);
  const UnitLayout& next = solution.layoutOf(job.units > 1 ? 1 : 0);
  const double period_s = axes.periodS();
  plan.unit_time_s = (layout.catch_up_periods + layout.sheet_periods) * period_s;
  int way_back = Reposition(layout.end_W_mm, v, next.park_W_mm, job, axes).periods();
  if (job.stop_and_go) way_back = std::max(way_back, feedOfPitchPeriods(job, period_s));
  plan.cycle_time_s = plan.unit_time_s + way_back * period_s;
  plan.x_ref_mm = layout.x_ref_mm;
  plan.jump_length_mm = solution.paths.front().jump_length_mm;
  for (const Segment& segment : path) {
    if (!segment.jump && segment.z != 0.0) plan.cut_length_mm += segment.lengthMm();
  }
  constexpr double kMostPeriods = 1.5e8;  // 33 hours; some 60 bytes each
  if (job.units * plan.cycle_time_s > kMostPeriods * period_s) {
    throw PlanError(fmt::format("{} units of {:.3f} s are more than one program may hold ({:.0f} h)",
                                job.units, plan.cycle_time_s, kMostPeriods * period_s / 3600.0));
  }
  // A job at its highest speed must bear the little by which any line wavers.
  constexpr double kWaver = 1.02;
  if (v > 0.0 && !job.feed_by_controller)
    plan.belt_stop_mm_s = std::max(plan.max_belt_speed_mm_s, kWaver * v);
  plan.program = makeProgram(solution, machine, job, faults, axes, plan.belt_stop_mm_s);
  return plan;
}

Plan plan(const hil::Dieline& dieline, const MachineParameters& machine, const JobParameters& job,
          const PlannerFaults& faults) {
  return planFromGcode(makeGcode(dieline, machine, job, faults), machine, job, faults);
}

}  // namespace kerfbench::planner
