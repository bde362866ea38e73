// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "twin/description/fault_list.h"
#include "twin/drive/drive_description.h"

namespace kerfbench::twin {

/// What an axis moves, in SI units at the load.
struct AxisLoad {
  std::string inertia_unit;   ///< "kg" of a slide, "kg m²" of what turns.
  double inertia{};           ///< kg or kg m²
  double per_motor{};         ///< m or rad of the load for each rad of the motor.
  double friction{};          ///< Dry friction that the motor has to overcome, N or N m.
  std::string friction_unit;  ///< "N" or "N m"
  double most_step{};         ///< Largest step of a pulse, in the unit of AxisDescription::step.
  std::string step_unit;      ///< "rad" or "mm"
  double most_backlash{};     ///< Likewise.
  std::string backlash_unit;  ///< "rad" or "mm"
};

/// Products of a natural frequency and the integrator's step above this are faults: the fourth-order
/// Runge-Kutta method is stable up to 2.8, but at 0.4 it already errs by (w h)^4 / 120 = 2e-4 of the
/// frequency and damps by (w h)^5 / 144 = 7e-5 of critical, a hundredth of what a coupling has by itself. At
/// 10 us this is 6.4 kHz.
inline constexpr double kMostPerStep = 0.4;

/// Everything that cannot be of a servo on `axis`, of any axis that pulses move, and of a swinging pair of
/// masses (kg, or kg m²) on a spring (N/m, or N m/rad).
void findServoFaults(FaultList& faults, const std::string& name, const ServoDescription& servo,
                     double step_s);
void findAxisFaults(FaultList& faults, const std::string& name, const AxisDescription& axis,
                    const AxisLoad& load, double step_s);
void requireResolved(FaultList& faults, const std::string& what, double stiffness, double mass_a,
                     double mass_b, double step_s);

/// A servo whose motor carries a load on a spring: everything as felt by the motor.
struct ServoOnSpring {
  double motor_inertia{}, load_inertia{};  ///< kg m²
  double stiffness{}, damping{};           ///< N m/rad, N m s/rad
};
void requireQuietServo(FaultList& faults, const std::string& name, const ServoDescription& servo,
                       const ServoOnSpring& plant);

}  // namespace kerfbench::twin
