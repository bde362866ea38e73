// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/machine_faults.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "twin/cutter/machine_mechanism.h"
#include "twin/cutter/machine_model.h"
#include "twin/description/axis_faults.h"
#include "twin/description/fault_list.h"

namespace kerfbench::twin {
namespace {

constexpr double kFar_mm = 1e6;
constexpr double kDegree = std::numbers::pi / 180.0;
// Largest optical angle of the field; mirrors of any make stop before. A lens has the same limit.
constexpr double kMostField_rad = LensDescription::kMaxFieldAngle_rad;

using Kind = MachineDescription::Kind;

void findSignalFaults(FaultList& faults, const SignalMap& map) {
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    const auto signal = static_cast<Signal>(i);
    const auto pin = map.pin(signal);
    if (!pin) continue;
    faults.require(pin->bit < 16,
                   std::string(signalName(signal)) + " is on bit " + std::to_string(pin->bit) + " of 16");
    for (std::size_t k = 0; k < i; ++k) {
      const auto other = static_cast<Signal>(k);
      if (isEnable(other) && isEnable(signal)) continue;  // One pin may enable several drives.
      faults.require(map.pin(other) != pin, std::string(signalName(other)) + " and " +
                                                std::string(signalName(signal)) + " share a pin");
    }
  }
}

AxisLoad loadOf(const MachineDescription& machine, Axis axis) {
  const AxisDescription& description = axisOf(machine, axis);
  const FrictionDescription& friction = description.friction;
  if (axis == Axis::kGantryX || axis == Axis::kGantryY) {
    return {"kg",
            description.load_inertia,
            description.load_per_motor / 1000.0,
            friction.coulomb,
            "N",
            10.0,
            "mm",
            10.0,
            "mm"};
  }
  if (axis == Axis::kFeed) {
    const BeltDescription& belt = machine.belt;
    return {"kg m²",
            belt.roller_inertia_kg_m2,
            description.load_per_motor,
            friction.coulomb + belt.bed_friction.coulomb * belt.roller_radius_mm / 1000.0,
            "N m",
            10.0,
            "mm",
            0.1,
            "rad"};
  }
  return {"kg m²",
          description.load_inertia,
          description.load_per_motor,
          friction.coulomb,
          "N m",
          0.01,
          "rad",
          0.1,
          "rad"};
}

void findBeltFaults(FaultList& faults, const BeltDescription& belt, const PrintLayout& print) {
  faults.positive("belt.roller_radius", belt.roller_radius_mm, 1e4, "mm");
  faults.positive("belt.roller_inertia", belt.roller_inertia_kg_m2, 1e4, "kg m²");
  faults.positive("belt.mass", belt.mass_kg, 1e5, "kg");
  faults.positive("belt.stiffness", belt.stiffness_n_m, 1e12, "N/m");
  faults.within("belt.damping", belt.damping_n_s_m, 0.0, 1e9, "N s/m");
  faults.within("belt.bed_friction.coulomb", belt.bed_friction.coulomb, 0.0, 1e6, "N");
  faults.within("belt.bed_friction.viscous", belt.bed_friction.viscous, 0.0, 1e7, "N s/m");
  faults.positive("belt.bed_friction.presliding", belt.bed_friction.presliding, 0.1, "m");
  faults.positive("belt.sheet_mass", belt.sheet_mass_kg, 1e4, "kg");
  faults.positive("belt.sheet_friction", belt.sheet_friction, 1e3, "");
  faults.within("belt.sheet_drag along x", belt.sheet_drag_n[0], -1e5, 1e5, "N");
  faults.within("belt.sheet_drag along y", belt.sheet_drag_n[1], -1e5, 1e5, "N");
  const double radius_m = belt.roller_radius_mm / 1000.0;
  requireResolved(faults, "belt: roller against belt", belt.stiffness_n_m,
                  belt.roller_inertia_kg_m2 / (radius_m * radius_m), belt.mass_kg, MachineModel::kStep_s);
  if (belt.bed_friction.coulomb > 0.0) {
    requireResolved(faults, "belt: the belt in its bed's presliding",
                    belt.bed_friction.coulomb / belt.bed_friction.presliding, belt.mass_kg,
                    std::numeric_limits<double>::infinity(), MachineModel::kStep_s);
  }

  faults.positive("encoder.count", belt.encoder.count_mm, 1e3, "mm");
  faults.within("encoder.jitter", belt.encoder.jitter_counts, 0.0, 0.2, "counts");
  // A runout larger than a tenth of the radius is not a mounting error any more.
  faults.within("encoder.runout", belt.encoder.runout_mm, 0.0, 0.1 * belt.roller_radius_mm, "mm");
  faults.within("encoder.runout_phase", belt.encoder.runout_phase_rad, -1e3, 1e3, "rad");
  faults.within("print_mark_sensor.x", belt.print_mark_sensor.x_mm, -kFar_mm, kFar_mm, "mm");
  faults.within("print_mark_sensor.jitter", belt.print_mark_sensor.jitter_mm, 0.0, 10.0, "mm");
  faults.within("print_mark_sensor.hysteresis", belt.print_mark_sensor.hysteresis_mm, 0.0,
                std::max(10.0, print.eye_mark_length_mm), "mm");
}

// Finds faults of the line's own drive, which sits on the roller and pulls the belt.
void findLineFaults(FaultList& faults, const BeltDescription& belt, double speed_mm_s) {
  findServoFaults(faults, "line", belt.line_servo, MachineModel::kStep_s);
  const double radius_m = belt.roller_radius_mm / 1000.0;
  const double to_roller = radius_m * radius_m;
  requireQuietServo(faults, "line", belt.line_servo,
                    {belt.roller_inertia_kg_m2, (belt.mass_kg + belt.sheet_mass_kg) * to_roller,
                     belt.stiffness_n_m * to_roller, belt.damping_n_s_m * to_roller});
  const double rub_n = belt.bed_friction.coulomb + belt.bed_friction.viscous * std::abs(speed_mm_s) / 1000.0;
  faults.require(!(rub_n * radius_m >= belt.line_servo.max_torque),
                 "line: the drive's " + FaultList::text(belt.line_servo.max_torque) +
                     " N m cannot pull a belt that rubs with " + FaultList::text(rub_n) + " N");
}

void findFrameFaults(FaultList& faults, const FrameDescription& frame) {
  faults.positive("frame.mass", frame.mass_kg, 1e6, "kg");
  for (const auto& [name, i] : {std::pair("x", std::size_t{0}), std::pair("y", std::size_t{1})}) {
    faults.positive(std::string("frame.stiffness along ") + name, frame.stiffness_n_m.at(i), 1e12, "N/m");
    faults.within(std::string("frame.damping along ") + name, frame.damping_n_s_m.at(i), 0.0, 1e9, "N s/m");
    requireResolved(faults, std::string("frame along ") + name, frame.stiffness_n_m.at(i), frame.mass_kg,
                    std::numeric_limits<double>::infinity(), MachineModel::kStep_s);
  }
}

// Requires that two mirrors and a lens can send the beam to the corner.
void requireReach(FaultList& faults, const MachineDescription& machine, double corner_mm) {
  const auto& lens = machine.head.lens;
  if (lens) {
    const double t = kMostField_rad;
    const double most_mm = lens->focal_length_mm * t * (1.0 + t * t * (lens->k1 + t * t * lens->k2));
    faults.require(!(corner_mm > most_mm), "the field's corner is " + FaultList::text(corner_mm) +
                                               " mm from the centre; the lens reaches " +
                                               FaultList::text(most_mm) + " mm");
    return;
  }
  const double angle_rad = std::atan2(corner_mm, machine.head.throw_mm);
  faults.require(!(angle_rad > kMostField_rad),
                 "the field's corner is " + FaultList::text(corner_mm) + " mm from the centre, " +
                     FaultList::text(angle_rad / kDegree) + " degrees out of the head; mirrors reach " +
                     FaultList::text(kMostField_rad / kDegree));
}

void findFieldFaults(FaultList& faults, const MachineDescription& machine) {
  const ControllerDescription& controller = machine.controller;
  double corner2_mm2 = 0.0;
  for (const auto& [name, i] : {std::pair("x", std::size_t{0}), std::pair("y", std::size_t{1})}) {
    const double low_mm = controller.field_min_mm.at(i);
    const double high_mm = controller.field_max_mm.at(i);
    faults.within(std::string("controller.field_min along ") + name, low_mm, -kFar_mm, kFar_mm, "mm");
    faults.within(std::string("controller.field_max along ") + name, high_mm, -kFar_mm, kFar_mm, "mm");
    faults.require(!(low_mm > high_mm),
                   std::string("controller.field along ") + name + " ends before it begins");
    const double far_mm = std::max(std::abs(low_mm), std::abs(high_mm));
    corner2_mm2 += far_mm * far_mm;
    if (machine.kind != Kind::kGantry) continue;
    const double from_mm = machine.travel_min_mm.at(i);
    const double to_mm = machine.travel_max_mm.at(i);
    faults.within(std::string("travel_min along ") + name, from_mm, -kFar_mm, kFar_mm, "mm");
    faults.within(std::string("travel_max along ") + name, to_mm, -kFar_mm, kFar_mm, "mm");
    faults.require(from_mm < to_mm, std::string("travel along ") + name + " ends before it begins");
    faults.require(!(low_mm < from_mm || high_mm > to_mm),
                   std::string("the controller's field along ") + name + ", " + FaultList::text(low_mm) +
                       " … " + FaultList::text(high_mm) + " mm, is beyond the travel of " +
                       FaultList::text(from_mm) + " … " + FaultList::text(to_mm) + " mm");
  }
  if (machine.kind == Kind::kTwoMirror) requireReach(faults, machine, std::sqrt(corner2_mm2));
}

void findControllerFaults(FaultList& faults, const ControllerDescription& controller) {
  const auto notNegative = [&](const char* name, double value, const char* unit) {
    faults.within(std::string("controller.") + name, value, 0.0, kFar_mm, unit);
  };
  notNegative("throw", controller.throw_mm, "mm");
  notNegative("mirror_spacing", controller.mirror_spacing_mm, "mm");
  notNegative("mirror_step", controller.mirror_step_rad, "rad");
  notNegative("gantry_step", controller.gantry_step_mm, "mm");
  notNegative("mirror_acceleration", controller.mirror_acceleration_rad_s2, "rad/s²");
  notNegative("full_step_pulses", controller.full_step_pulses, "pulses");
  notNegative("rotor_resonance", controller.rotor_resonance_hz, "Hz");
  faults.within("controller.detent_share", controller.detent_share, -0.5, 0.5, "");
  faults.within("controller.rotor_damping", controller.rotor_damping, 0.0, 0.9, "");
  notNegative("tracking_delay", controller.tracking_delay_s, "s");
  notNegative("encoder_count", controller.encoder_count_mm, "mm");
  notNegative("feed_step", controller.feed_step_mm, "mm");
  notNegative("full_power", controller.full_power_w, "W");
  faults.within("controller.print_mark_sensor_x", controller.print_mark_sensor_x_mm, -kFar_mm, kFar_mm, "mm");
}

void findCameraFaults(FaultList& faults, const char* name, const CameraDescription& camera) {
  // A camera without pixels is not fitted.
  if (camera.width_px == 0 && camera.height_px == 0) return;
  faults.take(std::string(name) + ": ", faultsOf(camera));
}

void findWebFaults(FaultList& faults, const WebDescription& web) {
  faults.take("", faultsOf(web.print));
  faults.take("", faultsOf(web.board));
  faults.within("print.eye_mark_x", web.print.eye_mark_x_mm, -kFar_mm, kFar_mm, "mm");
  faults.within("print.eye_mark_length", web.print.eye_mark_length_mm, 0.0, kFar_mm, "mm");
  faults.within("web.start_x", web.start_x_mm, -kFar_mm, kFar_mm, "mm");
  faults.within("web.belt_speed", web.belt_speed_mm_s, -1e5, 1e5, "mm/s");
  double last_s = 0.0;
  for (const SpeedPoint& point : web.belt_speed_changes) {
    faults.require(point.time_s > last_s && std::isfinite(point.time_s),
                   "web.belt_speed_changes must follow each other in time, one is at " +
                       FaultList::text(point.time_s) + " s");
    faults.within("web.belt_speed_changes", point.speed_mm_s, -1e5, 1e5, "mm/s");
    last_s = point.time_s;
  }
}

void findHeadFaults(FaultList& faults, const MachineDescription& machine) {
  const auto axis = [&](Axis which) {
    findAxisFaults(faults, nameOf(which), axisOf(machine, which), loadOf(machine, which),
                   MachineModel::kStep_s);
  };
  if (machine.kind == Kind::kTwoMirror) {
    faults.take("", faultsOf(machine.head));
    axis(Axis::kGalvoX);
    axis(Axis::kGalvoY);
    return;
  }
  axis(Axis::kGantryX);
  axis(Axis::kGantryY);
  faults.within("squareness", machine.squareness_rad, -0.1, 0.1, "rad");
  // Joint x moves bridge and carriage, joint y the carriage alone.
  faults.require(!(machine.gantry_x.load_inertia <= machine.gantry_y.load_inertia),
                 "gantry_x must move more mass than gantry_y, which it carries: " +
                     FaultList::text(machine.gantry_x.load_inertia) + " kg is not more than " +
                     FaultList::text(machine.gantry_y.load_inertia) + " kg");
}

// Finds the faults that only the mechanism as a whole shows.
void findMechanismFaults(FaultList& faults, const MachineDescription& machine, const WebDescription& web) {
  try {
    Mechanism(mechanismOf(machine, web).description).requireSlowerThan(MachineModel::kStep_s);
  } catch (const std::invalid_argument& error) {
    faults.require(false, error.what());
  }
}

}  // namespace

std::vector<std::string> faultsOf(const MachineDescription& machine, const WebDescription& web) {
  FaultList faults;
  findSignalFaults(faults, machine.signals);
  if (machine.frame) findFrameFaults(faults, *machine.frame);
  findHeadFaults(faults, machine);
  findBeltFaults(faults, machine.belt, web.print);
  if (web.fed_by_controller) {
    findAxisFaults(faults, nameOf(Axis::kFeed), machine.belt.feed, loadOf(machine, Axis::kFeed),
                   MachineModel::kStep_s);
  } else {
    findLineFaults(faults, machine.belt, web.belt_speed_mm_s);
  }
  faults.take("", faultsOf(machine.beam));
  faults.take("", faultsOf(machine.surface));
  faults.take("", faultsOf(machine.laser));
  faults.positive("power_monitor.quantum", machine.power_monitor.quantum_j, 1e6, "J");
  faults.within("power_monitor.delay", machine.power_monitor.delay_s, 2.0 * MachineModel::kStep_s, 10.0, "s");
  faults.positive("power_monitor.scale", machine.power_monitor.scale, 1e3, "");
  findCameraFaults(faults, "spot_camera", machine.spot_camera);
  findCameraFaults(faults, "kerf_camera", machine.kerf_camera);
  const CameraDescription& spot = machine.spot_camera;
  faults.require(spot.exposure_s >= 0.5 * MachineModel::kStep_s && spot.exposure_s <= spot.frame_period_s &&
                     spot.frame_period_s <= 3600.0,
                 "spot_camera: an exposure of " + FaultList::text(spot.exposure_s) +
                     " s must be at least a step of " + FaultList::text(MachineModel::kStep_s) +
                     " s and no longer than its frame period of " + FaultList::text(spot.frame_period_s) +
                     " s, that no longer than an hour");
  faults.within("glow_gray_per_w", machine.glow_gray_per_w, 0.0, 1e6, "1/W");
  findFieldFaults(faults, machine);
  findControllerFaults(faults, machine.controller);
  findWebFaults(faults, web);
  if (faults.size() == 0) findMechanismFaults(faults, machine, web);
  return std::move(faults).list();
}

}  // namespace kerfbench::twin
