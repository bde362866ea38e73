// SPDX-License-Identifier: Apache-2.0
#include "twin/machine/mechanism_faults.h"

#include <cmath>

#include "twin/machine/mechanism.h"

namespace kerfbench::twin {
namespace {

class Faults {
 public:
  void require(bool fine, const std::string& who, const char* rule) {
    if (!fine) text_ += (text_.empty() ? "" : "; ") + who + ": " + rule;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

bool positive(double value) { return value > 0 && std::isfinite(value); }
bool notNegative(double value) { return value >= 0 && std::isfinite(value); }

void check(Faults& faults, const std::string& who, const ServoDescription& servo) {
  faults.require(positive(servo.natural_frequency_rad_s), who, "natural frequency must be > 0");
  faults.require(servo.damping >= 0.1 && servo.damping <= 5, who, "damping must be in 0.1 … 5");
  faults.require(notNegative(servo.velocity_feedforward), who, "velocity feedforward must be >= 0");
  faults.require(servo.velocity_feedforward == 0 || positive(servo.feedforward_filter_s), who,
                 "feedforward needs a filter > 0");
  faults.require(servo.max_torque > 0, who, "max torque must be > 0");
  faults.require(servo.max_speed > 0, who, "max speed must be > 0");
  faults.require(notNegative(servo.current_lag_s), who, "current lag must be >= 0");
  faults.require(notNegative(servo.input_delay_s), who, "input delay must be >= 0");
}

void check(Faults& faults, const std::string& who, const StepperDescription& stepper) {
  faults.require(positive(stepper.holding_torque_nm), who, "holding torque must be > 0");
  faults.require(stepper.rotor_teeth > 0, who, "rotor teeth must be > 0");
  faults.require(notNegative(stepper.damping_nm_s), who, "damping must be >= 0");
  faults.require(notNegative(stepper.detent_torque_nm), who, "detent torque must be >= 0");
  faults.require(positive(stepper.rated_current_a), who, "rated current must be > 0");
  faults.require(stepper.supply_v > 0, who, "supply must be > 0");
  faults.require(positive(stepper.resistance_ohm), who, "resistance must be > 0");
  faults.require(notNegative(stepper.inductance_h), who, "inductance must be >= 0");
}

}  // namespace

std::string faultsOf(const MechanismDescription& description) {
  Faults faults;
  const std::size_t joints = description.joints.size();
  const auto name = [&](std::size_t joint) {
    return joint < joints ? description.joints[joint].name : std::string("joint that is not there");
  };
  faults.require(joints > 0, "machine", "needs a joint");
  for (std::size_t i = 0; i < joints; ++i) {
    const JointDescription& joint = description.joints[i];
    faults.require(joint.parent < static_cast<int>(i), joint.name, "its parent must come before");
    faults.require(notNegative(joint.mass_kg), joint.name, "mass must be >= 0");
    faults.require(positive(joint.inertia_kg_m2), joint.name, "inertia must be > 0");
    faults.require(std::isfinite(joint.start_speed), joint.name, "start speed must be finite");
    faults.require(joint.most_speed > 0, joint.name, "most speed must be > 0");
  }
  for (const CouplingDescription& c : description.couplings) {
    faults.require(c.a < joints && c.b.value_or(c.a) < joints, name(c.a), "coupled to no joint");
    faults.require(std::isfinite(c.ratio_a) && std::isfinite(c.ratio_b), name(c.a), "ratio must be finite");
    faults.require(positive(c.stiffness), name(c.a), "stiffness must be > 0");
    faults.require(notNegative(c.damping), name(c.a), "damping of the transmission must be >= 0");
    faults.require(notNegative(c.play), name(c.a), "backlash must be >= 0");
  }
  for (const JointFriction& f : description.frictions) {
    faults.require(f.joint < joints && f.across.value_or(f.joint) < joints, name(f.joint),
                   "rubs on no joint");
    faults.require(notNegative(f.friction.coulomb), name(f.joint), "dry friction must be >= 0");
    faults.require(notNegative(f.friction.viscous), name(f.joint), "viscous friction must be >= 0");
    faults.require(positive(f.friction.presliding), name(f.joint), "presliding must be > 0");
  }
  for (const JointDrive& drive : description.drives) {
    faults.require(drive.joint < joints, drive.name, "drives no joint");
    if (const auto* servo = std::get_if<ServoDescription>(&drive.drive)) {
      check(faults, drive.name, *servo);
      faults.require(positive(drive.inertia_kg_m2), drive.name, "inertia must be > 0");
    } else {
      check(faults, drive.name, std::get<StepperDescription>(drive.drive));
    }
  }
  for (const ConstantForce& c : description.constant_forces) {
    faults.require(c.joint < joints && std::isfinite(c.force), name(c.joint), "force must be finite");
  }
  return faults.text();
}

}  // namespace kerfbench::twin
