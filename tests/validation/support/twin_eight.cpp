// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/support/twin_eight.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/validation/support/section.h"

namespace kerfbench::validation {
namespace {

using Eigen::Vector3d;
using twin::JointDescription;
using Kind = JointDescription::Kind;

constexpr double kWholeTurn = 2.0 * std::numbers::pi;

JointDescription joint(const char* name, Kind kind, int parent, const Vector3d& place_m, const Vector3d& axis,
                       double mass_kg, double inertia_kg_m2) {
  JointDescription result;
  result.name = name;
  result.kind = kind;
  result.parent = parent;
  result.p_PJ_m = place_m;
  result.axis = axis;
  result.mass_kg = mass_kg;
  result.inertia_kg_m2 = inertia_kg_m2;
  return result;
}

twin::JointDrive servo(const char* name, std::size_t joint, double hz, double zeta, double inertia) {
  twin::ServoDescription description;
  description.natural_frequency_rad_s = kWholeTurn * hz;
  description.damping = zeta;
  twin::JointDrive drive;
  drive.name = name;
  drive.joint = joint;
  drive.drive = description;
  drive.inertia_kg_m2 = inertia;
  return drive;
}

twin::CouplingDescription twist(const EightJoints& m, std::size_t joint) {
  const double reduced = m.mirror_kg_m2 * m.rotor_kg_m2 / (m.mirror_kg_m2 + m.rotor_kg_m2);
  const double wn = kWholeTurn * m.twist_hz;
  twin::CouplingDescription coupling;
  coupling.a = joint;
  coupling.stiffness = reduced * wn * wn;
  coupling.damping = 2.0 * m.twist_damping * reduced * wn;
  return coupling;
}

}  // namespace

std::shared_ptr<const twin::Mechanism> twinEight(const EightJoints& m) {
  const Vector3d origin = Vector3d::Zero();
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  twin::MechanismDescription d;
  d.joints = {joint("roller", Kind::kRevolute, -1, {0.5, 0.0, -m.roller_radius_m}, y, 5.0, m.roller_kg_m2),
              joint("belt", Kind::kPrismatic, -1, origin, x, m.belt_kg, 0.1),
              joint("x", Kind::kPrismatic, -1, {0.0, 0.0, 0.3}, x, m.bridge_kg, 0.1),
              joint("y", Kind::kPrismatic, EightJoints::kX, origin, y, m.carriage_kg, 0.1),
              joint("rotor A", Kind::kRevolute, EightJoints::kY, {0.0, -0.015, 0.5}, -z, 0.0, m.rotor_kg_m2),
              joint("mirror A", Kind::kRevolute, EightJoints::kRotorA, m.unbalance_m * x, -z, m.mirror_kg,
                    m.mirror_kg_m2),
              joint("rotor B", Kind::kRevolute, EightJoints::kY, {0.0, 0.0, 0.5}, x, 0.0, m.rotor_kg_m2),
              joint("mirror B", Kind::kRevolute, EightJoints::kRotorB, m.unbalance_m * y, x, m.mirror_kg,
                    m.mirror_kg_m2)};
  twin::CouplingDescription belt;
  belt.a = EightJoints::kBelt;
  belt.b = EightJoints::kRoller;
  belt.ratio_b = -m.roller_radius_m;
  belt.stiffness = m.belt_n_m;
  belt.damping = m.belt_n_s_m;
  d.couplings = {belt, twist(m, EightJoints::kTwistA), twist(m, EightJoints::kTwistB)};
  const double shaft = m.rotor_kg_m2 + m.mirror_kg_m2;
  const double ws = kWholeTurn * m.stepper_hz;
  twin::StepperDescription stepper;
  stepper.rotor_teeth = static_cast<int>(m.stepper_teeth);
  stepper.holding_torque_nm = shaft * ws * ws / m.stepper_teeth;
  stepper.damping_nm_s = shaft * 2.0 * m.stepper_zeta * ws;
  twin::JointDrive a;
  a.name = "stepper A";
  a.joint = EightJoints::kRotorA;
  a.drive = stepper;
  a.inertia_kg_m2 = shaft;
  d.drives = {servo("roller", EightJoints::kRoller, m.roller_hz, m.zeta, m.roller_kg_m2),
              servo("x", EightJoints::kX, m.gantry_hz, m.zeta, m.bridge_kg + m.carriage_kg),
              servo("y", EightJoints::kY, m.gantry_hz, m.zeta, m.carriage_kg), a,
              servo("galvo B", EightJoints::kRotorB, m.galvo_hz, m.zeta, shaft)};
  return std::make_shared<twin::Mechanism>(std::move(d));
}

EightJoints::Values jointsOf(std::span<const double> q) {
  EightJoints::Values values{};
  std::copy_n(q.begin(), values.size(), values.begin());
  return values;
}

void EightErrors::add(const EightJoints::Values& truth, const EightJoints::Values& found) {
  constexpr double kUm = 1e3;
  raiseTo(spot_um, kUm * (EightJoints::spot_mm(truth) - EightJoints::spot_mm(found)).norm());
  raiseTo(belt_um, kUm * std::abs(EightJoints::belt_mm(truth) - EightJoints::belt_mm(found)));
  raiseTo(gantry_um, kUm * (EightJoints::gantry_mm(truth) - EightJoints::gantry_mm(found)).norm());
}

}  // namespace kerfbench::validation
