// SPDX-License-Identifier: Apache-2.0
#include "twin/description/axis_faults.h"

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <variant>

#include "twin/base/general_eigen.h"

namespace kerfbench::twin {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kMostServoPerStep = 0.2;  // Limit that ServoDescription states.
constexpr double kLeastLoadShare = 0.5;

std::string hertz(double w_rad_s) { return FaultList::text(w_rad_s / kTurn) + " Hz"; }

void findProfileFaults(FaultList& faults, const std::string& name, const DriverProfile& profile) {
  faults.within(name + ".profile.setup", profile.setup_s, 0.0, 1.0, "s");
  faults.within(name + ".profile.hold", profile.hold_s, 0.0, 1.0, "s");
  faults.within(name + ".profile.width", profile.width_s, 0.0, 1.0, "s");
  faults.within(name + ".profile.space", profile.space_s, 0.0, 1.0, "s");
}

void findStepperFaults(FaultList& faults, const std::string& name, const StepperDescription& stepper,
                       double motor_inertia_kg_m2, double step_s) {
  faults.positive(name + ".holding_torque", stepper.holding_torque_nm, 1e4, "N m");
  faults.require(stepper.rotor_teeth >= 1 && stepper.rotor_teeth <= 1000,
                 name + ".rotor_teeth must be in [1, 1000], is " + std::to_string(stepper.rotor_teeth));
  faults.within(name + ".damping", stepper.damping_nm_s, 0.0, 1e3, "N m s/rad");
  faults.within(name + ".detent_torque", stepper.detent_torque_nm, 0.0, 1e4, "N m");
  faults.positive(name + ".rated_current", stepper.rated_current_a, 1e3, "A");
  faults.limit(name + ".supply", stepper.supply_v, "V");
  faults.positive(name + ".resistance", stepper.resistance_ohm, 1e5, "ohm");
  faults.within(name + ".inductance", stepper.inductance_h, 0.0, 1e2, "H");
  // The magnets are a spring between rotor and frame; the detent's is steepest at its rest.
  const double spring = stepper.rotor_teeth * (stepper.holding_torque_nm + 4.0 * stepper.detent_torque_nm);
  requireResolved(faults, name + ": the rotor in its field", spring, motor_inertia_kg_m2,
                  std::numeric_limits<double>::infinity(), step_s);
}

// Requires the torque that the motor needs to keep the load moving against dry friction.
void requireStrength(FaultList& faults, const std::string& name, const AxisDescription& axis,
                     const AxisLoad& load) {
  const double needed_nm = load.friction * load.per_motor;
  const auto* servo = std::get_if<ServoDescription>(&axis.drive);
  const auto* stepper = std::get_if<StepperDescription>(&axis.drive);
  const double given_nm =
      servo != nullptr ? servo->max_torque : stepper->holding_torque_nm - stepper->detent_torque_nm;
  if (needed_nm < given_nm || std::isnan(needed_nm) || std::isnan(given_nm)) return;
  faults.require(false, name + ": the motor's " + FaultList::text(given_nm) +
                            " N m cannot move a load that rubs with " + FaultList::text(load.friction) + " " +
                            load.friction_unit + ", " + FaultList::text(needed_nm) + " N m at the motor");
}

}  // namespace

void requireResolved(FaultList& faults, const std::string& what, double stiffness, double mass_a,
                     double mass_b, double step_s) {
  // Impossible values have been reported elsewhere.
  if (!(stiffness > 0.0 && mass_a > 0.0 && mass_b > 0.0)) return;
  const double w = std::sqrt(stiffness * (1.0 / mass_a + 1.0 / mass_b));
  if (w * step_s <= kMostPerStep) return;
  faults.require(false, what + " swings at " + hertz(w) + "; steps of " + FaultList::text(step_s * 1e6) +
                            " us follow up to " + hertz(kMostPerStep / step_s));
}

void findServoFaults(FaultList& faults, const std::string& name, const ServoDescription& servo,
                     double step_s) {
  const double w = servo.natural_frequency_rad_s;
  faults.require(w > 0.0 && w * step_s <= kMostServoPerStep,
                 name + ".natural_frequency must be in (0, " + FaultList::text(kMostServoPerStep / step_s) +
                     "] rad/s, " + hertz(kMostServoPerStep / step_s) + ", which steps of " +
                     FaultList::text(step_s * 1e6) + " us still follow; is " + FaultList::text(w));
  faults.within(name + ".damping", servo.damping, 0.1, 5.0, "");
  faults.within(name + ".velocity_feedforward", servo.velocity_feedforward, 0.0, 2.0, "");
  if (servo.velocity_feedforward != 0.0) {
    faults.positive(name + ".feedforward_filter", servo.feedforward_filter_s, 10.0, "s");
  }
  faults.limit(name + ".max_torque", servo.max_torque, "N m");
  faults.limit(name + ".max_speed", servo.max_speed, "rad/s");
  faults.within(name + ".current_lag", servo.current_lag_s, 0.0, 0.1, "s");
  faults.within(name + ".input_delay", servo.input_delay_s, 0.0, 1.0, "s");
}

void requireQuietServo(FaultList& faults, const std::string& name, const ServoDescription& servo,
                       const ServoOnSpring& plant) {
  const double wn = servo.natural_frequency_rad_s;
  if (!(wn > 0.0 && plant.stiffness > 0.0 && plant.motor_inertia > 0.0 && plant.load_inertia > 0.0)) return;
  const double load_w = std::sqrt(plant.stiffness / plant.load_inertia);
  if (load_w < kLeastLoadShare * wn) {
    faults.require(false, name + ": the load swings on its transmission at " + hertz(load_w) +
                              ", less than half of the " + hertz(wn) + " of the servo that is to carry it");
    return;
  }
  // States: motor angle and speed, load angle and speed, torque.
  Eigen::MatrixXd rates = Eigen::MatrixXd::Zero(5, 5);
  const double inertia = plant.motor_inertia + plant.load_inertia;
  // Without a current loop's lag the torque follows at once: much faster than anything else here.
  const double lag_s = std::max(servo.current_lag_s, 1e-3 / std::max(wn, load_w));
  const double k = plant.stiffness;
  const double c = plant.damping;
  rates(0, 1) = rates(2, 3) = 1.0;
  rates.row(1) << -k / plant.motor_inertia, -c / plant.motor_inertia, k / plant.motor_inertia,
      c / plant.motor_inertia, 1.0 / plant.motor_inertia;
  rates.row(3) << k / plant.load_inertia, c / plant.load_inertia, -k / plant.load_inertia,
      -c / plant.load_inertia, 0.0;
  rates.row(4) << -inertia * wn * wn / lag_s, -2.0 * servo.damping * inertia * wn / lag_s, 0.0, 0.0,
      -1.0 / lag_s;
  if (!rates.allFinite()) return;
  const Eigen::VectorXcd poles = GeneralEigen(rates).values;
  for (const std::complex<double>& pole : poles) {
    if (pole.imag() < 0.0 || pole.real() <= 1e-6 * std::abs(pole)) continue;
    faults.require(
        false, name + ": servo, current loop and transmission together swing up at " + hertz(std::abs(pole)));
  }
}

void findAxisFaults(FaultList& faults, const std::string& name, const AxisDescription& axis,
                    const AxisLoad& load, double step_s) {
  findProfileFaults(faults, name, axis.profile);
  faults.positive(name + ".step", axis.step, load.most_step, load.step_unit);
  faults.positive(name + ".load_per_motor", axis.load_per_motor, 1e4, "");
  faults.positive(name + ".motor_inertia", axis.motor_inertia_kg_m2, 1e3, "kg m²");
  faults.positive(name + ".load_inertia", load.inertia, 1e5, load.inertia_unit);
  faults.positive(name + ".stiffness", axis.stiffness, 1e12,
                  load.friction_unit + "/" + (load.step_unit == "mm" ? "m" : "rad"));
  faults.within(name + ".stiffness_damping", axis.stiffness_damping, 0.0, 1e9, "");
  faults.within(name + ".backlash", axis.backlash, 0.0, load.most_backlash, load.backlash_unit);
  faults.within(name + ".friction.coulomb", axis.friction.coulomb, 0.0, 1e6, load.friction_unit);
  faults.within(name + ".friction.viscous", axis.friction.viscous, 0.0, 1e7, "");
  faults.positive(name + ".friction.presliding", axis.friction.presliding, 0.1, "");

  const double ratio = load.per_motor * load.per_motor;
  requireResolved(faults, name + ": motor against load", axis.stiffness, axis.motor_inertia_kg_m2 / ratio,
                  load.inertia, step_s);
  if (axis.friction.coulomb > 0.0) {
    requireResolved(faults, name + ": the load in its friction's presliding",
                    axis.friction.coulomb / axis.friction.presliding, load.inertia,
                    std::numeric_limits<double>::infinity(), step_s);
  }
  if (const auto* servo = std::get_if<ServoDescription>(&axis.drive)) {
    findServoFaults(faults, name, *servo, step_s);
    requireQuietServo(faults, name, *servo,
                      {axis.motor_inertia_kg_m2, load.inertia * ratio, axis.stiffness * ratio,
                       axis.stiffness_damping * ratio});
  } else {
    findStepperFaults(faults, name, std::get<StepperDescription>(axis.drive), axis.motor_inertia_kg_m2,
                      step_s);
  }
  requireStrength(faults, name, axis, load);
}

}  // namespace kerfbench::twin
