// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace kerfbench::twin {

/// One moving body and the joint that carries it. Metres, kilograms, radians: Bullet's units stay inside
/// twin/machine and what puts a machine together.
struct JointDescription {
  enum class Kind { kRevolute, kPrismatic };
  std::string name;  ///< E.g. "galvo_x.mirror"; for messages.
  Kind kind{Kind::kRevolute};
  int parent{-1};                                   ///< Index of the parent body; -1 is the floor.
  Eigen::Vector3d p_PJ_m{Eigen::Vector3d::Zero()};  ///< The joint in the parent's frame.
  Eigen::Vector3d axis{Eigen::Vector3d::UnitZ()};   ///< Unit vector, in the parent's frame.
  double mass_kg{1.0};         ///< >= 0; 0 for a rotor whose mass is counted with what carries it, and for
                               ///< the first slide of a pair.
  double inertia_kg_m2{1e-6};  ///< About the axis of a revolute joint, and the other two; > 0.
  double start_speed{};        ///< rad/s or m/s at t = 0.
  double most_speed{1e6};      ///< rad/s or m/s; beyond is nonsense (DivergenceError); > 0.
};

/// The machine's bodies as one Bullet multibody (Featherstone, double precision). No state: positions and
/// velocities come with each question. Bullet's own stepSimulation is first order, which at 10 us would cost
/// 0.7 mm at a galvo's 1500 Hz, so only its accelerations are used.
class Multibody {
 public:
  /// @throws std::invalid_argument if a parent comes after its child, or a mass or an inertia cannot be.
  explicit Multibody(const std::vector<JointDescription>& joints);
  ~Multibody();
  Multibody(Multibody&&) noexcept;
  Multibody& operator=(Multibody&&) noexcept;

  [[nodiscard]] std::size_t size() const;

  /// Joint accelerations in the state (q, v) under these forces, N m or N a joint: the articulated-body
  /// algorithm with gravity and all terms of velocity. All spans have size().
  void accelerations(std::span<const double> q, std::span<const double> v, std::span<const double> force,
                     std::span<double> acceleration);
  /// What these forces add to the accelerations of the configuration of the last call of accelerations():
  /// M^-1 force, at a seventh of the price.
  void accelerationDeltas(std::span<const double> force, std::span<double> delta);

  /// Pose of a body over the floor for these joint positions: rotation of its axes and its joint's place, m.
  [[nodiscard]] Eigen::Isometry3d pose(std::span<const double> q, std::size_t body);

 private:
  struct Bodies;
  std::unique_ptr<Bodies> bodies_;
};

/// Inverse of the mass matrix in the configuration q = 0, column by column. Entries below 1e-12 of their
/// diagonal are rounding and come as 0.
Eigen::MatrixXd inverseMassMatrix(Multibody& body);
/// What gravity does to each joint at rest in the configuration q = 0, N m or N, as a force that would do the
/// same; 0 where it moves nothing.
Eigen::VectorXd gravityForces(Multibody& body);

}  // namespace kerfbench::twin
