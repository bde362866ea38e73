// SPDX-License-Identifier: Apache-2.0
#include "twin/machine/force_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerfbench::twin {
namespace {

using Piece = ForceLaw::Piece;

int sideOf(double value, double limit) {
  return static_cast<int>(value > limit) - static_cast<int>(value < -limit);
}

double stretch(const SpringLaw& s, const double* q) {
  return s.ratio_a * q[s.a] + s.ratio_b * q[s.b] + s.rest;
}
double stretching(const SpringLaw& s, const double* v) { return s.ratio_a * v[s.a] + s.ratio_b * v[s.b]; }

// Depth by which the flank of a side (+1 or -1) is pressed in; positive for +1, negative for -1.
double pressed(const SpringLaw& s, int side, const double* q) { return stretch(s, q) - side * s.half_play; }

int touching(const SpringLaw& s, const double* q, const double* v) {
  const int side = sideOf(stretch(s, q), s.half_play);
  if (side == 0) return 0;
  const double spring = side * s.stiffness * pressed(s, side, q);
  const double damper = side * s.damping * stretching(s, v);
  if (spring + damper <= 0) return 0;
  return damper > spring ? 2 * side : side;
}

double held(const FrictionLaw& f, const double* v, const double* aux) {
  return f.stiffness * aux[f.bristle] + f.damping * v[f.joint];
}
double heldAcross(const FrictionLaw& f, const double* v, const double* aux) {
  return f.stiffness * aux[f.bristle + 1] + f.damping * v[f.across];
}

int sliding(const FrictionLaw& f, const double* v, const double* aux) {
  const double along = held(f, v, aux);
  if (!f.plane) return sideOf(along, f.limit);
  const double across = heldAcross(f, v, aux);
  return along * along + across * across > f.limit * f.limit ? 1 : 0;
}

double filtered(const ServoLaw& s, const double* aux, double u) {
  return s.feedforward > 0 ? (u - aux[s.filter]) / s.filter_s : 0.0;
}
double speedWanted(const ServoLaw& s, double q, double u, double command_speed) {
  return s.speed_per_error * (u + s.offset - q) + s.feedforward * command_speed;
}

void addSpring(const SpringLaw& s, int side, const double* q, const double* v, double* force) {
  double pull = 0.0;
  if (s.half_play == 0) {
    pull = s.stiffness * stretch(s, q) + s.damping * stretching(s, v);
  } else if (side == 1 || side == -1) {
    pull = s.stiffness * pressed(s, side, q) + s.damping * stretching(s, v);
  } else if (side != 0) {
    pull = 2.0 * s.stiffness * pressed(s, side / 2, q);
  }
  force[s.a] -= s.ratio_a * pull;
  force[s.b] -= s.ratio_b * pull;
}

void addFriction(const FrictionLaw& f, int side, const double* v, const double* aux, double* force,
                 double* rate) {
  force[f.joint] -= f.viscous * v[f.joint];
  if (f.plane) force[f.across] -= f.viscous * v[f.across];
  if (f.limit == 0) return;
  if (side == 0) {  // The friction holds: the bristle moves with the joint.
    force[f.joint] -= held(f, v, aux);
    rate[f.bristle] = v[f.joint];
    if (!f.plane) return;
    force[f.across] -= heldAcross(f, v, aux);
    rate[f.bristle + 1] = v[f.across];
    return;
  }
  if (!f.plane) {
    const double slide = side * f.limit;
    force[f.joint] -= slide;
    rate[f.bristle] = (slide - f.stiffness * aux[f.bristle]) / f.damping;
    return;
  }
  const double along = held(f, v, aux);
  const double across = heldAcross(f, v, aux);
  const double share = f.limit / std::sqrt(along * along + across * across);
  force[f.joint] -= share * along;
  force[f.across] -= share * across;
  rate[f.bristle] = (share * along - f.stiffness * aux[f.bristle]) / f.damping;
  rate[f.bristle + 1] = (share * across - f.stiffness * aux[f.bristle + 1]) / f.damping;
}

/// Limits that a servo is at: as observed from its state, or as given by a piece of the affine law.
struct ServoSides {
  bool observed;
  int speed{0};
  int torque{0};
};

struct ServoState {
  double q, v, u;     // Joint position and speed, and command.
  const double* aux;  // Auxiliary states: filter and current.
};

void addServo(const ServoLaw& s, const ServoSides& sides, const ServoState& state, double* force,
              double* rate) {
  const auto& [q, v, u, aux] = state;
  int speed_side = sides.speed;
  int torque_side = sides.torque;
  const double command_speed = filtered(s, aux, u);
  if (s.feedforward > 0) rate[s.filter] = command_speed;
  double speed = speedWanted(s, q, u, command_speed);
  if (sides.observed) speed_side = sideOf(speed, s.max_speed);
  if (speed_side != 0) speed = speed_side * s.max_speed;
  double torque = s.torque_per_speed * (speed - v);
  if (sides.observed) torque_side = sideOf(torque, s.max_torque);
  if (torque_side != 0) torque = torque_side * s.max_torque;
  if (s.lag_s > 0) {
    rate[s.current] = (torque - aux[s.current]) / s.lag_s;
    torque = aux[s.current];
  }
  force[s.joint] += torque;
}

}  // namespace

double StepperLaw::pitch() const { return 2.0 * std::numbers::pi / teeth; }

double StepperLaw::fieldTorque(double q, double v, double u) const {
  double strength = holding;
  if (supply_limited) {
    const double speed = std::abs(v);
    const double reactance = reactance_per_speed * speed;
    const double most = std::max(0.0, supply_v - volt_per_speed * speed) /
                        (std::sqrt(resistance * resistance + reactance * reactance) * current);
    strength *= std::min(1.0, most);
  }
  double torque = -strength * std::sin(teeth * (q - u - offset));
  if (detent > 0) torque -= detent * std::sin(4.0 * teeth * q);
  return torque;
}

void ForceLaw::evaluate(const double* x, const double* u, double* force, double* rate) const {
  const double* q = x;
  const double* v = x + joints;
  const double* aux = v + joints;
  std::fill_n(force, joints, 0.0);
  for (const ConstantForce& c : constants) force[c.joint] += c.force;
  for (const SpringLaw& s : springs) {
    addSpring(s, s.half_play > 0 ? touching(s, q, v) : 0, q, v, force);
  }
  for (const FrictionLaw& f : frictions) {
    addFriction(f, f.limit > 0 ? sliding(f, v, aux) : 0, v, aux, force, rate);
  }
  for (const ServoLaw& s : servos) {
    addServo(s, {true}, {q[s.joint], v[s.joint], u[s.input], aux}, force, rate);
  }
  for (const StepperLaw& s : steppers) {
    force[s.joint] += s.fieldTorque(q[s.joint], v[s.joint], u[s.input]) - s.damping * v[s.joint];
  }
}

template <typename Each>
void ForceLaw::forEachPiece(const double* x, const double* u, const Each& each) const {
  const double* q = x;
  const double* v = x + joints;
  const double* aux = v + joints;
  for (const SpringLaw& s : springs) {
    if (!each(s.half_play > 0 ? touching(s, q, v) : 0)) return;
  }
  for (const FrictionLaw& f : frictions) {
    if (!each(f.limit > 0 ? sliding(f, v, aux) : 0)) return;
  }
  for (const ServoLaw& s : servos) {
    int speed_side = 0;
    int torque_side = 0;
    if (s.limited) {
      double speed = speedWanted(s, q[s.joint], u[s.input], filtered(s, aux, u[s.input]));
      speed_side = sideOf(speed, s.max_speed);
      if (speed_side != 0) speed = speed_side * s.max_speed;
      torque_side = sideOf(s.torque_per_speed * (speed - v[s.joint]), s.max_torque);
    }
    if (!each(speed_side) || !each(torque_side)) return;
  }
}

void ForceLaw::observe(const double* x, const double* u, Piece* pieces) const {
  forEachPiece(x, u, [&pieces](int piece) {
    *pieces++ = static_cast<Piece>(piece);
    return true;
  });
}

bool ForceLaw::isIn(const double* x, const double* u, const Piece* pieces) const {
  bool all = true;
  forEachPiece(x, u, [&](int piece) { return all = piece == *pieces++; });
  return all;
}

void ForceLaw::evaluateAffine(const double* x, const double* u, const Piece* pieces, double* force,
                              double* rate) const {
  const double* q = x;
  const double* v = x + joints;
  const double* aux = v + joints;
  std::fill_n(force, joints, 0.0);
  for (const ConstantForce& c : constants) force[c.joint] += c.force;
  for (const SpringLaw& s : springs) addSpring(s, *pieces++, q, v, force);
  for (const FrictionLaw& f : frictions) addFriction(f, *pieces++, v, aux, force, rate);
  for (const ServoLaw& s : servos) {
    addServo(s, {false, pieces[0], pieces[1]}, {q[s.joint], v[s.joint], u[s.input], aux}, force, rate);
    pieces += 2;
  }
  for (const StepperLaw& s : steppers) {
    force[s.joint] += s.springTorque(q[s.joint], u[s.input]) - s.damping * v[s.joint];
  }
}

bool ForceLaw::isAffine(const Piece* pieces) const {
  for (std::size_t i = 0; i < frictions.size(); ++i) {
    if (frictions[i].plane && pieces[springs.size() + i] != 0) return false;
  }
  return true;
}

}  // namespace kerfbench::twin
