// SPDX-License-Identifier: Apache-2.0
#include "tests/benchmarks/bullet_world.h"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>

namespace kerfbench::benchmarks {

struct BulletWorld::World {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btMultiBodyConstraintSolver solver;
  btMultiBodyDynamicsWorld dynamics{&dispatcher, &broadphase, &solver, &configuration};
  std::unique_ptr<btMultiBody> body;
};

BulletWorld::BulletWorld(std::shared_ptr<const twin::Mechanism> mechanism)
    : mechanism_(std::move(mechanism)),
      world_(std::make_unique<World>()),
      joints_(mechanism_->law().joints),
      state_(mechanism_->startState()),
      force_(joints_),
      rate_(mechanism_->law().auxiliaries) {
  const auto& joints = mechanism_->description().joints;
  const int n = static_cast<int>(joints.size());
  world_->body = std::make_unique<btMultiBody>(n, 0.0, btVector3(0, 0, 0), true, false);
  btMultiBody& body = *world_->body;
  const auto vector = [](const Eigen::Vector3d& v) { return btVector3(v.x(), v.y(), v.z()); };
  for (int i = 0; i < n; ++i) {
    const twin::JointDescription& joint = joints[static_cast<std::size_t>(i)];
    const btVector3 inertia(joint.inertia_kg_m2, joint.inertia_kg_m2, joint.inertia_kg_m2);
    const btQuaternion no_turn(0, 0, 0, 1);
    const bool turns = joint.kind == twin::JointDescription::Kind::kRevolute;
    if (turns) {
      body.setupRevolute(i, joint.mass_kg, inertia, joint.parent, no_turn, vector(joint.axis),
                         vector(joint.p_PJ_m), btVector3(0, 0, 0), true);
    } else {
      body.setupPrismatic(i, joint.mass_kg, inertia, joint.parent, no_turn, vector(joint.axis),
                          vector(joint.p_PJ_m), btVector3(0, 0, 0), true);
    }
  }
  body.finalizeMultiDof();
  body.setLinearDamping(0);
  body.setAngularDamping(0);
  body.setMaxCoordinateVelocity(1e12);
  body.setCanSleep(false);
  for (int i = 0; i < n; ++i) {
    body.setJointPos(i, state_[static_cast<std::size_t>(i)]);
    body.setJointVel(i, state_[joints_ + static_cast<std::size_t>(i)]);
  }
  world_->dynamics.setGravity(btVector3(0, 0, -9.80665));
  world_->dynamics.addMultiBody(&body);
}

BulletWorld::~BulletWorld() { world_->dynamics.removeMultiBody(world_->body.get()); }

void BulletWorld::step(double step_s, std::span<const double> commands) {
  btMultiBody& body = *world_->body;
  mechanism_->law().evaluate(state_.data(), commands.data(), force_.data(), rate_.data());
  for (std::size_t i = 0; i < joints_; ++i) body.addJointTorque(static_cast<int>(i), force_[i]);
  world_->dynamics.stepSimulation(step_s, 0);
  for (std::size_t i = 0; i < joints_; ++i) {
    state_[i] = body.getJointPos(static_cast<int>(i));
    state_[joints_ + i] = body.getJointVel(static_cast<int>(i));
  }
  for (std::size_t i = 0; i < rate_.size(); ++i) state_[2 * joints_ + i] += step_s * rate_[i];
}

}  // namespace kerfbench::benchmarks
