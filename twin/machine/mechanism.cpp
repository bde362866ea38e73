// SPDX-License-Identifier: Apache-2.0
#include "twin/machine/mechanism.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "twin/base/general_eigen.h"
#include "twin/machine/mechanism_faults.h"

namespace kerfbench::twin {
namespace {

// Damping of a bristle, as a share of the critical with the joint's own mass: a sheet that is caught comes
// to rest within a swing or two.
constexpr double kBristleDamping = 0.5;

double& at(std::vector<double>& values, std::size_t index) {
  if (index >= values.size()) values.resize(index + 1, 0.0);
  return values[index];
}

}  // namespace

Mechanism::Mechanism(MechanismDescription description) : description_(std::move(description)) {
  if (const std::string faults = faultsOf(description_); !faults.empty()) {
    throw std::invalid_argument("Mechanism: " + faults);
  }
  Multibody body(description_.joints);
  inverse_mass_ = inverseMassMatrix(body);
  law_.joints = description_.joints.size();
  law_.inputs = description_.drives.size();
  for (std::size_t i = 0; i < law_.joints; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (!(inverse_mass_(k, k) > 0) || !std::isfinite(inverse_mass_(k, k))) {
      throw std::invalid_argument("Mechanism: " + description_.joints[i].name + " moves no mass");
    }
  }
  gravity_ = gravityForces(body);
  for (const JointDescription& joint : description_.joints) most_speeds_.push_back(joint.most_speed);
  law_.constants = description_.constant_forces;
  for (const CouplingDescription& coupling : description_.couplings) addCoupling(coupling);
  for (const JointFriction& friction : description_.frictions) addFriction(friction);
  for (std::size_t i = 0; i < description_.drives.size(); ++i) addDrive(description_.drives[i], i);
  auxiliary_start_.resize(law_.auxiliaries, 0.0);
}

void Mechanism::addCoupling(const CouplingDescription& coupling) {
  SpringLaw spring;
  spring.a = coupling.a;
  spring.ratio_a = coupling.ratio_a;
  spring.b = coupling.b.value_or(coupling.a);
  spring.ratio_b = coupling.b ? coupling.ratio_b : 0.0;
  spring.stiffness = coupling.stiffness;
  spring.damping = coupling.damping;
  spring.half_play = 0.5 * coupling.play;
  spring.rest = coupling.start_load / coupling.stiffness;
  if (coupling.start_load > 0) spring.rest += spring.half_play;
  if (coupling.start_load < 0) spring.rest -= spring.half_play;
  law_.springs.push_back(spring);
}

void Mechanism::addFriction(const JointFriction& friction) {
  FrictionLaw law;
  law.joint = friction.joint;
  law.plane = friction.across.has_value();
  law.across = friction.across.value_or(friction.joint);
  law.limit = friction.friction.coulomb;
  law.viscous = friction.friction.viscous;
  if (law.limit > 0) {
    const auto k = static_cast<Eigen::Index>(friction.joint);
    law.stiffness = law.limit / friction.friction.presliding;
    law.damping = 2.0 * kBristleDamping * std::sqrt(law.stiffness / inverse_mass_(k, k));
    law.bristle = law_.auxiliaries;
    law_.auxiliaries += law.plane ? 2 : 1;
    at(auxiliary_start_, law.bristle) = friction.start_load / law.stiffness;
    if (law.plane) at(auxiliary_start_, law.bristle + 1) = friction.start_load_across / law.stiffness;
  }
  law_.frictions.push_back(law);
}

void Mechanism::addDrive(const JointDrive& drive, std::size_t input) {
  const double speed = description_.joints[drive.joint].start_speed;
  if (const auto* stepper = std::get_if<StepperDescription>(&drive.drive)) {
    StepperLaw law;
    law.joint = drive.joint;
    law.input = input;
    law.holding = stepper->holding_torque_nm;
    law.teeth = stepper->rotor_teeth;
    law.damping = stepper->damping_nm_s;
    law.detent = stepper->detent_torque_nm;
    law.current = stepper->rated_current_a;
    law.resistance = stepper->resistance_ohm;
    law.reactance_per_speed = law.teeth * stepper->inductance_h;
    law.volt_per_speed = law.holding / law.current;
    law.supply_v = stepper->supply_v;
    law.supply_limited = std::isfinite(stepper->supply_v);
    const double share = (drive.start_torque_nm + law.damping * speed) / law.holding;
    law.offset = std::asin(std::clamp(share, -1.0, 1.0)) / law.teeth - drive.start_command;
    law_.steppers.push_back(law);
    return;
  }
  const auto& servo = std::get<ServoDescription>(drive.drive);
  ServoLaw law;
  law.joint = drive.joint;
  law.input = input;
  law.speed_per_error = servo.natural_frequency_rad_s / (2.0 * servo.damping);
  law.torque_per_speed = drive.inertia_kg_m2 * 2.0 * servo.damping * servo.natural_frequency_rad_s;
  law.max_speed = servo.max_speed;
  law.max_torque = servo.max_torque;
  law.limited = std::isfinite(law.max_speed) || std::isfinite(law.max_torque);
  law.feedforward = servo.velocity_feedforward;
  law.lag_s = servo.current_lag_s;
  const double wanted = drive.start_torque_nm / law.torque_per_speed + speed;
  law.offset = (wanted - law.feedforward * drive.start_speed) / law.speed_per_error - drive.start_command;
  if (law.feedforward > 0) {
    law.filter_s = servo.feedforward_filter_s;
    law.filter = law_.auxiliaries++;
    at(auxiliary_start_, law.filter) = drive.start_command - law.filter_s * drive.start_speed;
  }
  if (law.lag_s > 0) {
    law.current = law_.auxiliaries++;
    at(auxiliary_start_, law.current) = drive.start_torque_nm;
  }
  law_.servos.push_back(law);
}

std::vector<double> Mechanism::startState() const {
  std::vector<double> x(law_.stateSize(), 0.0);
  for (std::size_t i = 0; i < law_.joints; ++i) x[law_.joints + i] = description_.joints[i].start_speed;
  std::ranges::copy(auxiliary_start_, x.begin() + static_cast<std::ptrdiff_t>(2 * law_.joints));
  return x;
}

void Mechanism::requireSlowerThan(double step_s) const {
  // The mechanism is stiffest with both flanks of each play in contact and all frictions holding.
  std::vector<ForceLaw::Piece> pieces(law_.pieceCount(), 0);
  for (std::size_t i = 0; i < law_.springs.size(); ++i) pieces[i] = law_.springs[i].half_play > 0 ? 1 : 0;
  const AffineRate rate = affineRate(law_, inverse_mass_, pieces.data());
  const GeneralEigen motions(rate.A);
  for (Eigen::Index k = 0; k < rate.A.rows(); ++k) {
    const double rate_1_s = std::abs(motions.values[k]);
    if (rate_1_s * step_s <= 1.0) continue;
    // The joint in the message has the largest share of the kinetic energy in this motion.
    std::size_t joint = 0;
    double most = -1.0;
    for (std::size_t i = 0; i < law_.joints; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const double speed = std::abs(motions.vectors(row + static_cast<Eigen::Index>(law_.joints), k));
      const double energy = speed * speed / inverse_mass_(row, row);
      if (energy > most) {
        most = energy;
        joint = i;
      }
    }
    std::ostringstream message;
    message << "Mechanism: " << description_.joints[joint].name << " has a motion of " << rate_1_s
            << " rad/s; a step of " << step_s << " s follows up to " << 1.0 / step_s;
    throw std::invalid_argument(message.str());
  }
}

AffineRate affineRate(const ForceLaw& law, const Eigen::MatrixXd& inverse_mass,
                      const ForceLaw::Piece* pieces) {
  const auto n = static_cast<Eigen::Index>(law.joints);
  const auto size = static_cast<Eigen::Index>(law.stateSize());
  std::vector<double> x(law.stateSize(), 0.0);
  std::vector<double> u(law.inputs, 0.0);
  std::vector<double> force(law.joints, 0.0);
  std::vector<double> aux_rate(law.auxiliaries, 0.0);
  const auto rate = [&] {
    law.evaluateAffine(x.data(), u.data(), pieces, force.data(), aux_rate.data());
    Eigen::VectorXd result(size);
    for (Eigen::Index i = 0; i < n; ++i) result[i] = x[law.joints + static_cast<std::size_t>(i)];
    result.segment(n, n) = inverse_mass * Eigen::Map<const Eigen::VectorXd>(force.data(), n);
    for (Eigen::Index i = 2 * n; i < size; ++i) result[i] = aux_rate[static_cast<std::size_t>(i - 2 * n)];
    return result;
  };
  AffineRate affine{Eigen::MatrixXd(size, size), Eigen::MatrixXd(size, static_cast<Eigen::Index>(u.size())),
                    rate()};
  const auto columns = [&](std::vector<double>& values, Eigen::MatrixXd& matrix) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = 1.0;
      matrix.col(static_cast<Eigen::Index>(i)) = rate() - affine.c;
      values[i] = 0.0;
    }
  };
  columns(x, affine.A);
  columns(u, affine.B);
  return affine;
}

}  // namespace kerfbench::twin
