// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "twin/drive/drive_description.h"
#include "twin/machine/force_law.h"
#include "twin/machine/multibody.h"

namespace kerfbench::twin {

/// Elastic link between two joints, or from a joint to its parent: a spring and a damper on
/// ratio_a q_a + ratio_b q_b. A belt from a pulley of radius r (joint b) to a slide (a) has 1 and -r.
struct CouplingDescription {
  std::size_t a{};
  double ratio_a{1.0};
  std::optional<std::size_t> b;  ///< Second joint; absent: the parent of a.
  double ratio_b{};
  double stiffness{};   ///< N/m or N m/rad of that sum; > 0.
  double damping{};     ///< >= 0
  double play{};        ///< Full play; >= 0.
  double start_load{};  ///< Force at t = 0 with all joints at zero, positive like a stretch.
};

/// Friction between a joint's body and its parent's. If `across` is given both directions share one dry
/// limit, as of a sheet on a belt.
struct JointFriction {
  std::size_t joint{};
  std::optional<std::size_t> across;
  FrictionDescription friction;
  /// Dry friction's load at t = 0, along joint and across: the force that it holds, or the limit if it
  /// slides.
  double start_load{}, start_load_across{};
};

struct JointDrive {
  std::string name;     ///< Name of the axis, e.g. "galvo_x".
  std::size_t joint{};  ///< Joint of the motor; revolute.
  DriveDescription drive;
  double inertia_kg_m2{};    ///< Inertia that a servo's gains refer to: motor and load, at the motor.
  double start_command{};    ///< Command of the input at t = 0, rad.
  double start_speed{};      ///< Speed of the command at t = 0, rad/s; constant for a long time before.
  double start_torque_nm{};  ///< Torque of the drive at t = 0. Its command is consistent with it.
};

/// Bodies, joints and all elements that act between them. SI units: m, rad, N, N m.
struct MechanismDescription {
  std::vector<JointDescription> joints;
  std::vector<CouplingDescription> couplings;
  std::vector<JointFriction> frictions;
  std::vector<JointDrive> drives;
  std::vector<ConstantForce> constant_forces;
};

/// A drive's command over one step: at its begin, middle and end, rad of the motor. A pulse input has the
/// step's area mean in all three.
struct DriveCommand {
  double begin{}, middle{}, end{};
};

/// Equations of motion of a machine: M(q) dv/dt = forces(q, v, auxiliary states, commands). Constant; a
/// solver has the state.
///
/// Joints are slides and balanced rotors whose axes keep their direction, so the mass matrix is constant and
/// there are no terms of velocity. Only the solvers that say so rely on that.
class Mechanism {
 public:
  /// Builds the equations. @throws std::invalid_argument with everything that is wrong.
  explicit Mechanism(MechanismDescription description);

  [[nodiscard]] const MechanismDescription& description() const { return description_; }
  [[nodiscard]] const ForceLaw& law() const { return law_; }
  /// Inverse mass matrix from Bullet, see inverseMassMatrix().
  [[nodiscard]] const Eigen::MatrixXd& inverseMass() const { return inverse_mass_; }
  /// Gravity forces from Bullet, see gravityForces(). They are not in law(): Bullet's own accelerations have
  /// them already.
  [[nodiscard]] const Eigen::VectorXd& gravity() const { return gravity_; }
  /// Largest plausible speed of each joint, see JointDescription.
  [[nodiscard]] const std::vector<double>& mostSpeeds() const { return most_speeds_; }
  /// State at t = 0, as in ForceLaw.
  [[nodiscard]] std::vector<double> startState() const;

  /// Checks the step. @throws std::invalid_argument that names the joint if an eigenvalue of the linear
  /// mechanism is beyond 1 / step: neither solver would follow it.
  void requireSlowerThan(double step_s) const;

 private:
  void addCoupling(const CouplingDescription& coupling);
  void addFriction(const JointFriction& friction);
  void addDrive(const JointDrive& drive, std::size_t input);

  MechanismDescription description_;
  Eigen::MatrixXd inverse_mass_;
  Eigen::VectorXd gravity_;
  ForceLaw law_;
  std::vector<double> most_speeds_;
  std::vector<double> auxiliary_start_;
};

/// Affine law in these pieces: rate of the state = A x + B u + c.
struct AffineRate {
  Eigen::MatrixXd A, B;
  Eigen::VectorXd c;
};
AffineRate affineRate(const ForceLaw& law, const Eigen::MatrixXd& inverse_mass,
                      const ForceLaw::Piece* pieces);

}  // namespace kerfbench::twin
