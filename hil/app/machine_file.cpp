// SPDX-License-Identifier: Apache-2.0
#include "hil/app/machine_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/yaml_reader.h"
#include "twin/cutter/machine_model.h"

namespace kerfbench::hil {
namespace {

using twin::AxisDescription;
using twin::MachineDescription;
using Profiles = std::map<std::string, DriverProfile>;

// A servo faster than this would be unstable or inexact at the integrator's step (10 us): wn h < 0.2.
constexpr double kMaxFrequency_hz = 0.2 / twin::MachineModel::kStep_s / (2.0 * std::numbers::pi);

// The cameras of the model take no other.
constexpr double kMinSide_px = 16;
constexpr double kMaxSide_px = 32768;

Profiles readProfiles(const std::filesystem::path& path) {
  constexpr double kMicro = 1e-6;
  auto file = YamlReader::openFile(path);
  Profiles profiles;
  for (YamlReader& entry : file.list("drivers")) {
    DriverProfile profile;
    profile.name = entry.text("name");
    profile.active_edge_rising = entry.choice("active_edge", {"rising", "falling"}, "rising") == "rising";
    profile.setup_s = kMicro * entry.number("setup_us", {.min = 0, .max = 1000});
    profile.hold_s = kMicro * entry.number("hold_us", {.min = 0, .max = 1000});
    profile.width_s = kMicro * entry.number("width_us", {.min = 0, .max = 1000});
    profile.space_s = kMicro * entry.number("space_us", {.min = 0, .max = 1000});
    (void)entry.text("source");  // Where the figures come from; for people.
    if (!profiles.emplace(profile.name, profile).second) {
      entry.fault("name", fmt::format("'{}' is there twice", profile.name));
    }
  }
  file.finish();
  return profiles;
}

twin::ServoDescription readServo(YamlReader& axis) {
  twin::ServoDescription servo;
  servo.natural_frequency_rad_s =
      2.0 * std::numbers::pi * axis.number("bandwidth_hz", {.min = 1, .max = kMaxFrequency_hz});
  servo.damping = axis.number("damping", {.min = 0.1, .max = 5, .fallback = 0.7});
  servo.velocity_feedforward = axis.number("velocity_feedforward", {.min = 0, .max = 1, .fallback = 0.0});
  servo.feedforward_filter_s =
      1e-3 * axis.number("feedforward_filter_ms", {.min = 0, .max = 100, .fallback = 0.5});
  servo.max_torque = axis.number("max_torque", {.min = 1e-9, .max = 1e9, .fallback = 1e9});
  return servo;
}

AxisDescription readAxis(YamlReader& axis, const Profiles& profiles, const char* step_key, double step_max,
                         const char* inertia_key) {
  AxisDescription result;
  const std::string driver = axis.text("driver");
  const auto profile = profiles.find(driver);
  if (profile != profiles.end()) {
    result.profile = profile->second;
  } else if (!driver.empty()) {
    axis.fault("driver", fmt::format("no driver '{}' in the file of drivers", driver));
  }
  result.servo = readServo(axis);
  result.step = axis.number(step_key, {.min = 1e-9, .max = step_max});
  if (inertia_key != nullptr) result.inertia = axis.number(inertia_key, {.min = 1e-10, .max = 1e4});
  return result;
}

std::optional<PinId> pinFromName(const std::string& name) {
  // "PA0": port letter and bit.
  if (name.size() < 3 || name.size() > 4 || name[0] != 'P' || name[1] < 'A' || name[1] > 'Z')
    return std::nullopt;
  int bit = 0;
  for (const char c : name.substr(2)) {
    if (c < '0' || c > '9') return std::nullopt;
    bit = 10 * bit + (c - '0');
  }
  if (bit > 15) return std::nullopt;
  return PinId{static_cast<std::uint16_t>(name[1] - 'A'), static_cast<std::uint16_t>(bit)};
}

// What no machine of this kind can do without; a pin that is forgotten would look like a firmware that is
// dead.
std::vector<Signal> neededSignals(MachineDescription::Kind kind) {
  std::vector<Signal> needed{Signal::kLaserGate, Signal::kEncoderA, Signal::kEncoderB, Signal::kPrintMark};
  if (kind == MachineDescription::Kind::kGantry) {
    needed.insert(needed.end(),
                  {Signal::kGantryXPul, Signal::kGantryXDir, Signal::kGantryYPul, Signal::kGantryYDir});
  } else {
    needed.insert(needed.end(),
                  {Signal::kGalvoXPul, Signal::kGalvoXDir, Signal::kGalvoYPul, Signal::kGalvoYDir});
  }
  return needed;
}

SignalMap readPins(YamlReader pins, MachineDescription::Kind kind) {
  SignalMap map;
  std::map<PinId, std::string_view> users;
  const std::vector<Signal> needed = neededSignals(kind);
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    const auto signal = static_cast<Signal>(i);
    const std::string_view name = signalName(signal);
    if (!pins.has(name)) {
      if (std::ranges::find(needed, signal) != needed.end()) pins.fault(name, "has no pin");
      continue;
    }
    const std::string pin_name = pins.text(name);
    const auto pin = pinFromName(pin_name);
    if (!pin) {
      pins.fault(name, fmt::format("'{}' is no pin like PA0", pin_name));
    } else if (!users.emplace(*pin, name).second) {
      pins.fault(name, fmt::format("{} is given to {} and to {}", pin_name, users[*pin], name));
    } else {
      map.assign(signal, *pin);
    }
  }
  return map;
}

void readTwoMirror(YamlReader& file, const Profiles& profiles, MachineDescription& machine) {
  auto optics = file.section("optics");
  machine.throw_mm = optics.number("throw_mm", {.min = 10, .max = 5000});
  machine.mirror_spacing_mm = optics.number("mirror_spacing_mm", {.min = 0, .max = 500});
  auto galvo_x = file.section("galvo_x");
  auto galvo_y = file.section("galvo_y");
  machine.galvo_x = readAxis(galvo_x, profiles, "step_rad", 0.1, "inertia_kg_m2");
  machine.galvo_y = readAxis(galvo_y, profiles, "step_rad", 0.1, "inertia_kg_m2");
}

void readGantry(YamlReader& file, const Profiles& profiles, MachineDescription& machine) {
  auto gantry_x = file.section("gantry_x");
  auto gantry_y = file.section("gantry_y");
  machine.gantry_x = readAxis(gantry_x, profiles, "step_mm", 10, "mass_kg");
  machine.gantry_y = readAxis(gantry_y, profiles, "step_mm", 10, "mass_kg");
  if (machine.gantry_x.inertia <= machine.gantry_y.inertia) {
    gantry_x.fault("mass_kg", "the bridge carries the carriage: it must be heavier than gantry_y.mass_kg");
  }
  auto travel = file.section("travel");
  const auto x = travel.numbers("x_mm", 2);
  const auto y = travel.numbers("y_mm", 2);
  machine.travel_min_mm = {x[0], y[0]};
  machine.travel_max_mm = {x[1], y[1]};
  if (x[0] >= x[1]) travel.fault("x_mm", "the second value must be the larger");
  if (y[0] >= y[1]) travel.fault("y_mm", "the second value must be the larger");
}

twin::BeltDescription readBelt(YamlReader belt, const Profiles& profiles) {
  twin::BeltDescription result;
  result.roller_radius_mm = belt.number("roller_radius_mm", {.min = 1, .max = 1000});
  result.roller_inertia_kg_m2 = belt.number("roller_inertia_kg_m2", {.min = 1e-6, .max = 100});
  result.encoder_count_mm = belt.number("encoder_count_mm", {.min = 1e-4, .max = 10});
  result.print_mark_sensor_x_mm = belt.number("print_mark_sensor_x_mm", {.min = -1e4, .max = 1e4});
  auto line = belt.section("line_drive");
  result.line_servo = readServo(line);
  if (belt.has("feed")) {
    auto feed = belt.section("feed");
    result.feed = readAxis(feed, profiles, "step_mm", 10, nullptr);
    result.feed.inertia = result.roller_inertia_kg_m2;
  }
  return result;
}

// An exposure is put together from whole steps of the machine and must end before the next one begins.
void checkExposure(YamlReader& camera, const twin::CameraDescription& description) {
  const double steps = description.exposure_s / twin::MachineModel::kStep_s;
  if (std::abs(steps - std::round(steps)) > 1e-6) {
    camera.fault("exposure_us", fmt::format("must be a multiple of {:g}, the machine's step",
                                            1e6 * twin::MachineModel::kStep_s));
  }
  if (description.exposure_s > description.frame_period_s) {
    camera.fault("exposure_us", "is longer than the time from frame to frame");
  }
}

twin::CameraDescription readCamera(YamlReader& camera, bool timed) {
  twin::CameraDescription result;
  auto size = camera.numbers("size_px", 2);
  for (double& side_px : size) {
    if (side_px == std::floor(side_px) && side_px >= kMinSide_px && side_px <= kMaxSide_px) continue;
    camera.fault("size_px",
                 fmt::format("{} is no whole number of {} … {}", side_px, kMinSide_px, kMaxSide_px));
    side_px = kMinSide_px;
  }
  result.width_px = static_cast<int>(size[0]);
  result.height_px = static_cast<int>(size[1]);
  const double pitch_mm = camera.number("pitch_mm", {.min = 1e-3, .max = 10});
  const double height_mm = camera.number("height_mm", {.min = 10, .max = 1e4});
  const auto centre_mm = camera.numbers("centre_mm", 2, std::vector<double>{0, 0});
  const double tilt_rad =
      std::numbers::pi / 180.0 * camera.number("tilt_deg", {.min = -30, .max = 30, .fallback = 0.0});
  const auto distortion = camera.numbers("distortion", 5, std::vector<double>(5, 0.0));
  std::ranges::copy(distortion, result.distortion.begin());
  result.fx_px = result.fy_px = height_mm / pitch_mm;
  result.cx_px = 0.5 * (size[0] - 1);
  result.cy_px = 0.5 * (size[1] - 1);
  // Above the point it looks at, image x along +x of the plane, image y along -y, tilted about the camera's
  // own x.
  Eigen::Matrix3d down;
  down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  const Eigen::Matrix3d tilt = Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitX()).toRotationMatrix();
  result.X_CP.linear() = tilt * down;
  result.X_CP.translation() = Eigen::Vector3d(0, 0, height_mm) -
                              result.X_CP.linear() * Eigen::Vector3d(centre_mm[0], centre_mm[1], 0.0);
  result.psf_sigma_px = camera.number("psf_sigma_px", {.min = 0, .max = 2, .fallback = 0.6});
  result.read_noise = camera.number("read_noise_gray", {.min = 0, .max = 50, .fallback = 0.8});
  result.full_well_electrons =
      camera.number("full_well_electrons", {.min = 100, .max = 1e7, .fallback = 1e4});
  if (timed) {
    result.board_gray = camera.number("board_gray", {.min = 0, .max = 250, .fallback = 110.0});
    result.frame_period_s = 1.0 / camera.number("frames_per_s", {.min = 1, .max = 20000});
    result.exposure_s = 1e-6 * camera.number("exposure_us", {.min = 10, .max = 1e5});
    checkExposure(camera, result);
  }
  return result;
}

twin::ControllerDescription readController(YamlReader told, MachineDescription::Kind kind) {
  twin::ControllerDescription result;
  if (kind == MachineDescription::Kind::kTwoMirror) {
    result.throw_mm = told.number("throw_mm", {.min = 10, .max = 5000});
    result.mirror_spacing_mm = told.number("mirror_spacing_mm", {.min = 0, .max = 500});
    result.mirror_step_rad = told.number("mirror_step_rad", {.min = 1e-9, .max = 0.1});
  } else {
    result.gantry_step_mm = told.number("gantry_step_mm", {.min = 1e-6, .max = 10});
  }
  const auto x = told.numbers("field_x_mm", 2);
  const auto y = told.numbers("field_y_mm", 2);
  if (x[0] >= x[1]) told.fault("field_x_mm", "the second value must be the larger");
  if (y[0] >= y[1]) told.fault("field_y_mm", "the second value must be the larger");
  result.field_min_mm = {x[0], y[0]};
  result.field_max_mm = {x[1], y[1]};
  result.tracking_delay_s = 1e-3 * told.number("tracking_delay_ms", {.min = 0, .max = 5});
  result.encoder_count_mm = told.number("encoder_count_mm", {.min = 1e-4, .max = 10});
  result.print_mark_sensor_x_mm = told.number("print_mark_sensor_x_mm", {.min = -1e4, .max = 1e4});
  result.feed_step_mm = told.number("feed_step_mm", {.min = 0, .max = 10, .fallback = 0.0});
  result.full_power_w = told.number("full_power_w", {.min = 0.1, .max = 1e5});
  return result;
}

}  // namespace

MachineDescription readMachine(const std::filesystem::path& path) {
  auto file = YamlReader::openFile(path);
  MachineDescription machine;
  if (file.integer("version", {.min = 1, .max = 1e6}) != 1)
    file.fault("version", "this program reads version 1");
  machine.name = file.text("name");
  machine.kind = file.choice("kind", {"two-mirror", "gantry"}) == "gantry"
                     ? MachineDescription::Kind::kGantry
                     : MachineDescription::Kind::kTwoMirror;
  const std::string drivers = file.text("drivers");
  const Profiles profiles = drivers.empty() ? Profiles{} : readProfiles(file.folderOf("drivers") / drivers);
  machine.signals = readPins(file.section("pins"), machine.kind);
  if (machine.kind == MachineDescription::Kind::kTwoMirror) {
    readTwoMirror(file, profiles, machine);
  } else {
    readGantry(file, profiles, machine);
  }
  machine.belt = readBelt(file.section("belt"), profiles);
  auto laser = file.section("laser");
  machine.laser.full_power_w = laser.number("full_power_w", {.min = 0.1, .max = 1e5});
  machine.laser.rise_time_s = 1e-6 * laser.number("rise_time_us", {.min = 0, .max = 1e4});
  machine.laser.gate_delay_s = 1e-6 * laser.number("gate_delay_us", {.min = 0, .max = 1e4, .fallback = 0.0});
  machine.spot_radius_mm = laser.number("spot_radius_mm", {.min = 0.032, .max = 5});
  auto cameras = file.section("cameras");
  auto spot = cameras.section("spot");
  auto kerf = cameras.section("kerf");
  machine.glow_gray_per_w = spot.number("glow_gray_per_w", {.min = 0.01, .max = 1000});
  machine.spot_camera = readCamera(spot, true);
  machine.kerf_camera = readCamera(kerf, false);
  machine.controller = readController(file.section("controller"), machine.kind);
  file.finish();
  return machine;
}

}  // namespace kerfbench::hil
