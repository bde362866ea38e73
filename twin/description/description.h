// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "twin/base/print_layout.h"
#include "twin/base/pulse_timing.h"
#include "twin/base/signal_map.h"
#include "twin/camera/camera.h"
#include "twin/drive/drive_description.h"
#include "twin/drive/speed_profile.h"
#include "twin/laser/laser.h"
#include "twin/optics/optics_description.h"
#include "twin/sheet/sheet.h"

namespace kerfbench::twin {

/// The frame that carries the head, on its feet: the gantry's reaction shakes it.
struct FrameDescription {
  double mass_kg{};                       ///< Mass without the gantry's moving parts; > 0.
  std::array<double, 2> stiffness_n_m{};  ///< Stiffness of all feet together, along x and y; > 0.
  std::array<double, 2> damping_n_s_m{};  ///< >= 0
};

/// Quadrature encoder on the belt's roller. It sees neither the belt's stretch nor the sheet's slip.
struct EncoderDescription {
  double count_mm{0.01};   ///< Belt travel of one count (four a line); > 0.
  double jitter_counts{};  ///< Standard deviation of each edge's place, in counts; 0 … 0.2.
  double runout_mm{};      ///< Amplitude of the error of belt travel once a turn, from an eccentric mounting.
  double runout_phase_rad{};
};

/// Sensor of the printed eye mark of each unit.
struct PrintMarkSensorDescription {
  double x_mm{};           ///< Place in W.
  double jitter_mm{};      ///< Standard deviation of the place where an edge is seen.
  double hysteresis_mm{};  ///< Delay of an edge that is seen backwards, of sheet travel.
};

/// Power meter behind a mirror: toggles a pin for each quantum of emitted energy.
struct PowerMonitorDescription {
  double quantum_j{5e-3};  ///< > 0
  double delay_s{1e-3};    ///< Time from emission to edge; at least the lockstep's quantum.
  double scale{1.0};       ///< Scale of its calibration.
};

/// Conveyor: drive roller, belt, and the sheet that lies on it.
struct BeltDescription {
  double roller_radius_mm{30.0};
  /// Inertia with the line's motor, at the roller; without belt and feed. > 0.
  double roller_inertia_kg_m2{2e-3};
  double mass_kg{0.5};        ///< Mass of the belt; > 0.
  double stiffness_n_m{2e5};  ///< Elastic creep between roller and belt; > 0.
  double damping_n_s_m{200.0};
  FrictionDescription bed_friction;  ///< Friction of the belt on its bed, N.
  double sheet_mass_kg{0.05};        ///< Mass of the board that lies on the belt; > 0.
  double sheet_friction{0.6};        ///< Coulomb coefficient of sheet on belt (vacuum counts as more); > 0.
  std::array<double, 2> sheet_drag_n{};  ///< Pull at the sheet along x and y: a brush, a doctor blade.
  ServoDescription line_servo;           ///< Drive of the line itself, on the roller.
  AxisDescription feed;                  ///< Drive that the controller's feed pulses move.
  EncoderDescription encoder;
  PrintMarkSensorDescription print_mark_sensor;
};

/// Configuration of the reference controller for this machine: the data sheet, not the truth. A difference
/// from the rest of the description is an error of commissioning that the bench must see.
struct ControllerDescription {
  double throw_mm{};
  double mirror_spacing_mm{};
  double mirror_step_rad{};
  double focal_length_mm{};             ///< Focal length of an f-theta lens; 0: a head without one.
  std::string correction_file{};        ///< Correction table of what the head's formula leaves; empty: none.
  double mirror_acceleration_rad_s2{};  ///< Acceleration of each mirror, mechanical; 0: never the limit.
  // Steppers of the mirrors.
  double full_step_pulses{};    ///< Pulses for a full step; 0: the rotors are left to themselves.
  double detent_share{};        ///< Detent torque over holding torque.
  double rotor_resonance_hz{};  ///< Frequency of the rotor in its field; 0: not known.
  double rotor_damping{};       ///< Share of critical, of the same.
  double gantry_step_mm{};
  /// Radius of the arcs of jumps; 0: straight jumps; -1: chosen by the size of the drawing.
  double jump_radius_mm{};
  std::array<double, 2> field_min_mm{};
  std::array<double, 2> field_max_mm{};
  double tracking_delay_s{};
  double encoder_count_mm{};
  double print_mark_sensor_x_mm{};
  double feed_step_mm{};
  double full_power_w{};
  double power_quantum_j{};  ///< Quantum of the power monitor; 0: the controller has none.
  double power_delay_s{};
  double laser_lag_s{};  ///< Lag of the power behind the controller's PWM.
};

/// The lot of board that lies on the machine, against the board's data sheet.
struct BoardLot {
  double thickness{1.0};  ///< Factor, > 0; so are the others.
  double transmission{1.0};
  double cut_fluence{1.0};
  /// Where the plate prints registration marks, on all units alike: standard deviation for each and each way,
  /// mm, and the seed that it is drawn with.
  double print_mm{0.0};
  std::uint64_t print_seed{0};
  double swelling{0.0};  ///< Relative: how much it has grown since it was cut when it is inspected.
};

/// A laser die-cutter. Constant; the moving state is in Twin.
struct MachineDescription {
  enum class Kind { kTwoMirror, kGantry };
  std::string name;
  Kind kind{Kind::kTwoMirror};
  SignalMap signals;
  std::optional<FrameDescription> frame;  ///< The frame; absent: the head does not move.
  // Two mirrors
  ScanHeadDescription head;
  AxisDescription galvo_x, galvo_y;
  // Gantry
  AxisDescription gantry_x, gantry_y;
  double squareness_rad{};                ///< Lean of gantry y towards -x.
  std::array<double, 2> travel_min_mm{};  ///< Lower ends of travel; limit switches trip beyond.
  std::array<double, 2> travel_max_mm{};
  // All machines
  BeltDescription belt;
  BeamDescription beam;
  SurfaceDescription surface;
  LaserDescription laser;
  PowerMonitorDescription power_monitor;
  CameraDescription spot_camera;
  CameraDescription kerf_camera;
  InspectionTableDescription inspection_table;
  BoardLot board_lot;
  double glow_gray_per_w{4.0};  ///< Peak grey that the glowing spot adds for each watt, in the spot camera.
  ControllerDescription controller;
};

/// The web that runs through the machine.
struct WebDescription {
  PrintLayout print;
  BoardDescription board;
  double start_x_mm{};       ///< x_W of unit 0's origin S at t = 0.
  double belt_speed_mm_s{};  ///< Speed of the line drive at t = 0; ignored when the controller feeds.
  /// Later speeds of the line, see SpeedProfile; none: constant.
  std::vector<SpeedPoint> belt_speed_changes;
  bool fed_by_controller{};  ///< True if the controller's feed pulses move the belt.
};

}  // namespace kerfbench::twin
