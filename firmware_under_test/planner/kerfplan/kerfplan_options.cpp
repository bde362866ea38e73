// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/kerfplan/kerfplan_options.h"

#include <map>

#include <fmt/format.h>

#include "firmware_under_test/planner/order/hand_order.h"
#include "firmware_under_test/planner/order/kerf.h"
#include "firmware_under_test/planner/program/selection.h"

namespace kerfbench::planner {
namespace {

/// A way to find an order by its name, or entities as they are typed.
void readOrder(const std::string& words, JobParameters& job) {
  const std::map<std::string, JobParameters::Order> names{{"shortest", JobParameters::Order::kShortest},
                                                          {"nearest", JobParameters::Order::kNearest},
                                                          {"drawn", JobParameters::Order::kDrawn}};
  if (const auto found = names.find(CLI::detail::to_lower(words)); found != names.end()) {
    job.order = found->second;
    return;
  }
  try {
    job.given_order = idsOf(entityRangesFrom(words, "--order"), kMostOrdered);
    job.order = JobParameters::Order::kGiven;
  } catch (const PlanError& error) {
    throw CLI::ValidationError("--order",
                               fmt::format("shortest, nearest, drawn, or entities: {}", error.what()));
  }
}

}  // namespace

void addMachineOptions(CLI::App& app, KerfplanOptions& options) {
  MachineParameters& m = options.machine;
  const std::map<std::string, MachineParameters::Head> heads{
      {"two-mirror", MachineParameters::Head::kTwoMirror},
      {"gantry", MachineParameters::Head::kGantry},
      {"f-theta", MachineParameters::Head::kFTheta}};
  const std::string group = "Machine";
  app.add_option(
         "--scenario", options.scenario,
         "Scenario whose drawing, job, machine and release are planned as `kerfbench plan` does; options "
         "that are given go before it")
      ->group(group);
  app.add_option("--machine", options.machine_file,
                 "Machine file (.yaml) that says what the options below do not, in place of the scenario's")
      ->group(group);
  const auto option = [&](const char* name, double& value, const char* help) {
    app.add_option(name, value, help)->group(group)->capture_default_str();
  };
  app.add_option("--head", m.head,
                 "What moves the beam: two-mirror, f-theta (two mirrors and a lens) or gantry")
      ->transform(CLI::CheckedTransformer(heads, CLI::ignore_case))
      ->default_str("two-mirror")
      ->group(group);
  option("--throw", m.throw_mm, "Y mirror to sheet, mm (two-mirror)");
  option("--mirror-spacing", m.mirror_spacing_mm, "X mirror to Y mirror, mm (two-mirror)");
  option("--mirror-step", m.mirror_step_rad, "Mechanical angle of one step, rad (two-mirror, f-theta)");
  option("--focal-length", m.focal_length_mm, "Of the lens, mm (f-theta)");
  option("--mirror-acceleration", m.mirror_acceleration_rad_s2,
         "Highest of either mirror, rad/s2 mechanical; 0: never the limit (two-mirror)");
  option("--full-step-pulses", m.steppers.full_step_pulses,
         "Steppers on the mirrors: pulses for a full step; 0: none (two-mirror, f-theta)");
  option("--detent-share", m.steppers.detent_share,
         "Their detent torque over their holding torque, which the steps then make up for; needs "
         "--full-step-pulses");
  option("--rotor-resonance", m.steppers.resonance_hz,
         "Frequency of their rotors, Hz: steps are chosen so that these do not swing; 0: the nearest steps");
  option("--rotor-damping", m.steppers.resonance_damping, "Damping of the same, share of critical");
  option("--gantry-step", m.gantry_step_mm, "Way of one step, mm (gantry)");
  option("--x-min", m.field_min_mm[0], "Reach of the beam upstream, mm");
  option("--x-max", m.field_max_mm[0], "Reach of the beam downstream, mm");
  option("--y-min", m.field_min_mm[1], "Reach of the beam across, mm");
  option("--y-max", m.field_max_mm[1], "Reach of the beam across, mm");
  option("--tracking-delay", m.tracking_delay_s, "Lag of mirrors or gantry behind their steps, s");
  option("--encoder-count", m.encoder_count_mm, "Belt travel of one encoder count, mm");
  option("--print-mark-sensor", m.print_mark_sensor_x_mm, "Place of the print-mark sensor, x in mm");
  option("--feed-step", m.feed_step_mm, "Belt travel of one feed step, mm");
  option("--full-power", m.full_power_w, "Laser power at full duty, W");
  app.add_option(
         "--image", options.image,
         "The controller's release, .hex, .elf or native: tick, period, steps in a period, pulse times "
         "and delays are planned as it says; not told: those of the AVR release")
      ->group(group);
}

void addJobOptions(CLI::App& app, JobParameters& j) {
  const std::string group = "Job";
  const auto option = [&](const char* name, auto& value, const char* help) {
    app.add_option(name, value, help)->group(group)->capture_default_str();
  };
  option("--belt-speed", j.belt_speed_mm_s, "Speed of the sheet, mm/s; 0: it rests");
  option("--belt-min", j.belt_min_mm_s, "Lowest speed that the belt may have, mm/s; 0: not checked");
  option("--belt-max", j.belt_max_mm_s, "Highest speed that the belt may have, mm/s; 0: not checked");
  option("--mark-speed", j.mark_speed_mm_s, "Highest speed of marks on the sheet, mm/s");
  option("--jump-speed", j.jump_speed_mm_s, "Highest speed of jumps and of the way back, mm/s");
  option("--acceleration", j.acceleration_mm_s2, "Highest acceleration, mm/s2");
  option("--jerk", j.jerk_mm_s3,
         "Most change of acceleration, mm/s3: S-curves in marks and jumps; 0: no limit");
  option("--jump-acceleration", j.jump_acceleration_mm_s2,
         "Of jumps and of the way back, mm/s2; 0: as of marks");
  option(
      "--jump-radius", j.jump_radius_mm,
      "Arcs by which jumps leave and meet marks, mm: the beam does not stop; 0: straight jumps with stops; "
      "-1: by the drawing's size, 1 mm up to 10 mm, 5 mm from 100 mm on");
  option("--run-up", j.run_up_mm,
         "Way before and behind marks, along their tangent with the laser off, mm: marks begin and end at "
         "speed; "
         "0: none; -1: as long as the speed takes");
  option(
      "--corner-error", j.corner_error_mm,
      "How far the beam may miss a corner so as not to stop there, mm: turns below a right angle are rounded "
      "by that at most, lag of the drives included; 0: none is");
  option("--cut-energy", j.cut_energy_j_per_mm, "Energy per length that cuts through (Z1), J/mm");
  option("--half-z", j.half_z, "Z of half-cuts and creases, 0 to 1");
  option("--perforation-cut", j.perforation_cut_mm, "Length of a dash, mm");
  option("--perforation-gap", j.perforation_gap_mm, "Length between dashes, mm");
  option("--units", j.units, "Units on the web");
  option("--pitch", j.pitch_mm, "Distance of units on the web, mm");
  option("--eye-mark", j.eye_mark_x_mm, "Leading edge of the eye mark in the unit, x in mm");
  option("--web-start", j.web_start_x_mm,
         "x of unit 0's origin while the belt rests, mm (belt speed 0, or --feed)");
  option("--feed-acceleration", j.feed_acceleration_mm_s2, "With --feed: acceleration of the belt, mm/s2");
  app.add_option_function<std::string>(
         "--order", [&j](const std::string& words) { readOrder(words, j); },
         "Order of a drawing's lines: shortest (air path), nearest (end, greedily), drawn, or the entities "
         "themselves: 3,0,5-8")
      ->type_name("ORDER")
      ->default_str("shortest")
      ->group(group);
  addKerfOptions(app, j);
  app.add_flag("--alternate", j.alternate, "Cut every second unit backwards")->group(group);
  app.add_flag("--stop-and-go", j.stop_and_go,
               "With --feed: feed a pitch at the belt speed, stop, cut at rest")
      ->group(group);
  app.add_flag("--feed", j.feed_by_controller, "The controller drives the belt")->group(group);
}

}  // namespace kerfbench::planner
