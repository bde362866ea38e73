// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <variant>

#include "twin/base/pulse_timing.h"

namespace kerfbench::twin {

/// Closed position loop of a servo drive, on the motor's own encoder:
///
///     speed asked for = clamp(wn / (2 zeta) (command - q) + ff * command velocity, ± max_speed)
///     torque          = clamp(J 2 zeta wn (speed asked for - qd), ± max_torque), seen after current_lag_s
///
/// Without limits this is J (wn² (command - q) + 2 zeta wn (ff * command velocity - qd)): without feedforward
/// the axis trails a constant speed by the time 2 zeta / wn, the "tracking error" of a galvo's data sheet.
/// J is the inertia that the loop is tuned for: motor and load at the motor, with belt and sheet where it
/// moves them.
struct ServoDescription {
  double natural_frequency_rad_s{};  ///< wn; > 0 and below 0.2 / integrator step.
  double damping{0.7};               ///< zeta; 0.1 … 5.
  double velocity_feedforward{};     ///< Feedforward ff; 0: pure tracking delay; 1: none at constant speed.
  double feedforward_filter_s{0.5e-3};  ///< First-order filter of the command's velocity; > 0 if ff > 0.
  double max_torque{std::numeric_limits<double>::infinity()};  ///< Current limit, N m (motor); > 0.
  double max_speed{std::numeric_limits<double>::infinity()};   ///< Speed limit, rad/s (motor); > 0.
  double current_lag_s{};                                      ///< Time constant of the current loop; >= 0.
  double input_delay_s{};  ///< Dead time from a pulse to the loop (digital servos); >= 0.
};

/// Hybrid stepper with a subdivision (microstep) drive. The field pulls the rotor like a spring,
///
///     T = -T_h(w) sin(N_r (q - command)) - damping * qd - detent sin(4 N_r q)
///
/// and lets go when the load pulls it over: lost steps come out of the physics. The supply limits the torque
/// at speed: T_h(w) = T_h min(1, max(0, U - K_e |w|) / (sqrt(R² + (N_r w L)²) I)), K_e = T_h / I.
struct StepperDescription {
  double holding_torque_nm{};   ///< T_h; > 0.
  int rotor_teeth{50};          ///< N_r: 50 of a motor with 200 full steps a turn.
  double damping_nm_s{};        ///< Viscous and electromagnetic, N m s/rad; >= 0.
  double detent_torque_nm{};    ///< >= 0.
  double rated_current_a{1.0};  ///< I; > 0.
  double supply_v{std::numeric_limits<double>::infinity()};  ///< U; infinity: no limit at speed.
  double resistance_ohm{1.0};                                ///< R of a phase; > 0.
  double inductance_h{0.0};                                  ///< L of a phase; >= 0.
};

using DriveDescription = std::variant<ServoDescription, StepperDescription>;

/// Dry and viscous friction of a guide or a bearing. Below the dry limit it holds like a stiff spring and
/// never creeps; it slides with exactly the limit.
struct FrictionDescription {
  double coulomb{};         ///< Dry friction, N m, or N of a slide; >= 0.
  double viscous{};         ///< Viscous friction, N m s/rad, or N s/m; >= 0.
  double presliding{1e-6};  ///< Give before it breaks loose, rad or m; > 0.
};

/// A drive with PUL/DIR input and the axis behind it: motor, elastic transmission, load. Load units are rad
/// of a mirror or of the belt's roller, m of a slide (mm where the name says so). The feed's load is the
/// roller with belt and sheet; its motor is a body of its own.
///
/// No motion of motor and load may be faster than the 10 us step follows, 1e5 rad/s: with both free their
/// resonance is at sqrt(stiffness (1/load + load_per_motor²/motor)), and a friction that holds is a spring
/// of coulomb / presliding.
struct AxisDescription {
  DriverProfile profile;
  DriveDescription drive;
  /// Nominal step of one PUL at the load: rad of a mirror; mm of a slide or of the belt; > 0.
  double step{};
  double load_per_motor{1.0};  ///< Motion of the load for each rad of the motor: rad, or mm of a slide; > 0.
  double motor_inertia_kg_m2{};  ///< Inertia of the rotor and all that turns with it; > 0.
  double load_inertia{};  ///< Inertia: kg m² of a mirror; kg that a slide moves; > 0. Not used by the feed.
  double stiffness{};     ///< Stiffness of the transmission at the load, N m/rad or N/m; > 0.
  double stiffness_damping{};    ///< Damping of the transmission, N m s/rad or N s/m; >= 0.
  double backlash{};             ///< Full play at the load, rad or mm; >= 0.
  FrictionDescription friction;  ///< Friction of the load.
};

}  // namespace kerfbench::twin
