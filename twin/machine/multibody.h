// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Geometry>

namespace kerfbench::twin {

/// One moving body and the joint that carries it. Metres, kilograms, radians: Bullet's units stay inside
/// twin/machine.
struct JointDescription {
  enum class Kind { kRevolute, kPrismatic };
  Kind kind{Kind::kRevolute};
  int parent{-1};                                   ///< Index of the parent body; -1 is the frame.
  Eigen::Vector3d p_PJ_m{Eigen::Vector3d::Zero()};  ///< The joint in the parent's frame.
  Eigen::Vector3d axis{Eigen::Vector3d::UnitZ()};   ///< Unit vector, in the parent's frame.
  double mass_kg{1.0};                              ///< > 0
  double inertia_kg_m2{1e-6};  ///< About the axis of a revolute joint, and the other two; > 0.
};

/// The machine's bodies as one Bullet multibody (Featherstone, double precision), integrated by position
/// Verlet over the articulated-body algorithm: second order, one evaluation a step. Bullet's own
/// stepSimulation is first order, which at 10 us would cost 0.7 mm at a galvo's 1500 Hz.
class Multibody {
 public:
  explicit Multibody(const std::vector<JointDescription>& joints);
  ~Multibody();
  Multibody(Multibody&&) noexcept;
  Multibody& operator=(Multibody&&) noexcept;

  [[nodiscard]] std::size_t size() const;
  /// Joint positions and velocities, rad or m and per second.
  [[nodiscard]] std::span<const double> q() const;
  [[nodiscard]] std::span<const double> qd() const;
  void setState(std::size_t joint, double q, double qd);

  /// One step of `step_s`. `torques` gets positions and velocities at the middle of the step and fills one
  /// value a joint, N m or N, driving forces only; gravity acts by itself.
  using TorqueFn =
      std::function<void(std::span<const double> q, std::span<const double> qd, std::span<double> torque)>;
  void step(double step_s, const TorqueFn& torques);

  /// Joint accelerations in the present state under these torques.
  std::vector<double> accelerations(std::span<const double> torque);
  /// Pose of a body in the frame: rotation of its links' axes and its joint's place, m.
  [[nodiscard]] Eigen::Isometry3d pose(std::size_t body) const;

 private:
  struct Bodies;
  std::unique_ptr<Bodies> bodies_;
};

}  // namespace kerfbench::twin
