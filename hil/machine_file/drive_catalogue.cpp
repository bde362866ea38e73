// SPDX-License-Identifier: Apache-2.0
#include "hil/machine_file/drive_catalogue.h"

#include <fmt/format.h>

#include <numbers>

#include "twin/base/constants.h"
#include "twin/cutter/machine_model.h"

namespace kerfbench::machine_file {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kDegree_rad = std::numbers::pi / 180.0;

// A servo faster than this would be unstable or inexact at the integrator's step (10 us): wn h < 0.2.
constexpr double kMaxFrequency_hz = 0.2 / twin::MachineModel::kStep_s / kTurn_rad;

using Fallback = std::optional<double>;

DriverProfile readDriver(base::YamlReader& entry) {
  DriverProfile profile;
  profile.name = entry.text("name");
  profile.active_edge_rising = entry.choice("active_edge", {"rising", "falling"}, "rising") == "rising";
  profile.setup_s = kMicro * entry.number("setup_us", {.min = 0, .max = 1000});
  profile.hold_s = kMicro * entry.number("hold_us", {.min = 0, .max = 1000});
  profile.width_s = kMicro * entry.number("width_us", {.min = 0, .max = 1000});
  profile.space_s = kMicro * entry.number("space_us", {.min = 0, .max = 1000});
  profile.enable_setup_s = kMicro * entry.number("enable_setup_us", {.min = 0, .max = 1e6, .fallback = 0.0});
  return profile;
}

GalvoDataSheet readDataSheet(base::YamlReader sheet) {
  GalvoDataSheet result;
  result.small_angle_rad = kDegree_rad * sheet.number("small_angle_deg", {.min = 0.01, .max = 5});
  result.small_step_s = kMicro * sheet.number("small_step_us", {.min = 10, .max = 1e5});
  result.small_sine_hz = sheet.number("small_sine_hz", {.min = 1, .max = 1e4});
  result.full_angle_rad = kDegree_rad * sheet.number("full_angle_deg", {.min = 1, .max = 45});
  result.full_sine_hz = sheet.number("full_sine_hz", {.min = 1, .max = 1e4});
  result.half_sine_hz = sheet.number("half_sine_hz", {.min = 1, .max = 1e4});
  result.full_square_hz = sheet.number("full_square_hz", {.min = 1, .max = 1e4});
  result.half_square_hz = sheet.number("half_square_hz", {.min = 1, .max = 1e4});
  result.repeatability_rad = kMicro * sheet.number("repeatability_urad", {.min = 0.1, .max = 1e4});
  return result;
}

template <typename Profile, typename Read>
std::map<std::string, Profile> readAll(base::YamlReader& file, std::string_view list, Read read) {
  std::map<std::string, Profile> profiles;
  for (base::YamlReader& entry : file.list(list)) {
    const std::string name = entry.text("name");
    (void)entry.text("source");  // Where the figures come from; for people.
    if (!profiles.emplace(name, read(entry)).second)
      entry.fault("name", fmt::format("'{}' is there twice", name));
  }
  return profiles;
}

}  // namespace

ServoProfile readServo(base::YamlReader& section, const ServoProfile* known, bool with_motor) {
  const ServoProfile none;
  const ServoProfile& base = known != nullptr ? *known : none;
  const twin::ServoDescription& servo = base.servo;
  ServoProfile result;
  const Fallback bandwidth =
      known == nullptr ? std::nullopt : Fallback(servo.natural_frequency_rad_s / kTurn_rad);
  result.servo.natural_frequency_rad_s =
      kTurn_rad *
      section.number("bandwidth_hz", {.min = 0.1, .max = kMaxFrequency_hz, .fallback = bandwidth});
  result.servo.damping = section.number("damping", {.min = 0.1, .max = 5, .fallback = servo.damping});
  result.servo.velocity_feedforward =
      section.number("velocity_feedforward", {.min = 0, .max = 1, .fallback = servo.velocity_feedforward});
  result.servo.feedforward_filter_s =
      kMilli * section.number("feedforward_filter_ms",
                              {.min = 0.01, .max = 100, .fallback = servo.feedforward_filter_s / kMilli});
  result.servo.max_torque =
      section.number("max_torque_n_m", {.min = 1e-6, .max = 1e4, .fallback = servo.max_torque});
  result.servo.max_speed =
      section.number("max_speed_rad_s", {.min = 1e-3, .max = 1e5, .fallback = servo.max_speed});
  result.servo.current_lag_s =
      kMicro *
      section.number("current_lag_us", {.min = 0, .max = 1e4, .fallback = servo.current_lag_s / kMicro});
  result.servo.input_delay_s =
      kMicro *
      section.number("input_delay_us", {.min = 0, .max = 1e4, .fallback = servo.input_delay_s / kMicro});
  if (!with_motor) return result;
  result.max_acceleration_rad_s2 = section.number(
      "max_acceleration_rad_s2", {.min = 1e-3, .max = 1e8, .fallback = base.max_acceleration_rad_s2});
  if (section.has("max_torque_n_m") && section.has("max_acceleration_rad_s2")) {
    section.fault("max_acceleration_rad_s2", "is given beside max_torque_n_m: one of them is enough");
  } else if (section.has("max_torque_n_m")) {
    result.max_acceleration_rad_s2 = kInfinity;
  } else if (section.has("max_acceleration_rad_s2")) {
    result.servo.max_torque = kInfinity;
  }
  result.motor_inertia_kg_m2 =
      section.number("motor_inertia_kg_m2",
                     {.min = 1e-9,
                      .max = 1,
                      .fallback = known == nullptr ? std::nullopt : Fallback(base.motor_inertia_kg_m2)});
  return result;
}

StepperProfile readStepper(base::YamlReader& section, const StepperProfile* known) {
  const auto fallback = [known](auto member, double unit) -> Fallback {
    return known == nullptr ? std::nullopt : Fallback(known->stepper.*member / unit);
  };
  using Stepper = twin::StepperDescription;
  const Stepper none;
  const Stepper& base = known != nullptr ? known->stepper : none;
  StepperProfile result;
  Stepper& stepper = result.stepper;
  stepper.holding_torque_nm =
      section.number("holding_torque_n_m",
                     {.min = 1e-4, .max = 100, .fallback = fallback(&Stepper::holding_torque_nm, 1.0)});
  stepper.rotor_teeth = static_cast<int>(section.integer(
      "rotor_teeth", {.min = 1, .max = 500, .fallback = static_cast<double>(base.rotor_teeth)}));
  stepper.damping_nm_s =
      section.number("damping_n_m_s", {.min = 0, .max = 10, .fallback = base.damping_nm_s});
  stepper.detent_torque_nm =
      section.number("detent_torque_n_m", {.min = 0, .max = 10, .fallback = base.detent_torque_nm});
  stepper.rated_current_a = section.number(
      "rated_current_a", {.min = 0.01, .max = 50, .fallback = fallback(&Stepper::rated_current_a, 1.0)});
  stepper.resistance_ohm = section.number(
      "resistance_ohm", {.min = 1e-3, .max = 1e3, .fallback = fallback(&Stepper::resistance_ohm, 1.0)});
  stepper.inductance_h =
      kMilli * section.number("inductance_mh",
                              {.min = 0, .max = 1e3, .fallback = fallback(&Stepper::inductance_h, kMilli)});
  stepper.supply_v = section.number("supply_v", {.min = 1, .max = 1000, .fallback = base.supply_v});
  result.motor_inertia_kg_m2 =
      section.number("motor_inertia_kg_m2",
                     {.min = 1e-9,
                      .max = 1,
                      .fallback = known == nullptr ? std::nullopt : Fallback(known->motor_inertia_kg_m2)});
  result.subdivision = static_cast<int>(section.integer(
      "subdivision",
      {.min = 1, .max = 1024, .fallback = known == nullptr ? std::nullopt : Fallback(known->subdivision)}));
  if (stepper.detent_torque_nm >= stepper.holding_torque_nm && stepper.holding_torque_nm > 0) {
    section.fault("detent_torque_n_m", "must be less than holding_torque_n_m");
  }
  return result;
}

DriveCatalogue readCatalogue(const std::filesystem::path& path) {
  auto file = base::YamlReader::openFile(path);
  DriveCatalogue catalogue;
  catalogue.drivers = readAll<DriverProfile>(file, "drivers", readDriver);
  catalogue.servos = readAll<ServoProfile>(file, "servos", [](base::YamlReader& entry) {
    ServoProfile profile = readServo(entry, nullptr, true);
    if (entry.has("data_sheet")) profile.data_sheet = readDataSheet(entry.section("data_sheet"));
    return profile;
  });
  catalogue.steppers = readAll<StepperProfile>(
      file, "steppers", [](base::YamlReader& entry) { return readStepper(entry, nullptr); });
  file.finish();
  catalogue.keys = file.asked();
  return catalogue;
}

}  // namespace kerfbench::machine_file
