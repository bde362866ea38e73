// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "hil/base/yaml_reader.h"
#include "twin/base/pulse_timing.h"
#include "twin/drive/drive_description.h"

namespace kerfbench::machine_file {

inline constexpr double kMicro = 1e-6;
inline constexpr double kMilli = 1e-3;

/// Data sheet of a galvo with its mirror. Mechanical angles.
struct GalvoDataSheet {
  double small_angle_rad{};  ///< Amplitude of the small step and of the small sine.
  double small_step_s{};     ///< Time in which a step by that angle settles.
  double small_sine_hz{};    ///< Bandwidth at that angle: not more than 3 dB are lost.
  double full_angle_rad{};   ///< Amplitude of full travel.
  double full_sine_hz{};     ///< Frequency of a sine that is followed over full travel.
  double half_sine_hz{};     ///< Frequency of a sine that is followed over half of the travel.
  double full_square_hz{};   ///< Frequency of a square wave that is followed over full travel.
  double half_square_hz{};   ///< Frequency of a square wave that is followed over half of the travel.
  double repeatability_rad{};
};

/// A servo motor with its drive.
struct ServoProfile {
  twin::ServoDescription servo;
  double motor_inertia_kg_m2{};
  /// The current limit as the acceleration of motor and load together, rad/s² of the motor; then it is not in
  /// `servo`.
  double max_acceleration_rad_s2{std::numeric_limits<double>::infinity()};
  std::optional<GalvoDataSheet> data_sheet;
};

/// A stepper motor with its drive.
struct StepperProfile {
  twin::StepperDescription stepper;
  double motor_inertia_kg_m2{};
  int subdivision{1};  ///< Pulses for a full step.
};

/// Data sheets of drives, by name.
struct DriveCatalogue {
  std::map<std::string, DriverProfile> drivers;  ///< Requirements of PUL/DIR inputs on their pulses.
  std::map<std::string, ServoProfile> servos;
  std::map<std::string, StepperProfile> steppers;
  std::vector<base::YamlReader::Asked> keys;
};

/// Reads a catalogue (fixtures/machines/drivers.yaml).
/// @throws ConfigError with every fault, each with file and line.
DriveCatalogue readCatalogue(const std::filesystem::path& path);

/// Reads the keys of a servo; what is not given is as in `known`, if any, else required or at its default.
ServoProfile readServo(base::YamlReader& section, const ServoProfile* known, bool with_motor);
/// Reads the keys of a stepper, in the same manner as those of a servo.
StepperProfile readStepper(base::YamlReader& section, const StepperProfile* known);

}  // namespace kerfbench::machine_file
