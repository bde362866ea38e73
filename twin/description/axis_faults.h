// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "twin/description/fault_list.h"
#include "twin/drive/drive_description.h"

namespace kerfbench::twin {

/// Load of an axis, in SI units.
struct AxisLoad {
  std::string inertia_unit;   ///< Unit of `inertia`: "kg" of a slide, "kg m²" of a rotor.
  double inertia{};           ///< kg or kg m²
  double per_motor{};         ///< Motion of the load for each rad of the motor, m or rad.
  double friction{};          ///< Dry friction that the motor has to overcome, N or N m.
  std::string friction_unit;  ///< "N" or "N m"
  double most_step{};         ///< Largest step of a pulse, in the unit of AxisDescription::step.
  std::string step_unit;      ///< "rad" or "mm"
  double most_backlash{};     ///< Largest backlash, in the unit of AxisDescription::backlash.
  std::string backlash_unit;  ///< "rad" or "mm"
};

/// Limit for the product of a natural frequency and the integrator's step; more is a fault. The fourth-order
/// Runge-Kutta method is stable up to 2.8, but at 0.4 it already errs by (w h)^4 / 120 = 2e-4 of the
/// frequency and damps by (w h)^5 / 144 = 7e-5 of critical, a hundredth of a coupling's own damping. At 10 us
/// the limit is 6.4 kHz.
inline constexpr double kMostPerStep = 0.4;

/// Finds everything that is impossible in a servo on `axis`, in any axis that pulses move, and in a swinging
/// pair of masses (kg, or kg m²) on a spring (N/m, or N m/rad).
void findServoFaults(FaultList& faults, const std::string& name, const ServoDescription& servo,
                     double step_s);
void findAxisFaults(FaultList& faults, const std::string& name, const AxisDescription& axis,
                    const AxisLoad& load, double step_s);
void requireResolved(FaultList& faults, const std::string& what, double stiffness, double mass_a,
                     double mass_b, double step_s);

/// A servo whose motor carries a load on a spring; all values referred to the motor.
struct ServoOnSpring {
  double motor_inertia{}, load_inertia{};  ///< kg m²
  double stiffness{}, damping{};           ///< N m/rad, N m s/rad
};
void requireQuietServo(FaultList& faults, const std::string& name, const ServoDescription& servo,
                       const ServoOnSpring& plant);

}  // namespace kerfbench::twin
