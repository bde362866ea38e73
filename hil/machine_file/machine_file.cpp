// SPDX-License-Identifier: Apache-2.0
#include "hil/machine_file/machine_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "hil/machine_file/machine_sections.h"
#include "hil/machine_file/machine_text.h"

namespace kerfbench::machine_file {
namespace {

using twin::MachineDescription;

void readTwoMirror(base::YamlReader& file, const DriveCatalogue& catalogue, MachineDescription& machine) {
  machine.head = readHead(file.section("optics"));
  machine.galvo_x = readAxis(file.section("galvo_x"), Load::kMirror, catalogue);
  machine.galvo_y = readAxis(file.section("galvo_y"), Load::kMirror, catalogue);
}

void readGantry(base::YamlReader& file, const DriveCatalogue& catalogue, MachineDescription& machine) {
  machine.gantry_x = readAxis(file.section("gantry_x"), Load::kSlide, catalogue);
  machine.gantry_y = readAxis(file.section("gantry_y"), Load::kSlide, catalogue);
  if (machine.gantry_x.load_inertia <= machine.gantry_y.load_inertia) {
    file.section("gantry_x")
        .fault("mass_kg", "the bridge carries the carriage: it must be heavier than gantry_y.mass_kg");
  }
  machine.squareness_rad =
      kMicro * file.number("squareness_urad", {.min = -1e4, .max = 1e4, .fallback = 0.0});
  auto travel = file.section("travel");
  const auto box = readBox(travel, "x_mm", "y_mm");
  machine.travel_min_mm = box[0];
  machine.travel_max_mm = box[1];
}

/// What is left of a waist's radius after it was measured by burn marks or a knife edge (ISO 11146: a few
/// percent).
constexpr double kUsualRadius_percent = 5.0;
/// Repeatability of linear stages with an encoder, as data sheets state it for both directions: 1 to 3 um.
constexpr double kUsualTable_um = 2.0;
/// A steel scale that is one kelvin off its temperature: 11 ppm/K (AMO LMB-100, which is true to 3 um/m).
constexpr double kUsualTableScale_ppm = 10.0;
/// Straightness of linear stages over 100 to 200 mm, as their data sheets state it: 1 to 3 um.
constexpr double kUsualStraightness_um = 2.0;
/// A photomask of soda-lime glass (9 ppm/K) that is one kelvin off.
constexpr double kUsualTargetScale_ppm = 10.0;
/// What an LED's light changes from warm to cold and over months, white balanced by hand: some percent.
constexpr double kUsualOpenGray_percent = 2.0;

CameraFile readCameraFile(base::YamlReader& camera, const std::filesystem::path& machine_file,
                          const std::string& which) {
  CameraFile result;
  result.id = camera.text("id", which);
  if (result.id.empty() || result.id.find_first_of("'\n\r") != std::string::npos)
    camera.fault("id", "must be a name without quotes");
  const std::string name = camera.text("calibration", "");
  result.calibration = name.empty() ? machine_file.parent_path() /
                                          (machine_file.stem().string() + "." + which + ".camera.yaml")
                                    : camera.folderOf("calibration") / name;
  result.calibration = std::filesystem::absolute(result.calibration).lexically_normal();
  if (std::filesystem::is_regular_file(result.calibration)) camera.names(result.calibration);
  return result;
}

void readCameras(base::YamlReader cameras, MachineFile& file, const std::filesystem::path& path) {
  auto spot = cameras.section("spot");
  auto kerf = cameras.section("kerf");
  file.spot_camera = readCameraFile(spot, path, "spot");
  file.kerf_camera = readCameraFile(kerf, path, "kerf");
  file.kerf_camera.table_sigma_mm =
      1e-3 * kerf.number("table_um", {.min = 0, .max = 100, .fallback = kUsualTable_um});
  file.kerf_camera.table_scale_sigma =
      1e-6 * kerf.number("table_scale_ppm", {.min = 0, .max = 1000, .fallback = kUsualTableScale_ppm});
  file.kerf_camera.table_straightness_mm =
      1e-3 * kerf.number("table_straightness_um", {.min = 0, .max = 100, .fallback = kUsualStraightness_um});
  file.kerf_camera.target_scale_sigma =
      1e-6 * kerf.number("target_scale_ppm", {.min = 0, .max = 1000, .fallback = kUsualTargetScale_ppm});
  file.kerf_camera.open_gray_sigma =
      1e-2 * kerf.number("open_gray_percent", {.min = 0, .max = 10, .fallback = kUsualOpenGray_percent});
  MachineDescription& machine = file.machine;
  machine.glow_gray_per_w = spot.number("glow_gray_per_w", {.min = 0.01, .max = 1000});
  machine.spot_camera = readCamera(spot, true);
  machine.kerf_camera = readCamera(kerf, false);
}

DriveCatalogue readCatalogueOf(base::YamlReader& file) {
  const std::string drivers = file.text("drivers");
  if (drivers.empty()) return {};
  const std::filesystem::path path = file.folderOf("drivers") / drivers;
  file.names(path);
  return readCatalogue(path);
}

}  // namespace

std::array<std::array<double, 2>, 2> readBox(base::YamlReader& section, std::string_view x_key,
                                             std::string_view y_key) {
  const base::YamlReader::Range metres{.min = -1e4, .max = 1e4};
  const auto x = section.numbers(x_key, 2, metres);
  const auto y = section.numbers(y_key, 2, metres);
  if (x[0] >= x[1]) section.fault(x_key, "the second value must be the larger");
  if (y[0] >= y[1]) section.fault(y_key, "the second value must be the larger");
  return {{{x[0], y[0]}, {x[1], y[1]}}};
}

twin::ControllerDescription readController(base::YamlReader told, MachineDescription::Kind kind) {
  twin::ControllerDescription result;
  if (kind == MachineDescription::Kind::kTwoMirror) {
    result.throw_mm = told.number("throw_mm", {.min = 10, .max = 5000});
    result.mirror_spacing_mm = told.number("mirror_spacing_mm", {.min = 0, .max = 500});
    result.mirror_step_rad = kMicro * told.number("mirror_step_urad", {.min = 1e-3, .max = 1e5});
    result.focal_length_mm = told.number("focal_length_mm", {.min = 0, .max = 5000, .fallback = 0.0});
    result.mirror_acceleration_rad_s2 =
        told.number("mirror_acceleration_rad_s2", {.min = 0, .max = 1e6, .fallback = 0.0});
    result.full_step_pulses = told.number("full_step_pulses", {.min = 0, .max = 1024, .fallback = 0.0});
    result.detent_share = told.number("detent_share", {.min = -0.5, .max = 0.5, .fallback = 0.0});
    result.rotor_resonance_hz = told.number("rotor_resonance_hz", {.min = 0, .max = 1000, .fallback = 0.0});
    result.rotor_damping = told.number("rotor_damping", {.min = 0, .max = 0.9, .fallback = 0.0});
  } else {
    result.gantry_step_mm = told.number("gantry_step_mm", {.min = 1e-6, .max = 10});
  }
  if (const std::string table = told.text("correction", ""); !table.empty()) {
    const auto path = std::filesystem::absolute(told.folderOf("correction") / table).lexically_normal();
    if (!std::filesystem::is_regular_file(path))
      told.fault("correction", fmt::format("no such file '{}'", table));
    told.names(path);
    result.correction_file = path.string();
  }
  const auto field = readBox(told, "field_x_mm", "field_y_mm");
  result.field_min_mm = field[0];
  result.field_max_mm = field[1];
  result.jump_radius_mm = told.number("jump_radius_mm", {.min = -1, .max = 1000, .fallback = 0.0});
  result.tracking_delay_s = kMilli * told.number("tracking_delay_ms", {.min = 0, .max = 5});
  result.encoder_count_mm = told.number("encoder_count_mm", {.min = 1e-4, .max = 10});
  result.print_mark_sensor_x_mm = told.number("print_mark_sensor_x_mm", {.min = -1e4, .max = 1e4});
  result.feed_step_mm = told.number("feed_step_mm", {.min = 0, .max = 10, .fallback = 0.0});
  result.full_power_w = told.number("full_power_w", {.min = 0.1, .max = 1e5});
  result.power_quantum_j = kMilli * told.number("power_quantum_mj", {.min = 0, .max = 1e5, .fallback = 0.0});
  result.laser_lag_s = kMilli * told.number("laser_lag_ms", {.min = 0, .max = 5, .fallback = 0.0});
  result.power_delay_s = kMilli * told.number("power_delay_ms", {.min = 0, .max = 8, .fallback = 0.0});
  return result;
}

namespace {

// What the twin calls its parts, and where a machine file has them.
constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kSections{
    {{"line", "belt.line_drive"},
     {"feed", "belt.feed"},
     {"encoder", "belt.encoder"},
     {"print_mark_sensor", "belt.print_mark_sensor"},
     {"spot_camera", "cameras.spot"},
     {"kerf_camera", "cameras.kerf"},
     {"travel_min", "travel"},
     {"travel_max", "travel"},
     {"head", "optics"}}};

std::string keyOf(const std::string& field) {
  const std::string first = field.substr(0, field.find('.'));
  const auto section =
      std::ranges::find(kSections, first, &std::pair<std::string_view, std::string_view>::first);
  return section == kSections.end() ? field : std::string(section->second) + field.substr(first.size());
}

}  // namespace

std::string MachineFile::placeOf(const std::string& field) const {
  const std::string key = keyOf(field);
  const auto dot = key.rfind('.');
  const std::string section = dot == std::string::npos ? "" : key.substr(0, dot + 1);
  const std::string name = dot == std::string::npos ? key : key.substr(dot + 1);
  for (const char* drive : {"", "servo.", "stepper."}) {
    const std::string whole = fmt::format("{}{}{}", section, drive, name);
    // Keys have their unit at the end: "stiffness" is stiffness_n_mm.
    for (auto it = places.lower_bound(whole); it != places.end() && it->first.starts_with(whole); ++it) {
      if (it->first == whole || (it->first[whole.size()] == '_' && given.contains(it->first)))
        return it->second;
    }
  }
  if (const auto part = places.find(key); part != places.end()) return part->second;
  return dot == std::string::npos ? places.at("") : placeOf(key.substr(0, dot));
}

namespace {

MachineFile readAll(base::YamlReader file, const std::filesystem::path& path) {
  MachineFile result;
  MachineDescription& machine = result.machine;
  if (file.integer("version", {.min = 1, .max = 1e6}) != 1)
    file.fault("version", "this program reads version 1");
  machine.name = file.text("name");
  machine.kind = file.choice("kind", {"two-mirror", "gantry"}) == "gantry"
                     ? MachineDescription::Kind::kGantry
                     : MachineDescription::Kind::kTwoMirror;
  const DriveCatalogue catalogue = readCatalogueOf(file);
  machine.signals = readPins(file.section("pins"), machine.kind);
  machine.frame = readFrame(file);
  if (machine.kind == MachineDescription::Kind::kTwoMirror) {
    readTwoMirror(file, catalogue, machine);
  } else {
    readGantry(file, catalogue, machine);
  }
  machine.belt = readBelt(file.section("belt"), catalogue);
  auto beam = file.section("beam");
  machine.beam = readBeam(beam);
  result.beam_radius_sigma =
      kPercent *
      beam.number("waist_radius_percent", {.min = 0.5, .max = 30, .fallback = kUsualRadius_percent});
  machine.surface = readSurface(file.section("surface"));
  machine.laser = readLaser(file.section("laser"));
  machine.power_monitor = readPowerMonitor(file.section("power_monitor"));
  readCameras(file.section("cameras"), result, path);
  machine.controller = readController(file.section("controller"), machine.kind);
  result.spread = readSpread(file.section("imperfections"));
  file.finish();
  result.inputs = file.inputs();
  result.keys = file.asked();
  for (const base::YamlReader::Asked& asked : result.keys) {
    for (std::string key = asked.key;; key.resize(key.rfind('.'))) {
      result.places.emplace(key, file.placeOf(key));
      if (key.find('.') == std::string::npos) break;
    }
    if (asked.given) result.given.insert(asked.key);
  }
  result.places.emplace("", file.placeOf("version"));
  const auto namedHere = [&](const std::string& key) {
    return !result.given.contains(key) || result.places.at(key).starts_with(path.string() + ":");
  };
  result.spot_camera.named_here = namedHere("cameras.spot.calibration");
  result.kerf_camera.named_here = namedHere("cameras.kerf.calibration");
  result.keys.insert(result.keys.end(), catalogue.keys.begin(), catalogue.keys.end());
  return result;
}

}  // namespace

MachineFile readMachineFile(const std::filesystem::path& path) {
  return readAll(base::YamlReader::openFile(path), path);
}

MachineFile readMachineText(const std::filesystem::path& path, const std::string& text) {
  return readAll(base::YamlReader::openText(path, text), path);
}

MachineDescription readMachine(const std::filesystem::path& path) { return readMachineFile(path).machine; }

}  // namespace kerfbench::machine_file
