// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/kerfplan/kerfplan_power.h"

#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "firmware_under_test/planner/kerfplan/kerfplan_library.h"
#include "firmware_under_test/planner/power/library_folder.h"
#include "hil/base/terminal.h"

namespace kerfbench::planner {

struct PowerCommand::Options {
  PowerOptions power;
  std::vector<double> speeds_mm_s;
};

namespace {

void addFault(std::string& faults, const std::string& fault) {
  faults += (faults.empty() ? "" : "\n") + fault;
}

/// File that a number, a name or a path means.
std::filesystem::path fileOf(EntryKind kind, const std::string& wanted, const std::string& library) {
  if (!isLibraryName(wanted)) return wanted;
  if (library.empty()) throw PowerError(fmt::format("'{}' is no file, and there is no --library", wanted));
  return LibraryFolder(library).fileOf(kind, wanted);
}

/// Reads an entry, or records its faults.
template <typename Library>
std::optional<Library> read(Library (*reader)(const std::filesystem::path&), EntryKind kind,
                            const std::string& wanted, const std::string& library, std::string& faults) {
  try {
    return reader(fileOf(kind, wanted, library));
  } catch (const PowerError& error) {
    addFault(faults, error.what());
    return std::nullopt;
  }
}

std::string outOfReach(const PowerModel& model, double speed_mm_s, double depth_mm) {
  const PowerModel::Setting setting = model.at(speed_mm_s, depth_mm);
  const PowerModel::Speeds range = model.speedsFor(depth_mm);
  if (setting.limit == PowerModel::Limit::kNone) return {};
  return fmt::format(
      "{:g} mm at {:g} mm/s cannot be had: it takes {:.4g} W, the laser's {} is {:g} W and cuts "
      "{:.3f} mm; {:.4g} … {:.4g} mm/s will do",
      depth_mm, speed_mm_s, setting.wanted_w, setting.limit == PowerModel::Limit::kMost ? "most" : "least",
      setting.power_w, setting.depth_mm, range.lowest_mm_s, range.highest_mm_s);
}

}  // namespace

void addPowerOptions(CLI::App& app, PowerOptions& o) {
  const std::string group = "Power by depth";
  app.add_option("--material", o.material,
                 "How deep power over speed and spot diameter cuts: number or name in the library, or a file "
                 "(YAML, see "
                 "fixtures/power/mild-steel.yaml); "
                 "with --laser and --depth, instead of --cut-energy and --full-power")
      ->group(group);
  app.add_option(
         "--laser", o.laser,
         "What the laser makes of its control signal: number or name in the library, or a file (YAML, see "
         "fixtures/power/co2-tube-80w.yaml)")
      ->group(group);
  o.library = shippedLibrary();
  app.add_option(
         "--library", o.library,
         "Folder of numbered materials and lasers, by default the one that is shipped; see kerfplan library")
      ->group(group);
  app.add_option("--depth", o.depth_mm, "Of cuts (Z1), mm")->group(group);
  app.add_option("--half-depth", o.half_depth_mm,
                 "Of creases and half-cuts (Z of --half-z), mm; not told: Z times --depth")
      ->group(group);
  app.add_option("--spot-diameter", o.spot_diameter_mm, "Of the beam on the sheet, mm")
      ->group(group)
      ->capture_default_str();
}

std::shared_ptr<const PowerModel> powerModelOf(const PowerOptions& o) {
  if (o.material.empty() && o.laser.empty() && o.depth_mm == 0.0 && o.half_depth_mm == 0.0) return nullptr;
  std::string faults;
  if (o.material.empty()) addFault(faults, "--material is missing");
  if (o.laser.empty()) addFault(faults, "--laser is missing");
  if (o.depth_mm == 0.0) addFault(faults, "--depth is missing");
  std::optional<Material> material;
  std::optional<LaserTube> laser;
  if (!o.material.empty()) material = read(readMaterial, EntryKind::kMaterial, o.material, o.library, faults);
  if (!o.laser.empty()) laser = read(readLaser, EntryKind::kLaser, o.laser, o.library, faults);
  if (!faults.empty()) throw PowerError(faults);
  PowerWish wish{o.spot_diameter_mm, o.depth_mm, std::nullopt, GivenBy::kCommandLine};
  if (o.half_depth_mm != 0.0) wish.half_depth_mm = o.half_depth_mm;
  if (isLibraryName(o.material)) wish.deeper_materials = LibraryFolder(o.library).materialsFor(o.depth_mm);
  return std::make_shared<PowerModel>(*std::move(material), *std::move(laser), wish);
}

PowerCommand::PowerCommand(CLI::App& app) : options_(std::make_shared<Options>()) {
  sub_ = app.add_subcommand(
      "power",
      "Print what a depth takes of a laser at each speed: P_ua, power, control signal, PWM "
      "byte and the depth that is reached");
  addPowerOptions(*sub_, options_->power);
  sub_->add_option(
          "--speed", options_->speeds_mm_s,
          "Speeds, mm/s, refused if a depth cannot be had at one; not told: from below the lowest to "
          "above the highest")
      ->delimiter(',');
}

bool PowerCommand::run() const {
  if (!sub_->parsed()) return false;
  const std::shared_ptr<const PowerModel> model = powerModelOf(options_->power);
  if (!model) throw PowerError("power needs --material, --laser and --depth");
  std::string faults;
  for (const double speed : options_->speeds_mm_s) {
    if (!(speed > 0.0 && speed <= 1e6))
      addFault(faults, fmt::format("--speed must be in 0 … 1e6 mm/s, but is {:g}", speed));
  }
  if (!faults.empty()) throw PowerError(faults);
  std::vector<double> depths{model->wish().depth_mm};
  if (model->wish().half_depth_mm) depths.push_back(*model->wish().half_depth_mm);
  for (const double depth : depths) {
    const bool told = !options_->speeds_mm_s.empty();
    base::toTerminal(stdout,
                     powerTable(*model, depth, told ? options_->speeds_mm_s : tableSpeeds(*model, depth)));
    for (const double speed : options_->speeds_mm_s) {
      const std::string fault = outOfReach(*model, speed, depth);
      if (!fault.empty()) addFault(faults, fault);
    }
  }
  if (!faults.empty()) throw PowerError(faults);
  return true;
}

}  // namespace kerfbench::planner
