// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "twin/base/print_layout.h"
#include "twin/base/pulse_timing.h"
#include "twin/base/signal_map.h"
#include "twin/camera/camera.h"
#include "twin/drive/servo.h"
#include "twin/drive/speed_profile.h"
#include "twin/laser/laser.h"
#include "twin/sheet/sheet.h"

namespace kerfbench::twin {

/// A drive with PUL/DIR input and the axis behind it.
struct AxisDescription {
  DriverProfile profile;
  ServoDescription servo;
  double step{};     ///< One PUL: rad of a mirror, mm of a gantry or of the belt; > 0.
  double inertia{};  ///< kg m² of rotor and mirror; kg of a gantry's moving part; > 0.
};

/// Conveyor with its drive roller and encoder.
struct BeltDescription {
  double roller_radius_mm{30.0};
  double roller_inertia_kg_m2{2e-3};  ///< With the belt and the sheet on it.
  ServoDescription line_servo;        ///< Of the line's own drive.
  AxisDescription feed;               ///< Of the drive that the controller's feed pulses move.
  double encoder_count_mm{0.01};      ///< Belt travel of one quadrature count.
  double print_mark_sensor_x_mm{};    ///< In W.
};

/// What the reference controller is told of this machine: the data sheet, not the truth. A difference from
/// the rest of the description is an error of commissioning that the bench must see.
struct ControllerDescription {
  double throw_mm{};
  double mirror_spacing_mm{};
  double mirror_step_rad{};
  double gantry_step_mm{};
  std::array<double, 2> field_min_mm{};
  std::array<double, 2> field_max_mm{};
  double tracking_delay_s{};
  double encoder_count_mm{};
  double print_mark_sensor_x_mm{};
  double feed_step_mm{};
  double full_power_w{};
};

/// A laser die-cutter. Constant; what moves is in Twin.
struct MachineDescription {
  enum class Kind { kTwoMirror, kGantry };
  std::string name;
  Kind kind{Kind::kTwoMirror};
  SignalMap signals;
  // Two mirrors
  double throw_mm{};
  double mirror_spacing_mm{};
  AxisDescription galvo_x, galvo_y;
  // Gantry
  AxisDescription gantry_x, gantry_y;
  std::array<double, 2> travel_min_mm{};  ///< Limit switches trip beyond.
  std::array<double, 2> travel_max_mm{};
  // Both
  BeltDescription belt;
  LaserDescription laser;
  double spot_radius_mm{0.105};  ///< 1/e² radius of the beam on the sheet at normal incidence.
  CameraDescription spot_camera;
  CameraDescription kerf_camera;
  double glow_gray_per_w{4.0};  ///< Peak grey that the glowing spot adds for each watt, in the spot camera.
  ControllerDescription controller;
};

/// What runs through the machine.
struct WebDescription {
  PrintLayout print;
  BoardDescription board;
  double start_x_mm{};       ///< x_W of unit 0's origin S at t = 0.
  double belt_speed_mm_s{};  ///< Of the line drive at t = 0; ignored when the controller feeds.
  std::vector<SpeedPoint>
      belt_speed_changes;    ///< Later speeds of the line, see SpeedProfile; none: constant.
  bool fed_by_controller{};  ///< The feed pulses move the belt.
};

}  // namespace kerfbench::twin
