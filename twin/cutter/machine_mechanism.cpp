// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/machine_mechanism.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "twin/base/constants.h"
#include "twin/optics/scan_head.h"

namespace kerfbench::twin {
namespace {

constexpr double kGravity_m_s2 = 9.80665;
// Inertia of bodies that never turn: without effect, but Bullet requires one.
constexpr double kUnused_kg_m2 = 0.1;
// Speeds that no machine has: 10 million rpm, and Mach 3.
constexpr double kMostTurn_rad_s = 1e6;
constexpr double kMostSlide_m_s = 1e3;
constexpr double kMostOfLimit = 100.0;

using JointKind = JointDescription::Kind;
using Eigen::Vector3d;

double clampedTo(double value, double limit) { return std::clamp(value, -limit, limit); }

class Assembly {
 public:
  Assembly(const MachineDescription& machine, const WebDescription& web) : machine_(machine), web_(web) {}

  MachineMechanism build() {
    addFrame();
    addConveyor();
    if (machine_.kind == MachineDescription::Kind::kGantry) {
      addGantry();
    } else {
      addMirrors();
    }
    addConveyorDrive();
    return std::move(result_);
  }

 private:
  std::size_t slide(const std::string& name, int parent, const Vector3d& place_m, const Vector3d& axis,
                    double mass_kg) {
    return add(
        {name, JointKind::kPrismatic, parent, place_m, axis, mass_kg, kUnused_kg_m2, 0.0, kMostSlide_m_s});
  }
  std::size_t rotor(const std::string& name, int parent, const Vector3d& place_m, const Vector3d& axis,
                    double inertia_kg_m2) {
    return add({name, JointKind::kRevolute, parent, place_m, axis, 0.0, inertia_kg_m2, 0.0, kMostTurn_rad_s});
  }
  std::size_t add(JointDescription joint) {
    result_.description.joints.push_back(std::move(joint));
    return result_.description.joints.size() - 1;
  }
  JointDescription& joint(std::size_t index) { return result_.description.joints[index]; }

  void addFrame();
  void addConveyor();
  void addConveyorDrive();
  void addGantry();
  void addMirrors();
  std::size_t addMotor(Axis axis, int carrier, const Vector3d& place_m, const Vector3d& direction);
  void addTransmission(Axis axis, std::size_t motor, std::size_t load, double load_m_per_motor, double play_m,
                       double start_load);
  void addDrive(Axis axis, std::size_t motor, double inertia_kg_m2, double load_per_motor);

  const MachineDescription& machine_;
  const WebDescription& web_;
  MachineMechanism result_;
  int carrier_{-1};          ///< Body that carries the head: frame or floor.
  double roller_load_nm_{};  ///< Torque that the roller's drive bears at t = 0.
};

void Assembly::addFrame() {
  if (!machine_.frame) return;
  const FrameDescription& frame = *machine_.frame;
  const std::size_t x = slide("frame.x", -1, Vector3d::Zero(), Vector3d::UnitX(), 0.0);
  const std::size_t y =
      slide("frame.y", static_cast<int>(x), Vector3d::Zero(), Vector3d::UnitY(), frame.mass_kg);
  result_.frame_x = x;
  result_.frame_y = y;
  carrier_ = static_cast<int>(y);
  for (const auto& [feet, direction] : {std::pair(x, std::size_t{0}), std::pair(y, std::size_t{1})}) {
    result_.description.couplings.push_back({feet, 1.0, std::nullopt, 0.0, frame.stiffness_n_m.at(direction),
                                             frame.damping_n_s_m.at(direction), 0.0, 0.0});
  }
}

void Assembly::addConveyor() {
  const BeltDescription& belt = machine_.belt;
  const double radius_m = belt.roller_radius_mm / kMetre_mm;
  const double speed_m_s = web_.fed_by_controller ? 0.0 : web_.belt_speed_mm_s / kMetre_mm;
  // The belt's upper run moves along +Wx when the roller turns about +Wy.
  result_.roller =
      rotor("belt.roller", -1, {0.5, 0.0, -radius_m}, Vector3d::UnitY(), belt.roller_inertia_kg_m2);
  result_.belt = slide("belt", -1, Vector3d::Zero(), Vector3d::UnitX(), belt.mass_kg);
  result_.sheet_x =
      slide("sheet.x", static_cast<int>(result_.belt), Vector3d::Zero(), Vector3d::UnitX(), 0.0);
  result_.sheet_y = slide("sheet.y", static_cast<int>(result_.sheet_x), Vector3d::Zero(), Vector3d::UnitY(),
                          belt.sheet_mass_kg);
  joint(result_.roller).start_speed = speed_m_s / radius_m;
  joint(result_.belt).start_speed = speed_m_s;

  JointFriction bed{result_.belt, std::nullopt, belt.bed_friction, 0.0, 0.0};
  const double direction = static_cast<double>((speed_m_s > 0) - (speed_m_s < 0));
  bed.start_load = direction * belt.bed_friction.coulomb;
  const double grip_n = belt.sheet_friction * belt.sheet_mass_kg * kGravity_m_s2;
  const double drag_n = std::hypot(belt.sheet_drag_n[0], belt.sheet_drag_n[1]);
  const double held = drag_n > grip_n ? grip_n / drag_n : 1.0;
  JointFriction grip{result_.sheet_x, result_.sheet_y, {}, 0.0, 0.0};
  grip.friction.coulomb = grip_n;
  grip.start_load = held * belt.sheet_drag_n[0];
  grip.start_load_across = held * belt.sheet_drag_n[1];
  result_.description.frictions.push_back(bed);
  result_.description.frictions.push_back(grip);
  // Forces on the sheet act, over the belt's coordinate, on all that stands on the belt.
  result_.description.constant_forces = {{result_.belt, belt.sheet_drag_n[0]},
                                         {result_.sheet_x, belt.sheet_drag_n[0]},
                                         {result_.sheet_y, belt.sheet_drag_n[1]}};

  const double pull_n = bed.start_load + belt.bed_friction.viscous * speed_m_s - grip.start_load;
  roller_load_nm_ = pull_n * radius_m;
  // Stretch is belt minus roller: it is negative where the roller drives.
  result_.description.couplings.push_back(
      {result_.belt, 1.0, result_.roller, -radius_m, belt.stiffness_n_m, belt.damping_n_s_m, 0.0, -pull_n});
}

std::size_t Assembly::addMotor(Axis axis, int carrier, const Vector3d& place_m, const Vector3d& direction) {
  const AxisDescription& description = axisOf(machine_, axis);
  const std::size_t motor = rotor(std::string(nameOf(axis)) + ".motor", carrier, place_m, direction,
                                  description.motor_inertia_kg_m2);
  if (const auto* servo = std::get_if<ServoDescription>(&description.drive)) {
    joint(motor).most_speed = std::min(kMostTurn_rad_s, kMostOfLimit * servo->max_speed);
  }
  return motor;
}

void Assembly::addTransmission(Axis axis, std::size_t motor, std::size_t load, double load_m_per_motor,
                               double play_m, double start_load) {
  const AxisDescription& description = axisOf(machine_, axis);
  result_.description.couplings.push_back({load, 1.0, motor, -load_m_per_motor, description.stiffness,
                                           description.stiffness_damping, play_m, start_load});
}

void Assembly::addDrive(Axis axis, std::size_t motor, double inertia_kg_m2, double load_per_motor) {
  const AxisDescription& description = axisOf(machine_, axis);
  JointDrive drive;
  drive.name = nameOf(axis);
  drive.joint = motor;
  drive.drive = description.drive;
  drive.inertia_kg_m2 = inertia_kg_m2;
  result_.description.drives.push_back(drive);
  const auto* servo = std::get_if<ServoDescription>(&description.drive);
  result_.pulse_drives.push_back({axis, description.step / load_per_motor, load_per_motor,
                                  servo != nullptr ? servo->input_delay_s : 0.0});
}

void Assembly::addGantry() {
  constexpr double kBridgeHeight_m = 0.3;
  const Vector3d bridge_place(0.0, 0.0, kBridgeHeight_m);
  // The y carriage rides on the x bridge; the bridge's own mass is what x moves beyond the carriage.
  const double carriage_kg = machine_.gantry_y.load_inertia;
  const double bridge_kg = machine_.gantry_x.load_inertia - carriage_kg;
  const Vector3d across(-std::sin(machine_.squareness_rad), std::cos(machine_.squareness_rad), 0.0);
  const std::size_t motor_x = addMotor(Axis::kGantryX, carrier_, bridge_place, Vector3d::UnitY());
  const std::size_t bridge = slide("gantry_x.bridge", carrier_, bridge_place, Vector3d::UnitX(), bridge_kg);
  const int on_bridge = static_cast<int>(bridge);
  const std::size_t motor_y = addMotor(Axis::kGantryY, on_bridge, Vector3d::Zero(), Vector3d::UnitZ());
  const std::size_t carriage = slide("gantry_y.carriage", on_bridge, Vector3d::Zero(), across, carriage_kg);
  result_.head_x = bridge;
  result_.head_y = carriage;
  for (const auto& [axis, motor, load] :
       {std::tuple(Axis::kGantryX, motor_x, bridge), std::tuple(Axis::kGantryY, motor_y, carriage)}) {
    const AxisDescription& description = axisOf(machine_, axis);
    const double m_per_rad = description.load_per_motor / kMetre_mm;
    addTransmission(axis, motor, load, m_per_rad, description.backlash / kMetre_mm, 0.0);
    result_.description.frictions.push_back({load, std::nullopt, description.friction, 0.0, 0.0});
    addDrive(axis, motor, description.motor_inertia_kg_m2 + description.load_inertia * m_per_rad * m_per_rad,
             description.load_per_motor);
  }
}

void Assembly::addMirrors() {
  const ScanHead head(machine_.head, machine_.beam);
  const auto mirror = [&](Axis axis, const Vector3d& place_mm, const Vector3d& direction) {
    const AxisDescription& description = axisOf(machine_, axis);
    const Vector3d place_m = place_mm / kMetre_mm;
    const std::size_t motor = addMotor(axis, carrier_, place_m, direction);
    // The load is a sibling of its motor, not a child: balanced rotors on one axis feel each other by the
    // coupling alone, and absolute angles allow any ratio.
    const std::size_t load =
        rotor(std::string(nameOf(axis)) + ".mirror", carrier_, place_m, direction, description.load_inertia);
    const double ratio = description.load_per_motor;
    addTransmission(axis, motor, load, ratio, description.backlash, 0.0);
    result_.description.frictions.push_back({load, std::nullopt, description.friction, 0.0, 0.0});
    addDrive(axis, motor, description.motor_inertia_kg_m2 + description.load_inertia * ratio * ratio, ratio);
    return load;
  };
  result_.head_x = mirror(Axis::kGalvoX, head.xMirrorPlace_mm(), head.xMirrorAxis());
  result_.head_y = mirror(Axis::kGalvoY, head.yMirrorPlace_mm(), head.yMirrorAxis());
}

void Assembly::addConveyorDrive() {
  const BeltDescription& belt = machine_.belt;
  const double radius_m = belt.roller_radius_mm / kMetre_mm;
  const double moved_kg_m2 =
      belt.roller_inertia_kg_m2 + (belt.mass_kg + belt.sheet_mass_kg) * radius_m * radius_m;
  if (web_.fed_by_controller) {
    const AxisDescription& feed = belt.feed;
    const double ratio = feed.load_per_motor;
    const std::size_t motor = addMotor(Axis::kFeed, -1, {0.5, 0.3, -radius_m}, Vector3d::UnitY());
    addTransmission(Axis::kFeed, motor, result_.roller, ratio, feed.backlash, -roller_load_nm_);
    result_.description.frictions.push_back({result_.roller, std::nullopt, feed.friction, 0.0, 0.0});
    addDrive(Axis::kFeed, motor, feed.motor_inertia_kg_m2 + moved_kg_m2 * ratio * ratio,
             ratio * belt.roller_radius_mm);
    result_.description.drives.back().start_torque_nm = roller_load_nm_ * ratio;
    return;
  }
  JointDrive line;
  line.name = "line";
  line.joint = result_.roller;
  line.drive = belt.line_servo;
  line.inertia_kg_m2 = moved_kg_m2;
  line.start_speed = joint(result_.roller).start_speed;
  line.start_command = -line.start_speed * belt.line_servo.input_delay_s;
  line.start_torque_nm = clampedTo(roller_load_nm_, belt.line_servo.max_torque);
  result_.description.drives.push_back(line);
  result_.line_drive = true;
  result_.line_delay_s = belt.line_servo.input_delay_s;
}

}  // namespace

const char* nameOf(Axis axis) {
  constexpr std::array<const char*, kAxisCount> kNames{"galvo_x", "galvo_y", "gantry_x", "gantry_y", "feed"};
  return kNames.at(static_cast<std::size_t>(axis));
}

const AxisDescription& axisOf(const MachineDescription& machine, Axis axis) {
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

MachineMechanism mechanismOf(const MachineDescription& machine, const WebDescription& web) {
  return Assembly(machine, web).build();
}

}  // namespace kerfbench::twin
