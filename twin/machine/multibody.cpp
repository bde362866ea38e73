// SPDX-License-Identifier: Apache-2.0
#include "twin/machine/multibody.h"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <LinearMath/btScalar.h>

#include <stdexcept>

namespace kerfbench::twin {

// The float build freezes joints with an inertia below 1.2e-7 kg m² without a word: every galvo mirror.
static_assert(sizeof(btScalar) == 8, "Kerfbench needs Bullet in double precision (bullet-float64)");

namespace {

btVector3 toBullet(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

struct Multibody::Bodies {
  std::unique_ptr<btMultiBody> multibody;
  std::vector<double> q, qd, q_mid, qd_mid, torque, acceleration;
  btVector3 gravity{0, 0, -9.80665};
  btAlignedObjectArray<btScalar> scratch_r;
  btAlignedObjectArray<btVector3> scratch_v;
  btAlignedObjectArray<btMatrix3x3> scratch_m;
  mutable btAlignedObjectArray<btQuaternion> world_to_local;
  mutable btAlignedObjectArray<btVector3> local_origin;

  // Articulated-body accelerations in the state (positions, velocities) under these torques.
  void accelerate(std::span<const double> positions, std::span<const double> velocities,
                  std::span<const double> torques) {
    const int n = static_cast<int>(q.size());
    for (int i = 0; i < n; ++i) {
      const auto index = static_cast<std::size_t>(i);
      multibody->setJointPos(i, positions[index]);
      multibody->setJointVel(i, velocities[index]);
    }
    multibody->clearForcesAndTorques();  // Wipes gravity as well, so it is added by hand.
    for (int i = 0; i < n; ++i) {
      multibody->addJointTorque(i, torques[static_cast<std::size_t>(i)]);
      multibody->addLinkForce(i, gravity * multibody->getLinkMass(i));
    }
    // A step of zero leaves the velocities alone and the accelerations in the scratch memory.
    multibody->computeAccelerationsArticulatedBodyAlgorithmMultiDof(0, scratch_r, scratch_v, scratch_m, false,
                                                                    false, false);
    for (int i = 0; i < n; ++i) {
      acceleration[static_cast<std::size_t>(i)] = scratch_r[multibody->getNumDofs() + 6 + i];
    }
  }
};

Multibody::Multibody(const std::vector<JointDescription>& joints) : bodies_(std::make_unique<Bodies>()) {
  const int n = static_cast<int>(joints.size());
  bodies_->multibody = std::make_unique<btMultiBody>(n, 0.0, btVector3(0, 0, 0), true, false);
  btMultiBody& mb = *bodies_->multibody;
  for (int i = 0; i < n; ++i) {
    const JointDescription& joint = joints[static_cast<std::size_t>(i)];
    if (joint.parent >= i) throw std::invalid_argument("Multibody: a parent must come before its children");
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
  // Defaults that would brake a running belt and clip a galvo's step.
  mb.setLinearDamping(0);
  mb.setAngularDamping(0);
  mb.setMaxCoordinateVelocity(1e12);
  mb.setCanSleep(false);
  const auto size = joints.size();
  for (auto* values : {&bodies_->q, &bodies_->qd, &bodies_->q_mid, &bodies_->qd_mid, &bodies_->torque,
                       &bodies_->acceleration}) {
    values->assign(size, 0.0);
  }
}

Multibody::~Multibody() = default;
Multibody::Multibody(Multibody&&) noexcept = default;
Multibody& Multibody::operator=(Multibody&&) noexcept = default;

std::size_t Multibody::size() const { return bodies_->q.size(); }
std::span<const double> Multibody::q() const { return bodies_->q; }
std::span<const double> Multibody::qd() const { return bodies_->qd; }

void Multibody::setState(std::size_t joint, double q, double qd) {
  bodies_->q.at(joint) = q;
  bodies_->qd.at(joint) = qd;
}

void Multibody::step(double step_s, const TorqueFn& torques) {
  Bodies& b = *bodies_;
  const double half_s = 0.5 * step_s;
  for (std::size_t i = 0; i < b.q.size(); ++i) {
    b.q_mid[i] = b.q[i] + half_s * b.qd[i];
    b.qd_mid[i] =
        b.qd[i] + half_s * b.acceleration[i];  // The last step's acceleration: good to second order.
  }
  torques(b.q_mid, b.qd_mid, b.torque);
  b.accelerate(b.q_mid, b.qd_mid, b.torque);
  for (std::size_t i = 0; i < b.q.size(); ++i) {
    b.qd[i] += step_s * b.acceleration[i];
    b.q[i] = b.q_mid[i] + half_s * b.qd[i];
  }
}

std::vector<double> Multibody::accelerations(std::span<const double> torque) {
  Bodies& b = *bodies_;
  const std::vector<double> kept = b.acceleration;
  b.accelerate(b.q, b.qd, torque);
  std::vector<double> result = b.acceleration;
  b.acceleration = kept;
  return result;
}

Eigen::Isometry3d Multibody::pose(std::size_t body) const {
  const Bodies& b = *bodies_;
  for (std::size_t i = 0; i < b.q.size(); ++i) b.multibody->setJointPos(static_cast<int>(i), b.q[i]);
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

}  // namespace kerfbench::twin
