// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/program/job_issues.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "firmware_under_test/controller/protocol.h"
#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/head/correction.h"
#include "firmware_under_test/planner/motion/solve.h"
#include "firmware_under_test/planner/power/model.h"

namespace kerfbench::planner {
namespace {

/// Of a correction table; a fifth of what a cut may be off.
constexpr double kCoarsestMm = 0.01;
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

}  // namespace

std::vector<std::string> jobIssues(const MachineParameters& machine, const JobParameters& job) {
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

}  // namespace kerfbench::planner
