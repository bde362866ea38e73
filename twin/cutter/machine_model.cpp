// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/machine_model.h"

namespace kerfbench::twin {
namespace {

constexpr double kMetre_mm = 1000.0;
constexpr std::size_t kRoller = 0;  // Joint numbers: the roller, then the two of the head.
constexpr std::size_t kFirst = 1;
constexpr std::size_t kSecond = 2;
// A head without mirrors still has a ScanHead object; its geometry is then never used.
constexpr double kUnusedThrow_mm = 1.0;

const AxisDescription& descriptionOf(const MachineDescription& machine, Axis axis) {
  switch (axis) {
    case Axis::kGalvoX:
      return machine.galvo_x;
    case Axis::kGalvoY:
      return machine.galvo_y;
    case Axis::kGantryX:
      return machine.gantry_x;
    case Axis::kGantryY:
      return machine.gantry_y;
    case Axis::kFeed:
    case Axis::kCount:
      break;
  }
  return machine.belt.feed;
}

// One pulse in the unit of the joint that it moves: rad of a mirror or of the roller, m of a gantry.
double jointStep(const MachineDescription& machine, Axis axis) {
  const double step = descriptionOf(machine, axis).step;
  switch (axis) {
    case Axis::kGantryX:
    case Axis::kGantryY:
      return step / kMetre_mm;
    case Axis::kFeed:
      return step / machine.belt.roller_radius_mm;
    default:
      return step;
  }
}

}  // namespace

MachineModel::MachineModel(const MachineDescription& machine, const WebDescription& web)
    : gantry_(machine.kind == MachineDescription::Kind::kGantry),
      roller_radius_mm_(machine.belt.roller_radius_mm),
      line_(web.belt_speed_mm_s, web.belt_speed_changes),
      head_(gantry_ ? kUnusedThrow_mm : machine.throw_mm, gantry_ ? 0.0 : machine.mirror_spacing_mm),
      body_(joints(machine)),
      commands_{
          PulseCommand(jointStep(machine, Axis::kGalvoX)), PulseCommand(jointStep(machine, Axis::kGalvoY)),
          PulseCommand(jointStep(machine, Axis::kGantryX)), PulseCommand(jointStep(machine, Axis::kGantryY)),
          PulseCommand(jointStep(machine, Axis::kFeed))} {
  const auto drive = [&](std::size_t joint, Axis axis) {
    const AxisDescription& description = descriptionOf(machine, axis);
    driven_.push_back({joint, Servo(description.servo, description.inertia), axis});
  };
  if (web.fed_by_controller) {
    driven_.push_back(
        {kRoller, Servo(machine.belt.feed.servo, machine.belt.roller_inertia_kg_m2), Axis::kFeed});
  } else {
    Servo line(machine.belt.line_servo, machine.belt.roller_inertia_kg_m2);
    const double speed_rad_s = line_.speed_mm_s(0.0) / roller_radius_mm_;
    // The mean command of the step before the first: from any other the drive would start with a jolt.
    line.reset(lineCommand_rad(-0.5 * kStep_s), speed_rad_s);
    body_.setState(kRoller, 0.0, speed_rad_s);
    driven_.push_back({kRoller, line, std::nullopt});
  }
  drive(kFirst, gantry_ ? Axis::kGantryX : Axis::kGalvoX);
  drive(kSecond, gantry_ ? Axis::kGantryY : Axis::kGalvoY);
}

std::vector<JointDescription> MachineModel::joints(const MachineDescription& machine) const {
  using Kind = JointDescription::Kind;
  constexpr double kMirrorMass_kg = 0.01;
  constexpr double kRollerMass_kg = 5.0;
  // The belt's upper run moves along +Wx when the roller turns about +Wy.
  std::vector<JointDescription> result{{Kind::kRevolute,
                                        -1,
                                        {0.5, 0.0, -roller_radius_mm_ / kMetre_mm},
                                        Eigen::Vector3d::UnitY(),
                                        kRollerMass_kg,
                                        machine.belt.roller_inertia_kg_m2}};
  if (gantry_) {
    // The y carriage rides on the x bridge; the bridge's own mass is what x moves beyond the carriage.
    const double carriage_kg = machine.gantry_y.inertia;
    const double bridge_kg = machine.gantry_x.inertia - carriage_kg;
    result.push_back({Kind::kPrismatic, -1, {0.0, 0.0, 0.3}, Eigen::Vector3d::UnitX(), bridge_kg, 0.1});
    result.push_back({Kind::kPrismatic, 1, {0.0, 0.0, 0.0}, Eigen::Vector3d::UnitY(), carriage_kg, 0.1});
  } else {
    result.push_back({Kind::kRevolute, -1, head_.xMirrorPlace_mm() / kMetre_mm, ScanHead::xMirrorAxis(),
                      kMirrorMass_kg, machine.galvo_x.inertia});
    result.push_back({Kind::kRevolute, -1, head_.yMirrorPlace_mm() / kMetre_mm, ScanHead::yMirrorAxis(),
                      kMirrorMass_kg, machine.galvo_y.inertia});
  }
  return result;
}

double MachineModel::lineCommand_rad(double mid_s) const {
  return line_.travel_mm(mid_s) / roller_radius_mm_;
}

void MachineModel::step(double begin_s) {
  std::array<double, 3> mean{};
  for (std::size_t i = 0; i < driven_.size(); ++i) {
    mean.at(i) = driven_[i].axis ? command(*driven_[i].axis).meanOver(begin_s, begin_s + kStep_s)
                                 : lineCommand_rad(begin_s + 0.5 * kStep_s);
  }
  const double speed_before = body_.qd()[kRoller];
  body_.step(kStep_s, [&](std::span<const double> q, std::span<const double> qd, std::span<double> torque) {
    for (std::size_t i = 0; i < driven_.size(); ++i) {
      const std::size_t joint = driven_[i].joint;
      torque[joint] = driven_[i].servo.torque(mean.at(i), q[joint], qd[joint], kStep_s);
    }
  });
  belt_acceleration_mm_s2_ = (body_.qd()[kRoller] - speed_before) / kStep_s * roller_radius_mm_;
}

double MachineModel::beltTravel_mm() const { return body_.q()[kRoller] * roller_radius_mm_; }
double MachineModel::beltSpeed_mm_s() const { return body_.qd()[kRoller] * roller_radius_mm_; }

Eigen::Vector2d MachineModel::gantry_mm() const {
  if (!gantry_) return Eigen::Vector2d::Zero();
  return kMetre_mm * Eigen::Vector2d(body_.q()[kFirst], body_.q()[kSecond]);
}

std::optional<BeamSpot> MachineModel::spot() const {
  if (gantry_) {
    const Eigen::Vector3d head_m = body_.pose(kSecond).translation();
    return gantrySpot(kMetre_mm * head_m.x(), kMetre_mm * head_m.y());
  }
  return head_.spotAt(body_.pose(kFirst).linear(), body_.pose(kSecond).linear());
}

}  // namespace kerfbench::twin
