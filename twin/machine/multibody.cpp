// SPDX-License-Identifier: Apache-2.0
#include "twin/machine/multibody.h"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <LinearMath/btScalar.h>

#include <cmath>
#include <stdexcept>

#include <Eigen/LU>

namespace kerfbench::twin {

// The float build freezes joints with an inertia below 1.2e-7 kg m², without a message: every galvo mirror.
static_assert(sizeof(btScalar) == 8, "Kerfbench needs Bullet in double precision (bullet-float64)");

namespace {

constexpr std::size_t kBase = 6;  // Bullet's vectors begin with the base's six entries, fixed or not.

btVector3 toBullet(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

struct Multibody::Bodies {
  std::unique_ptr<btMultiBody> multibody;
  std::size_t size{};
  btVector3 gravity{0, 0, -9.80665};
  std::vector<btScalar> force, delta;
  btAlignedObjectArray<btScalar> scratch_r;
  btAlignedObjectArray<btVector3> scratch_v;
  btAlignedObjectArray<btMatrix3x3> scratch_m;
  btAlignedObjectArray<btQuaternion> world_to_local;
  btAlignedObjectArray<btVector3> local_origin;
};

Multibody::Multibody(const std::vector<JointDescription>& joints) : bodies_(std::make_unique<Bodies>()) {
  const int n = static_cast<int>(joints.size());
  bodies_->multibody = std::make_unique<btMultiBody>(n, 0.0, btVector3(0, 0, 0), true, false);
  btMultiBody& mb = *bodies_->multibody;
  for (int i = 0; i < n; ++i) {
    const JointDescription& joint = joints[static_cast<std::size_t>(i)];
    if (joint.parent >= i) {
      throw std::invalid_argument("Multibody: " + joint.name + ": a parent must come before its children");
    }
    if (!(joint.mass_kg >= 0 && std::isfinite(joint.mass_kg)) ||
        !(joint.inertia_kg_m2 > 0 && std::isfinite(joint.inertia_kg_m2))) {
      throw std::invalid_argument("Multibody: " + joint.name + ": mass must be >= 0 and inertia > 0");
    }
    const btVector3 inertia(joint.inertia_kg_m2, joint.inertia_kg_m2, joint.inertia_kg_m2);
    const btVector3 axis = toBullet(joint.axis.normalized());
    const btVector3 place = toBullet(joint.p_PJ_m);
    const btQuaternion no_turn(0, 0, 0, 1);
    if (joint.kind == JointDescription::Kind::kRevolute) {
      mb.setupRevolute(i, joint.mass_kg, inertia, joint.parent, no_turn, axis, place, btVector3(0, 0, 0),
                       true);
    } else {
      mb.setupPrismatic(i, joint.mass_kg, inertia, joint.parent, no_turn, axis, place, btVector3(0, 0, 0),
                        true);
    }
  }
  mb.finalizeMultiDof();
  // Bullet's defaults would brake a running belt and clip a galvo's step.
  mb.setLinearDamping(0);
  mb.setAngularDamping(0);
  mb.setMaxCoordinateVelocity(1e12);
  mb.setCanSleep(false);
  bodies_->size = joints.size();
  bodies_->force.assign(kBase + joints.size(), 0.0);
  bodies_->delta.assign(kBase + joints.size(), 0.0);
}

Multibody::~Multibody() = default;
Multibody::Multibody(Multibody&&) noexcept = default;
Multibody& Multibody::operator=(Multibody&&) noexcept = default;

std::size_t Multibody::size() const { return bodies_->size; }

void Multibody::accelerations(std::span<const double> q, std::span<const double> v,
                              std::span<const double> force, std::span<double> acceleration) {
  Bodies& b = *bodies_;
  btMultiBody& mb = *b.multibody;
  const int n = static_cast<int>(b.size);
  for (int i = 0; i < n; ++i) {
    const auto index = static_cast<std::size_t>(i);
    mb.setJointPos(i, q[index]);
    mb.setJointVel(i, v[index]);
  }
  mb.clearForcesAndTorques();  // The call erases gravity as well, so it is added by hand.
  for (int i = 0; i < n; ++i) {
    mb.addJointTorque(i, force[static_cast<std::size_t>(i)]);
    mb.addLinkForce(i, b.gravity * mb.getLinkMass(i));
  }
  // A step of zero leaves the velocities alone and the accelerations in the scratch memory.
  mb.computeAccelerationsArticulatedBodyAlgorithmMultiDof(0, b.scratch_r, b.scratch_v, b.scratch_m, false,
                                                          false, false);
  const int first = mb.getNumDofs() + static_cast<int>(kBase);
  for (int i = 0; i < n; ++i) acceleration[static_cast<std::size_t>(i)] = b.scratch_r[first + i];
}

void Multibody::accelerationDeltas(std::span<const double> force, std::span<double> delta) {
  Bodies& b = *bodies_;
  for (std::size_t i = 0; i < b.size; ++i) b.force[kBase + i] = force[i];
  b.multibody->calcAccelerationDeltasMultiDof(b.force.data(), b.delta.data(), b.scratch_r, b.scratch_v);
  for (std::size_t i = 0; i < b.size; ++i) delta[i] = b.delta[kBase + i];
}

Eigen::Isometry3d Multibody::pose(std::span<const double> q, std::size_t body) {
  Bodies& b = *bodies_;
  for (std::size_t i = 0; i < b.size; ++i) b.multibody->setJointPos(static_cast<int>(i), q[i]);
  b.multibody->forwardKinematics(b.world_to_local, b.local_origin);
  const btTransform& transform = b.multibody->getLink(static_cast<int>(body)).m_cachedWorldTransform;
  const btMatrix3x3& r = transform.getBasis();
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) X_WB.linear()(i, j) = r[i][j];
    X_WB.translation()(i) = transform.getOrigin()[i];
  }
  return X_WB;
}

Eigen::MatrixXd inverseMassMatrix(Multibody& body) {
  const std::size_t n = body.size();
  const std::vector<double> zero(n, 0.0);
  std::vector<double> unit(n, 0.0);
  std::vector<double> column(n, 0.0);
  body.accelerations(zero, zero, zero, column);  // The deltas need its articulated inertias.
  Eigen::MatrixXd inverse(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  for (std::size_t j = 0; j < n; ++j) {
    unit[j] = 1.0;
    body.accelerationDeltas(unit, column);
    unit[j] = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      inverse(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = column[i];
    }
  }
  constexpr double kRounding = 1e-12;
  for (Eigen::Index i = 0; i < inverse.rows(); ++i) {
    for (Eigen::Index j = 0; j < inverse.cols(); ++j) {
      if (std::abs(inverse(i, j)) < kRounding * std::sqrt(inverse(i, i) * inverse(j, j))) inverse(i, j) = 0.0;
    }
  }
  return inverse;
}

Eigen::VectorXd gravityForces(Multibody& body) {
  const std::size_t n = body.size();
  const std::vector<double> zero(n, 0.0);
  std::vector<double> fall(n, 0.0);
  body.accelerations(zero, zero, zero, fall);
  const auto size = static_cast<Eigen::Index>(n);
  // A joint in free fall accelerates at g: values far below that are rounding.
  constexpr double kRounding = 1e-9;
  constexpr double kG_m_s2 = 9.80665;
  Eigen::VectorXd acceleration = Eigen::Map<const Eigen::VectorXd>(fall.data(), size);
  for (double& a : acceleration) {
    if (std::abs(a) < kRounding * kG_m_s2) a = 0.0;
  }
  if (acceleration.isZero(0.0)) return acceleration;
  return inverseMassMatrix(body).partialPivLu().solve(acceleration);
}

}  // namespace kerfbench::twin
