// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace kerfbench::twin {

/// One moving body and the joint that carries it. Metres, kilograms, radians: Bullet's units stay inside
/// twin/machine and the code that puts a machine together.
struct JointDescription {
  enum class Kind { kRevolute, kPrismatic };
  std::string name;  ///< Name for messages, e.g. "galvo_x.mirror".
  Kind kind{Kind::kRevolute};
  int parent{-1};                                   ///< Index of the parent body; -1 is the floor.
  Eigen::Vector3d p_PJ_m{Eigen::Vector3d::Zero()};  ///< Place of the joint in the parent's frame.
  Eigen::Vector3d axis{Eigen::Vector3d::UnitZ()};   ///< Unit vector of the joint, in the parent's frame.
  /// Mass; >= 0; 0 for a rotor whose mass counts with the body that carries it, and for the first slide of a
  /// pair.
  double mass_kg{1.0};
  double inertia_kg_m2{1e-6};  ///< Inertia about the axis of a revolute joint, and about the other two; > 0.
  double start_speed{};        ///< Speed at t = 0, rad/s or m/s.
  double most_speed{1e6};      ///< Largest plausible speed, rad/s or m/s; more is a DivergenceError; > 0.
};

/// Bodies of the machine as one Bullet multibody (Featherstone, double precision). No state: positions and
/// velocities come with each call. Bullet's own stepSimulation is first order, which at 10 us would cost
/// 0.7 mm at a galvo's 1500 Hz, so only its accelerations are used.
class Multibody {
 public:
  /// Builds the multibody. @throws std::invalid_argument if a parent comes after its child, or a mass or an
  /// inertia is impossible.
  explicit Multibody(const std::vector<JointDescription>& joints);
  ~Multibody();
  Multibody(Multibody&&) noexcept;
  Multibody& operator=(Multibody&&) noexcept;

  [[nodiscard]] std::size_t size() const;

  /// Joint accelerations in the state (q, v) under these forces, N m or N a joint: the articulated-body
  /// algorithm with gravity and all terms of velocity. All spans have size().
  void accelerations(std::span<const double> q, std::span<const double> v, std::span<const double> force,
                     std::span<double> acceleration);
  /// Change of the accelerations by these forces in the configuration of the last call of accelerations():
  /// M^-1 force, at a seventh of the cost.
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
/// Force of gravity on each joint at rest in the configuration q = 0, N m or N; 0 where it moves nothing.
Eigen::VectorXd gravityForces(Multibody& body);

}  // namespace kerfbench::twin
