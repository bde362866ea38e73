// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>

#include "hil/machine_file/machine_sections.h"
#include "twin/base/constants.h"
#include "twin/cutter/machine_model.h"
#include "twin/description/axis_faults.h"

namespace kerfbench::machine_file {
namespace {

using twin::AxisDescription;

constexpr int kFullStepsPerTooth = 4;

// A resonance above this would be inexact at the integrator's step.
constexpr double kMaxResonance_hz = twin::kMostPerStep / twin::MachineModel::kStep_s / kTurn_rad;

struct Names {
  const char* step;
  double step_unit;  // Unit of the key in the description's unit.
  double step_max;
  const char* inertia;
  double inertia_min, inertia_max;
  const char* stiffness;
  double stiffness_unit;
  const char* damping;
  const char* backlash;
  double backlash_unit;
  double backlash_max;
};

Names namesOf(Load load) {
  if (load == Load::kSlide) {
    return {
        "step_mm",     1.0, 10, "mass_kg", 0.01, 1e4, "stiffness_n_mm", kMetre_mm, "stiffness_damping_n_s_m",
        "backlash_mm", 1.0, 5};
  }
  Names names{"step_urad",         kMicro, 1e5,
              "inertia_kg_m2",     1e-9,   1,
              "stiffness_n_m_rad", 1.0,    "stiffness_damping_n_m_s_rad",
              "backlash_urad",     kMicro, 1e4};
  if (load == Load::kBelt) {
    names.step = "step_mm";
    names.step_unit = 1.0;
    names.step_max = 10;
  }
  return names;
}

template <typename Profile>
const Profile* findProfile(base::YamlReader& section, const std::map<std::string, Profile>& profiles) {
  if (!section.has("profile")) {
    (void)section.text("profile", "");
    return nullptr;
  }
  const std::string name = section.text("profile");
  const auto found = profiles.find(name);
  if (found != profiles.end()) return &found->second;
  section.fault("profile", fmt::format("no '{}' in the catalogue of drives", name));
  return nullptr;
}

// rad, or mm of a slide, for a radian of the motor.
double readTransmission(base::YamlReader& axis, Load load) {
  if (load != Load::kSlide) return axis.number("ratio", {.min = 1e-4, .max = 100, .fallback = 1.0});
  return axis.number("travel_per_turn_mm", {.min = 0.1, .max = 5000}) / kTurn_rad;
}

void readDrive(base::YamlReader& axis, Load load, const DriveCatalogue& catalogue, double roller_radius_mm,
               AxisDescription& result) {
  const Names names = namesOf(load);
  if (axis.has("servo") && axis.has("stepper"))
    axis.fault("stepper", "an axis has one drive: servo or stepper");
  if (axis.has("stepper")) {
    auto section = axis.section("stepper");
    const StepperProfile drive = readStepper(section, findProfile(section, catalogue.steppers));
    result.drive = drive.stepper;
    result.motor_inertia_kg_m2 = drive.motor_inertia_kg_m2;
    if (axis.has(names.step))
      axis.fault(names.step, "follows from the full steps and the subdivision of a stepper: leave it out");
    const double pulses =
        static_cast<double>(kFullStepsPerTooth) * drive.stepper.rotor_teeth * drive.subdivision;
    result.step = kTurn_rad / pulses * result.load_per_motor * (load == Load::kBelt ? roller_radius_mm : 1.0);
    return;
  }
  auto section = axis.section("servo");
  const ServoProfile drive = readServo(section, findProfile(section, catalogue.servos), true);
  twin::ServoDescription servo = drive.servo;
  result.motor_inertia_kg_m2 = drive.motor_inertia_kg_m2;
  if (std::isfinite(drive.max_acceleration_rad_s2)) {
    const double load_per_motor = result.load_per_motor / (load == Load::kSlide ? kMetre_mm : 1.0);
    servo.max_torque = drive.max_acceleration_rad_s2 *
                       (drive.motor_inertia_kg_m2 + result.load_inertia * load_per_motor * load_per_motor);
  }
  result.drive = servo;
  result.step = names.step_unit * axis.number(names.step, {.min = 1e-6, .max = names.step_max});
}

// Motor and load at the two ends of a spring, the motor as seen from the load: the mass that swings.
double swingingMass(const AxisDescription& axis, Load load) {
  const double load_per_motor = axis.load_per_motor / (load == Load::kSlide ? kMetre_mm : 1.0);
  const double motor = axis.motor_inertia_kg_m2 / (load_per_motor * load_per_motor);
  const double sum = motor + axis.load_inertia;
  return sum > 0 ? motor * axis.load_inertia / sum : 0.0;
}

void readTransmissionSpring(base::YamlReader& axis, Load load, AxisDescription& result) {
  const Names names = namesOf(load);
  const double mass = swingingMass(result, load);
  const base::YamlReader::Range frequency{.min = 1, .max = kMaxResonance_hz};
  if (axis.has(names.stiffness)) {
    result.stiffness = names.stiffness_unit * axis.number(names.stiffness, {.min = 1e-3, .max = 1e7});
    const double resonance_hz = mass > 0 ? std::sqrt(result.stiffness / mass) / kTurn_rad : 0.0;
    if (axis.has("resonance_hz")) {
      axis.fault("resonance_hz", fmt::format("is given beside {}: one of them is enough", names.stiffness));
    } else if (resonance_hz > kMaxResonance_hz) {
      axis.fault(names.stiffness,
                 fmt::format("motor and load would swing at {:.0f} Hz, more than {:.0f} that the "
                             "model's step can follow",
                             resonance_hz, kMaxResonance_hz));
    }
  } else {
    const double wn = kTurn_rad * axis.number("resonance_hz", frequency);
    result.stiffness = mass * wn * wn;
  }
  if (axis.has(names.damping)) {
    result.stiffness_damping = axis.number(names.damping, {.min = 0, .max = 1e6});
    if (axis.has("resonance_damping"))
      axis.fault("resonance_damping",
                 fmt::format("is given beside {}: one of them is enough", names.damping));
  } else {
    const double zeta = axis.number("resonance_damping", {.min = 0, .max = 1, .fallback = 0.01});
    result.stiffness_damping = 2.0 * zeta * std::sqrt(result.stiffness * mass);
  }
}

/// Levels of PUL, DIR and enable where the axis has them otherwise than the catalogue's driver: by its
/// wiring, or a switch on the drive.
void readPolarity(base::YamlReader& axis, DriverProfile& profile) {
  const char* const usual = profile.active_edge_rising ? "rising" : "falling";
  profile.active_edge_rising = axis.choice("active_edge", {"rising", "falling"}, usual) == "rising";
  profile.dir_low = axis.boolean("dir_low", false);
  profile.enable_low = axis.boolean("enable_low", false);
}

}  // namespace

twin::FrictionDescription readFriction(base::YamlReader friction, Load load) {
  twin::FrictionDescription result;
  const bool turns = load != Load::kSlide;
  const char* coulomb = turns ? "coulomb_n_m" : "coulomb_n";
  const char* viscous = turns ? "viscous_n_m_s_rad" : "viscous_n_s_m";
  const char* presliding = turns ? "presliding_urad" : "presliding_um";
  result.coulomb = friction.number(coulomb, {.min = 0, .max = 1e4, .fallback = 0.0});
  result.viscous = friction.number(viscous, {.min = 0, .max = 1e5, .fallback = 0.0});
  result.presliding =
      kMicro * friction.number(presliding, {.min = 0.01, .max = 1e4, .fallback = result.presliding / kMicro});
  return result;
}

twin::AxisDescription readAxis(base::YamlReader axis, Load load, const DriveCatalogue& catalogue,
                               double roller_inertia_kg_m2, double roller_radius_mm) {
  const Names names = namesOf(load);
  AxisDescription result;
  const std::string driver = axis.text("driver");
  const auto profile = catalogue.drivers.find(driver);
  if (profile != catalogue.drivers.end()) {
    result.profile = profile->second;
  } else if (!driver.empty()) {
    axis.fault("driver", fmt::format("no driver '{}' in the catalogue of drives", driver));
  }
  readPolarity(axis, result.profile);
  result.load_per_motor = readTransmission(axis, load);
  result.load_inertia =
      load == Load::kBelt ? roller_inertia_kg_m2
                          : axis.number(names.inertia, {.min = names.inertia_min, .max = names.inertia_max});
  readDrive(axis, load, catalogue, roller_radius_mm, result);
  readTransmissionSpring(axis, load, result);
  result.backlash = names.backlash_unit *
                    axis.number(names.backlash, {.min = 0, .max = names.backlash_max, .fallback = 0.0});
  result.friction = readFriction(axis.section("friction"), load);
  return result;
}

}  // namespace kerfbench::machine_file
