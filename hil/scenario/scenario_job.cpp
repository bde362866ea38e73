// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/scenario_sections.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <optional>
#include <string>

#include "firmware_under_test/planner/order/hand_order.h"
#include "firmware_under_test/planner/power/library_folder.h"
#include "firmware_under_test/planner/power/model.h"

namespace kerfbench::scenario {
namespace {

namespace fs = std::filesystem;

/// The library that `power` names, if it names one.
std::optional<planner::LibraryFolder> readLibrary(base::YamlReader& power) {
  const std::string folder = power.text("library", "");
  if (folder.empty()) return std::nullopt;
  try {
    return planner::LibraryFolder((power.folderOf("library") / folder).lexically_normal());
  } catch (const planner::PowerError& error) {
    power.fault("library", error.what());
    return std::nullopt;
  }
}

/// File of a material or a laser: its path, or its number or name in the library.
fs::path entryOf(base::YamlReader& power, planner::EntryKind kind,
                 const std::optional<planner::LibraryFolder>& library) {
  const char* key = planner::nameOf(kind);
  const std::string wanted = power.has(key) ? power.text(key) : "";
  if (!planner::isLibraryName(wanted)) return fileOf(power, key);
  if (!library) {
    power.fault(key, fmt::format("'{}' is no .yaml file, and no `library` has it by number or name", wanted));
    return {};
  }
  try {
    const fs::path file = fs::absolute(library->fileOf(kind, wanted)).lexically_normal();
    power.names(file);
    return file;
  } catch (const planner::PowerError& error) {
    power.fault(key, error.what());
    return {};
  }
}

/// S3: by depth, with a material and a laser, instead of by energy per length.
std::shared_ptr<const planner::PowerModel> readPower(base::YamlReader& power) {
  const std::optional<planner::LibraryFolder> library = readLibrary(power);
  const fs::path material = entryOf(power, planner::EntryKind::kMaterial, library);
  const fs::path laser = entryOf(power, planner::EntryKind::kLaser, library);
  planner::PowerWish wish{.spot_diameter_mm = power.number("spot_diameter_mm", {.min = 0.01, .max = 10}),
                          .depth_mm = power.number("depth_mm", {.min = 1e-4, .max = 100}),
                          .half_depth_mm = std::nullopt};
  if (power.has("half_depth_mm"))
    wish.half_depth_mm = power.number("half_depth_mm", {.min = 1e-4, .max = 100});
  if (library) wish.deeper_materials = library->materialsFor(wish.depth_mm);
  const auto read = [&](const char* key, const fs::path& file, auto reader) {
    decltype(std::optional(reader(file))) content;
    try {
      if (!file.empty()) content = reader(file);
    } catch (const planner::PowerError& error) {
      power.fault(key, fmt::format("cannot be used:\n{}", error.what()));
    }
    return content;
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

/// A way to find an order, or the order itself: `[3, 0, 5-8]`.
void readOrder(base::YamlReader& planner, planner::JobParameters& job) {
  using Order = planner::JobParameters::Order;
  if (!planner.isList("order")) {
    const std::string order = planner.choice("order", {"shortest", "nearest", "drawn"}, "shortest");
    job.order = order == "drawn" ? Order::kDrawn : order == "nearest" ? Order::kNearest : Order::kShortest;
    return;
  }
  job.order = Order::kGiven;
  try {
    job.given_order = planner::idsOf(
        planner::entityRangesFrom(fmt::format("{}", fmt::join(planner.texts("order"), ",")), "an order"),
        planner::kMostOrdered);
  } catch (const planner::PlanError& error) {
    planner.fault("order", error.what());
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
    job.power_law = power.choice("law", {"damped", "paper"}, "damped") == "paper"
                        ? planner::JobParameters::PowerLaw::kPaper
                        : planner::JobParameters::PowerLaw::kDamped;
  }
  job.run_up_mm = planner.number("run_up_mm", {.min = -1, .max = 1000, .fallback = 0.0});
  if (job.run_up_mm < 0.0 && job.run_up_mm != planner::kRunUpOfSpeed)
    planner.fault("run_up_mm", "is a length, 0 for none, or -1 for what the speed takes");
  job.jerk_mm_s3 = planner.number("jerk_mm_s3", {.min = 0, .max = 1e12, .fallback = 0.0});
  job.corner_error_mm =
      planner.number("corner_error_mm", {.min = 0, .max = 1, .fallback = job.corner_error_mm});
  job.half_z = planner.number("half_z", {.min = 0.05, .max = 0.95, .fallback = job.half_z});
  job.perforation_cut_mm =
      planner.number("perforation_cut_mm", {.min = 0.3, .max = 50, .fallback = job.perforation_cut_mm});
  job.perforation_gap_mm =
      planner.number("perforation_gap_mm", {.min = 0.3, .max = 50, .fallback = job.perforation_gap_mm});
  job.alternate = planner.boolean("alternate", false);
  job.stop_and_go = planner.boolean("stop_and_go", false);
  if (job.stop_and_go && !scenario.belt_by_controller)
    planner.fault("stop_and_go", "needs belt.drive: controller, whose feed it is");
  readOrder(planner, job);
  job.kerf_radius_mm = planner.number("kerf_radius_mm", {.min = 0, .max = 2, .fallback = 0.0});
  const std::string open_cuts = planner.choice("open_cuts", {"line", "left", "right"}, "line");
  job.open_cuts = open_cuts == "left"    ? planner::JobParameters::OpenCuts::kLeft
                  : open_cuts == "right" ? planner::JobParameters::OpenCuts::kRight
                                         : planner::JobParameters::OpenCuts::kOnTheLine;
  try {
    job.allow_lost = planner::entityRangesFrom(planner.text("allow_lost_features", ""), "what may be lost");
  } catch (const planner::PlanError& error) {
    planner.fault("allow_lost_features", error.what());
  }
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
