// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/support/hand_eight.h"

#include <cmath>
#include <numbers>

#include "tests/validation/support/motion.h"

namespace kerfbench::validation {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kMetre_mm = 1000.0;

double square(double value) { return value * value; }

// Motion that rises from 0 without a jolt, so that no integrator is judged by its reaction to a step.
double soft(double time_s) { return 1.0 - std::exp(-square(time_s / 4e-3)); }

}  // namespace

EightJoints::Command EightJoints::smooth(double time_s) {
  const double s = soft(time_s);
  const auto wave = [time_s](double hz, double phase) { return std::sin(kTurn * hz * time_s + phase); };
  return {s * (6.0 * time_s + 0.01 * wave(7.0, 0.0)), s * 0.01 * wave(9.0, 0.3), s * 0.012 * wave(11.0, 1.1),
          s * 0.04 * wave(17.0, 0.7), s * (0.06 * wave(60.0, 0.0) + 0.02 * wave(230.0, 0.4))};
}

EightJoints::Command EightJoints::slow(double time_s) {
  const double s = soft(time_s);
  const auto wave = [time_s](double hz, double phase) { return std::sin(kTurn * hz * time_s + phase); };
  return {s * 3.0 * time_s, s * 0.004 * wave(9.0, 0.3), s * 0.005 * wave(7.0, 1.1),
          s * 0.04 * wave(17.0, 0.7), s * 0.02 * wave(12.0, 0.0)};
}

EightJoints::Values EightJoints::forces(const Command& command, const Values& q, const Values& v) const {
  const auto& [roller_rad, x_m, y_m, a_rad, b_rad] = command;
  const auto loop = [this](double inertia, double hz, double error, double speed) {
    const double wn = kTurn * hz;
    return inertia * (wn * wn * error - 2.0 * zeta * wn * speed);
  };
  const auto twist = [this](double angle, double speed) {
    // Natural frequency of rotor and mirror against each other.
    const double wn = kTurn * twist_hz;
    return -mirror_kg_m2 * rotor_kg_m2 / (mirror_kg_m2 + rotor_kg_m2) *
           (wn * wn * angle + 2.0 * twist_damping * wn * speed);
  };
  const double stretch_n = belt_n_m * (roller_radius_m * q[kRoller] - q[kBelt]) +
                           belt_n_s_m * (roller_radius_m * v[kRoller] - v[kBelt]);
  const double shaft = rotor_kg_m2 + mirror_kg_m2;
  const double ws = kTurn * stepper_hz;
  Values f{};
  f[kRoller] =
      loop(roller_kg_m2, roller_hz, roller_rad - q[kRoller], v[kRoller]) - roller_radius_m * stretch_n;
  f[kBelt] = stretch_n;
  f[kX] = loop(bridge_kg + carriage_kg, gantry_hz, x_m - q[kX], v[kX]);
  f[kY] = loop(carriage_kg, gantry_hz, y_m - q[kY], v[kY]);
  f[kRotorA] = -shaft * ws * ws / stepper_teeth * std::sin(stepper_teeth * (q[kRotorA] - a_rad)) -
               shaft * 2.0 * stepper_zeta * ws * v[kRotorA];
  f[kTwistA] = twist(q[kTwistA], v[kTwistA]);
  f[kRotorB] = loop(shaft, galvo_hz, b_rad - q[kRotorB], v[kRotorB]);
  f[kTwistB] = twist(q[kTwistB], v[kTwistB]);
  return f;
}

// Accelerations by Lagrange, with T = 1/2 (J_r phi'² + m_b s'² + M_x x'² + M_y y'²)
//   + 1/2 m |(x' - e sin(a) a', y' - e cos(a) a')|² + 1/2 J_rot a'² + 1/2 J_mir (a' + alpha')²
//   + 1/2 m |(x', y' - e sin(b) b', e cos(b) b')|²  + 1/2 J_rot b'² + 1/2 J_mir (b' + beta')²
// and V = m g e sin(b). The twists follow from the rest and leave four unknowns x'', y'', a'', b''.
EightJoints::Values EightJoints::accelerations(const Values& q, const Values& v, const Values& force) const {
  const double me = mirror_kg * unbalance_m;
  const double sin_a = std::sin(q[kRotorA]), cos_a = std::cos(q[kRotorA]);
  const double sin_b = std::sin(q[kRotorB]), cos_b = std::cos(q[kRotorB]);
  const double a2 = square(v[kRotorA]), b2 = square(v[kRotorB]);
  const double shaft = rotor_kg_m2 + me * unbalance_m;
  // The rows are x, y, a, b. The mirror's inertia leaves the rows of a and b with its twist.
  const double mass_x = bridge_kg + carriage_kg + 2.0 * mirror_kg;
  const double mass_y = carriage_kg + 2.0 * mirror_kg;
  const double right_x = force[kX] + me * cos_a * a2;
  const double right_y = force[kY] - me * sin_a * a2 + me * cos_b * b2;
  const double right_a = force[kRotorA] - force[kTwistA];
  const double right_b = force[kRotorB] - force[kTwistB] - me * gravity_m_s2 * cos_b;
  // The accelerations a'' and b'' from their rows, put into those of x and y:
  //   shaft a'' = right_a + me (sin a x'' + cos a y''),  shaft b'' = right_b + me sin b y''.
  const double share = me / shaft;
  const double xx = mass_x - me * share * sin_a * sin_a;
  const double xy = -me * share * sin_a * cos_a;
  const double yy = mass_y - me * share * (cos_a * cos_a + sin_b * sin_b);
  const double rx = right_x + share * sin_a * right_a;
  const double ry = right_y + share * (cos_a * right_a + sin_b * right_b);
  const double determinant = xx * yy - xy * xy;
  Values acc{};
  acc[kRoller] = force[kRoller] / roller_kg_m2;
  acc[kBelt] = force[kBelt] / belt_kg;
  acc[kX] = (yy * rx - xy * ry) / determinant;
  acc[kY] = (xx * ry - xy * rx) / determinant;
  acc[kRotorA] = (right_a + me * (sin_a * acc[kX] + cos_a * acc[kY])) / shaft;
  acc[kRotorB] = (right_b + me * sin_b * acc[kY]) / shaft;
  acc[kTwistA] = force[kTwistA] / mirror_kg_m2 - acc[kRotorA];
  acc[kTwistB] = force[kTwistB] / mirror_kg_m2 - acc[kRotorB];
  return acc;
}

Eigen::Vector2d EightJoints::gantry_mm(const Values& q) { return {kMetre_mm * q[kX], kMetre_mm * q[kY]}; }

double EightJoints::belt_mm(const Values& q) { return kMetre_mm * q[kBelt]; }

Eigen::Vector2d EightJoints::spot_mm(const Values& q) {
  return gantry_mm(q) + PaperHead{}.spot_mm({q[kRotorA] + q[kTwistA], q[kRotorB] + q[kTwistB]});
}

EightJoints::Values HandEight::q() const {
  EightJoints::Values q{};
  std::copy_n(state_.begin(), q.size(), q.begin());
  return q;
}

}  // namespace kerfbench::validation
