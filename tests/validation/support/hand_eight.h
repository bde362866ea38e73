// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "tests/validation/support/rk4.h"

namespace kerfbench::validation {

/// A machine of eight joints whose equations of motion fit on a page. A roller and a belt that hangs on it
/// elastically; a gantry x, y; on its carriage two shafts, each a rotor and a mirror that twists on it:
/// shaft A turns about -Wz, shaft B about +Wx. The mirrors' centres of mass are off their shafts, at rest
/// towards +Wx (A) and +Wy (B): they shake the gantry, and gravity turns shaft B. SI units.
struct EightJoints {
  // Masses and inertias.
  double roller_kg_m2{2e-3}, belt_kg{0.5}, bridge_kg{9.0}, carriage_kg{3.0};
  double rotor_kg_m2{2.5e-7}, mirror_kg_m2{2.5e-7}, mirror_kg{0.01}, unbalance_m{20e-6};
  double gravity_m_s2{9.80665};
  // Springs: belt 100 Hz against the roller, mirrors 4 kHz at 1 % of critical.
  double roller_radius_m{0.03}, belt_n_m{2e5}, belt_n_s_m{200.0};
  double twist_hz{4000.0}, twist_damping{0.01};
  // Drives: PD loops J (wn² e + 2 zeta wn e'), and the magnetic spring of a stepper on shaft A.
  double roller_hz{20.0}, gantry_hz{80.0}, galvo_hz{1200.0}, zeta{0.7};
  double stepper_hz{196.0}, stepper_teeth{50.0}, stepper_zeta{0.1};

  static constexpr std::size_t kCount = 8;
  enum Joint : std::size_t { kRoller, kBelt, kX, kY, kRotorA, kTwistA, kRotorB, kTwistB };
  using Values = std::array<double, kCount>;

  /// Commands of the drives: roller, gantry x, gantry y (rad, m), shaft A, shaft B.
  static constexpr std::size_t kDrives = 5;
  using Command = std::array<double, kDrives>;
  /// A smooth motion from rest.
  [[nodiscard]] static Command smooth(double time_s);
  /// A slower motion, which pulses can follow.
  [[nodiscard]] static Command slow(double time_s);
  /// Force or torque in each joint, without gravity.
  [[nodiscard]] Values forces(const Command& command, const Values& q, const Values& v) const;
  /// Accelerations by hand: the mass matrix in closed form.
  [[nodiscard]] Values accelerations(const Values& q, const Values& v, const Values& force) const;

  [[nodiscard]] static Eigen::Vector2d gantry_mm(const Values& q);
  [[nodiscard]] static double belt_mm(const Values& q);
  /// Spot of a head with L = 500 mm, d = 15 mm on the carriage, by S4's formula.
  [[nodiscard]] static Eigen::Vector2d spot_mm(const Values& q);
};

/// Truth by RK4 in steps of 0.2 us from rest. A staircase of pulses on the grid of the steps is held over
/// each step, so that no edge is ever smeared.
class HandEight {
 public:
  static constexpr double kStep_s = 0.2e-6;
  explicit HandEight(const EightJoints& machine) : machine_(machine) {}

  template <typename CommandFn>
  void stepSmooth(const CommandFn& command) {
    step([&command](double time_s) { return command(time_s); });
  }
  void stepStair(const EightJoints::Command& held) {
    step([&held](double) -> const EightJoints::Command& { return held; });
  }
  [[nodiscard]] EightJoints::Values q() const;
  [[nodiscard]] double time_s() const { return static_cast<double>(steps_) * kStep_s; }

 private:
  using State = std::array<double, 2 * EightJoints::kCount>;

  template <typename CommandFn>
  void step(const CommandFn& command) {
    rk4Step(state_, time_s(), kStep_s, [&](double time_s, const State& y, State& rate) {
      EightJoints::Values q{}, v{};
      std::copy_n(y.begin(), q.size(), q.begin());
      std::copy_n(y.begin() + EightJoints::kCount, v.size(), v.begin());
      const auto a = machine_.accelerations(q, v, machine_.forces(command(time_s), q, v));
      std::copy_n(v.begin(), v.size(), rate.begin());
      std::copy_n(a.begin(), a.size(), rate.begin() + EightJoints::kCount);
    });
    ++steps_;
  }

  EightJoints machine_;
  State state_{};
  long long steps_{0};
};

}  // namespace kerfbench::validation
