// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/scenario_sections.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>

#include "firmware_under_test/planner/power/model.h"

namespace kerfbench::scenario {
namespace {

namespace fs = std::filesystem;

/// S3: by depth, with a material and a laser, instead of by energy per length.
std::shared_ptr<const planner::PowerModel> readPower(base::YamlReader& power) {
  const fs::path material = fileOf(power, "material");
  const fs::path laser = fileOf(power, "laser");
  planner::PowerWish wish{.spot_diameter_mm = power.number("spot_diameter_mm", {.min = 0.01, .max = 10}),
                          .depth_mm = power.number("depth_mm", {.min = 1e-4, .max = 100}),
                          .half_depth_mm = std::nullopt};
  if (power.has("half_depth_mm"))
    wish.half_depth_mm = power.number("half_depth_mm", {.min = 1e-4, .max = 100});
  const auto read = [&](const char* key, const fs::path& file, auto reader) {
    decltype(std::optional(reader(file))) library;
    try {
      if (!file.empty()) library = reader(file);
    } catch (const planner::PowerError& error) {
      power.fault(key, fmt::format("cannot be used:\n{}", error.what()));
    }
    return library;
  };
  const auto the_material = read("material", material, planner::readMaterial);
  const auto the_laser = read("laser", laser, planner::readLaser);
  if (!the_material || !the_laser) return nullptr;
  try {
    return std::make_shared<planner::PowerModel>(*the_material, *the_laser, wish);
  } catch (const planner::PowerError& error) {
    power.fault("depth_mm", error.what());
    return nullptr;
  }
}

}  // namespace

planner::JobParameters readJob(base::YamlReader planner, const Scenario& scenario) {
  planner::JobParameters job;
  job.belt_speed_mm_s = scenario.belt_speed_mm_s;
  job.mark_speed_mm_s =
      planner.number("mark_speed_mm_s", {.min = 1, .max = 5000, .fallback = job.mark_speed_mm_s});
  job.jump_speed_mm_s =
      planner.number("jump_speed_mm_s", {.min = 1, .max = 5000, .fallback = job.jump_speed_mm_s});
  job.acceleration_mm_s2 =
      planner.number("acceleration_mm_s2", {.min = 10, .max = 1e6, .fallback = job.acceleration_mm_s2});
  job.jump_acceleration_mm_s2 =
      planner.number("jump_acceleration_mm_s2", {.min = 0, .max = 1e6, .fallback = 0.0});
  // Who sends G-code of his own needs no planner.
  const bool planned = scenario.firmware.dialog == FirmwareChoice::Dialog::kKerfbench;
  const bool by_depth = planner.has("power");
  job.cut_energy_j_per_mm = planner.number(
      "cut_energy_j_per_mm",
      {1e-4, 10, planned && !by_depth ? std::nullopt : std::optional(job.cut_energy_j_per_mm)});
  if (by_depth) {
    base::YamlReader power = planner.section("power");
    job.power = readPower(power);
    job.power_loop = power.boolean("closed_loop", false);
  }
  job.run_up_mm = planner.number("run_up_mm", {.min = -1, .max = 1000, .fallback = 0.0});
  if (job.run_up_mm < 0.0 && job.run_up_mm != planner::kRunUpOfSpeed)
    planner.fault("run_up_mm", "is a length, 0 for none, or -1 for what the speed takes");
  job.jerk_mm_s3 = planner.number("jerk_mm_s3", {.min = 0, .max = 1e12, .fallback = 0.0});
  job.half_z = planner.number("half_z", {.min = 0.05, .max = 0.95, .fallback = job.half_z});
  job.perforation_cut_mm =
      planner.number("perforation_cut_mm", {.min = 0.3, .max = 50, .fallback = job.perforation_cut_mm});
  job.perforation_gap_mm =
      planner.number("perforation_gap_mm", {.min = 0.3, .max = 50, .fallback = job.perforation_gap_mm});
  job.alternate = planner.boolean("alternate", false);
  job.stop_and_go = planner.boolean("stop_and_go", false);
  if (job.stop_and_go && !scenario.belt_by_controller)
    planner.fault("stop_and_go", "needs belt.drive: controller, whose feed it is");
  const std::string order = planner.choice("order", {"shortest", "nearest", "drawn"}, "shortest");
  job.order = order == "drawn"     ? planner::JobParameters::Order::kDrawn
              : order == "nearest" ? planner::JobParameters::Order::kNearest
                                   : planner::JobParameters::Order::kShortest;
  job.kerf_radius_mm = planner.number("kerf_radius_mm", {.min = 0, .max = 2, .fallback = 0.0});
  const std::string open_cuts = planner.choice("open_cuts", {"line", "left", "right"}, "line");
  job.open_cuts = open_cuts == "left"    ? planner::JobParameters::OpenCuts::kLeft
                  : open_cuts == "right" ? planner::JobParameters::OpenCuts::kRight
                                         : planner::JobParameters::OpenCuts::kOnTheLine;
  job.allow_lost_features = planner.boolean("allow_lost_features", false);
  job.feed_by_controller = scenario.belt_by_controller;
  job.units = scenario.print.units;
  job.pitch_mm = scenario.print.pitch_mm;
  job.eye_mark_x_mm = scenario.print.eye_mark_x_mm;
  return job;
}

planner::PlannerFaults readPlannerFaults(base::YamlReader faults) {
  planner::PlannerFaults result;
  result.ignore_belt = faults.boolean("ignore_belt", false);
  result.mean_speed = faults.boolean("mean_speed", false);
  result.no_pincushion = faults.boolean("no_pincushion", false);
  result.no_mirror_limit = faults.boolean("no_mirror_limit", false);
  result.return_unchecked = faults.boolean("return_unchecked", false);
  result.kerf_wrong_side = faults.boolean("kerf_wrong_side", false);
  result.constant_power = faults.boolean("constant_power", false);
  result.skip_entity =
      static_cast<int>(faults.integer("skip_entity", {.min = -1, .max = 1e6, .fallback = -1.0}));
  result.repeat_entity =
      static_cast<int>(faults.integer("repeat_entity", {.min = -1, .max = 1e6, .fallback = -1.0}));
  return result;
}

}  // namespace kerfbench::scenario
