// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/machine_faults.h"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/twin/cutter/machines.h"

namespace kerfbench::twin {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Machine = MachineDescription;
using Web = WebDescription;

ServoDescription& servoOf(AxisDescription& axis) { return std::get<ServoDescription>(axis.drive); }

StepperDescription stepper() {
  StepperDescription result;
  result.holding_torque_nm = 0.4;
  result.damping_nm_s = 1.5e-3;
  result.detent_torque_nm = 0.02;
  return result;
}

struct Fault {
  std::function<void(Machine&, Web&)> spoil;
  std::vector<std::string> words;
};

void expectFaults(const std::vector<Fault>& faults, Machine (*machine)(), Web (*web)()) {
  for (const Fault& fault : faults) {
    Machine spoilt = machine();
    Web spoilt_web = web();
    fault.spoil(spoilt, spoilt_web);
    const auto found = faultsOf(spoilt, spoilt_web);
    for (const std::string& word : fault.words) {
      EXPECT_THAT(found, Contains(HasSubstr(word))) << testing::PrintToString(found);
    }
    EXPECT_THROW(Twin(spoilt, spoilt_web, kRate), std::invalid_argument) << fault.words.front();
  }
}

/// A number of a machine or its web.
using Field = std::function<double&(Machine&, Web&)>;

void addAxisFields(std::vector<Field>& fields) {
  for (const auto axis : {&Machine::galvo_x, &Machine::galvo_y}) {
    for (const auto field :
         {&AxisDescription::step, &AxisDescription::load_per_motor, &AxisDescription::motor_inertia_kg_m2,
          &AxisDescription::load_inertia, &AxisDescription::stiffness, &AxisDescription::stiffness_damping,
          &AxisDescription::backlash}) {
      fields.emplace_back([=](Machine& m, Web&) -> double& { return m.*axis.*field; });
    }
    for (const auto field :
         {&FrictionDescription::coulomb, &FrictionDescription::viscous, &FrictionDescription::presliding}) {
      fields.emplace_back([=](Machine& m, Web&) -> double& { return (m.*axis).friction.*field; });
    }
    for (const auto field : {&DriverProfile::setup_s, &DriverProfile::hold_s, &DriverProfile::width_s,
                             &DriverProfile::space_s}) {
      fields.emplace_back([=](Machine& m, Web&) -> double& { return (m.*axis).profile.*field; });
    }
    for (const auto field :
         {&ServoDescription::natural_frequency_rad_s, &ServoDescription::damping,
          &ServoDescription::velocity_feedforward, &ServoDescription::max_torque,
          &ServoDescription::max_speed, &ServoDescription::current_lag_s, &ServoDescription::input_delay_s}) {
      fields.emplace_back([=](Machine& m, Web&) -> double& { return servoOf(m.*axis).*field; });
    }
  }
}

void addBeltFields(std::vector<Field>& fields) {
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.belt.line_servo.natural_frequency_rad_s; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.belt.line_servo.feedforward_filter_s; });
  for (const auto field :
       {&BeltDescription::roller_radius_mm, &BeltDescription::roller_inertia_kg_m2, &BeltDescription::mass_kg,
        &BeltDescription::stiffness_n_m, &BeltDescription::damping_n_s_m, &BeltDescription::sheet_mass_kg,
        &BeltDescription::sheet_friction}) {
    fields.emplace_back([=](Machine& m, Web&) -> double& { return m.belt.*field; });
  }
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.belt.bed_friction.coulomb; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.belt.bed_friction.viscous; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.belt.bed_friction.presliding; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.belt.sheet_drag_n[0]; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.belt.sheet_drag_n[1]; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.belt.encoder.count_mm; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.belt.encoder.jitter_counts; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.belt.encoder.runout_mm; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.belt.encoder.runout_phase_rad; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.belt.print_mark_sensor.x_mm; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.belt.print_mark_sensor.jitter_mm; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.belt.print_mark_sensor.hysteresis_mm; });
}

void addOtherFields(std::vector<Field>& fields) {
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.head.throw_mm; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.head.x.zero_rad; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.beam.waist_radius_mm; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.surface.height_mm; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.laser.rise_time_s; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.power_monitor.quantum_j; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.power_monitor.delay_s; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.power_monitor.scale; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.spot_camera.frame_period_s; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.spot_camera.exposure_s; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.glow_gray_per_w; });
}

void addControllerFields(std::vector<Field>& fields) {
  for (const auto field : {&ControllerDescription::throw_mm, &ControllerDescription::mirror_spacing_mm,
                           &ControllerDescription::mirror_step_rad, &ControllerDescription::gantry_step_mm,
                           &ControllerDescription::tracking_delay_s, &ControllerDescription::encoder_count_mm,
                           &ControllerDescription::print_mark_sensor_x_mm,
                           &ControllerDescription::feed_step_mm, &ControllerDescription::full_power_w}) {
    fields.emplace_back([=](Machine& m, Web&) -> double& { return m.controller.*field; });
  }
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.controller.field_min_mm[0]; });
  fields.emplace_back([](Machine& m, Web&) -> double& { return m.controller.field_max_mm[1]; });
}

void addWebFields(std::vector<Field>& fields) {
  fields.emplace_back([](Machine&, Web& w) -> double& { return w.start_x_mm; });
  fields.emplace_back([](Machine&, Web& w) -> double& { return w.belt_speed_mm_s; });
  fields.emplace_back([](Machine&, Web& w) -> double& { return w.print.pitch_mm; });
  fields.emplace_back([](Machine&, Web& w) -> double& { return w.print.eye_mark_x_mm; });
  fields.emplace_back([](Machine&, Web& w) -> double& { return w.print.eye_mark_length_mm; });
  fields.emplace_back([](Machine&, Web& w) -> double& { return w.board.cut_fluence_j_mm2; });
}

TEST(MachineFaults, TheMachinesOfTheTestsHaveNone) {
  EXPECT_THAT(faultsOf(twoMirror(), lineWeb()), IsEmpty());
  EXPECT_THAT(faultsOf(twoMirror(), fedWeb()), IsEmpty());
  EXPECT_THAT(faultsOf(gantry(), lineWeb()), IsEmpty());
  EXPECT_THAT(faultsOf(gantry(), fedWeb()), IsEmpty());
}

TEST(MachineFaults, AFaultSaysWhatItIsWhatMayBeAndTheUnit) {
  Machine machine = twoMirror();
  machine.galvo_x.load_inertia = -2e-7;
  EXPECT_THAT(faultsOf(machine, lineWeb()),
              Contains("galvo_x.load_inertia must be in (0, 100000] kg m², is -2e-07"));
}

TEST(MachineFaults, AllAreListedAtOnceAndTheTwinThrowsThemAll) {
  Machine machine = twoMirror();
  machine.galvo_y.stiffness = 0;
  machine.belt.sheet_mass_kg = -1;
  machine.laser.full_power_w = 0;
  machine.controller.throw_mm = kNan;
  EXPECT_EQ(faultsOf(machine, lineWeb()).size(), 4U);
  try {
    Twin(machine, lineWeb(), kRate);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("galvo_y.stiffness"), HasSubstr("sheet_mass"),
                                    HasSubstr("full_power_w"), HasSubstr("controller.throw")));
  }
}

TEST(MachineFaults, WhatIsNotANumberIsFoundWhereverItStands) {
  std::vector<Field> fields;
  addAxisFields(fields);
  addBeltFields(fields);
  addOtherFields(fields);
  addControllerFields(fields);
  addWebFields(fields);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    Machine machine = twoMirror();
    Web web = lineWeb();
    fields[i](machine, web) = kNan;
    EXPECT_THAT(faultsOf(machine, web), testing::Not(IsEmpty())) << "field " << i;
  }
}

TEST(MachineFaults, MassesStiffnessesAndSizesMustBeOfThisWorld) {
  expectFaults({{[](Machine& m, Web&) { m.galvo_x.motor_inertia_kg_m2 = 0; }, {"galvo_x.motor_inertia"}},
                {[](Machine& m, Web&) { m.galvo_y.load_inertia = kInfinity; }, {"galvo_y.load_inertia"}},
                {[](Machine& m, Web&) { m.galvo_x.stiffness = -1; }, {"galvo_x.stiffness must be"}},
                {[](Machine& m, Web&) { m.galvo_x.load_per_motor = 0; }, {"galvo_x.load_per_motor"}},
                {[](Machine& m, Web&) { m.belt.mass_kg = 0; }, {"belt.mass must be in (0, 100000] kg, is 0"}},
                {[](Machine& m, Web&) { m.belt.roller_radius_mm = 0; }, {"belt.roller_radius"}},
                {[](Machine& m, Web&) { m.belt.roller_radius_mm = 1e7; }, {"belt.roller_radius"}},
                {[](Machine& m, Web&) {
                   m.frame = FrameDescription{0.0, {1e6, 1e6}, {0, 0}};
                 },
                 {"frame.mass"}},
                {[](Machine& m, Web&) {
                   m.frame = FrameDescription{100.0, {1e6, 0}, {0, 0}};
                 },
                 {"frame.stiffness along y"}},
                {[](Machine& m, Web&) { m.head.throw_mm = 1e9; }, {"head.throw_mm"}},
                {[](Machine& m, Web&) { m.beam.waist_radius_mm = 0; }, {"beam.waist_radius_mm"}},
                {[](Machine& m, Web&) { m.surface.flutter_mm = -1; }, {"surface.flutter_mm"}},
                {[](Machine& m, Web&) { m.laser.noise = 7; }, {"noise must be"}},
                {[](Machine& m, Web&) { m.belt.encoder.jitter_counts = 0.3; }, {"encoder.jitter", "counts"}},
                {[](Machine& m, Web&) { m.belt.encoder.runout_mm = 5; }, {"encoder.runout"}},
                {[](Machine& m, Web&) { m.power_monitor.delay_s = 0; }, {"power_monitor.delay"}},
                {[](Machine&, Web& w) { w.board.thickness_mm = 0; }, {"thickness_mm"}},
                {[](Machine&, Web& w) { w.print.units = 0; }, {"units must be"}},
                {[](Machine&, Web& w) {
                   w.belt_speed_changes = {{2.0, 50}, {1.0, 60}};
                 },
                 {"belt_speed_changes must follow each other in time, one is at 1 s"}},
                {[](Machine& m, Web&) { m.kerf_camera.width_px = 100; }, {"kerf_camera: "}},
                {[](Machine& m, Web&) {
                   m.signals.assign(Signal::kPrintMark, {0, 1});
                 },
                 {"galvo_x_dir and print_mark share a pin"}},
                {[](Machine& m, Web&) {
                   m.signals.assign(Signal::kPrintMark, {0, 16});
                 },
                 {"bit 16"}}},
               twoMirror, lineWeb);
}

TEST(MachineFaults, SpringsMustSwingSlowlyEnoughForTheStep) {
  // Stiffness of the galvo's transmission that gives `hz` between motor and mirror.
  const auto stiffnessFor = [](const AxisDescription& axis, double hz) {
    const double w = 2.0 * std::numbers::pi * hz;
    return w * w / (1.0 / axis.motor_inertia_kg_m2 + 1.0 / axis.load_inertia);
  };
  Machine machine = twoMirror();
  // 0.4 in 10 us: 6366 Hz.
  machine.galvo_x.stiffness = stiffnessFor(machine.galvo_x, 6300.0);
  EXPECT_THAT(faultsOf(machine, lineWeb()), IsEmpty());
  machine.galvo_x.stiffness = stiffnessFor(machine.galvo_x, 6400.0);
  EXPECT_THAT(faultsOf(machine, lineWeb()),
              ElementsAre(HasSubstr(
                  "galvo_x: motor against load swings at 6400 Hz; steps of 10 us follow up to 6366.2 Hz")));
  expectFaults(
      {{[](Machine& m, Web&) { m.belt.stiffness_n_m = 1e10; }, {"belt: roller against belt swings at"}},
       {[](Machine& m, Web&) {
          m.belt.bed_friction.coulomb = 100;
          m.belt.bed_friction.presliding = 1e-8;
        },
        {"belt: the belt in its bed's presliding"}},
       {[](Machine& m, Web&) {
          m.galvo_x.friction.coulomb = 1e-3;
          m.galvo_x.friction.presliding = 1e-8;
        },
        {"galvo_x: the load in its friction's presliding"}},
       {[](Machine& m, Web&) {
          m.frame = FrameDescription{0.001, {1e9, 1e9}, {0, 0}};
        },
        {"frame along x swings at"}},
       {[](Machine& m, Web&) {
          m.galvo_x.drive = stepper();
          m.galvo_x.motor_inertia_kg_m2 = 1e-9;
        },
        {"galvo_x: the rotor in its field swings at"}}},
      twoMirror, lineWeb);
}

TEST(MachineFaults, AServoMustBeSlowerThanTheStepAndThanItsLoad) {
  expectFaults({{[](Machine& m, Web&) { servoOf(m.galvo_x).natural_frequency_rad_s = 21000; },
                 {"galvo_x.natural_frequency must be in (0, 20000] rad/s"}},
                {[](Machine& m, Web&) { servoOf(m.galvo_x).damping = 0; }, {"galvo_x.damping"}},
                {[](Machine& m, Web&) { servoOf(m.galvo_x).max_torque = 0; }, {"galvo_x.max_torque"}},
                {[](Machine& m, Web&) {
                   servoOf(m.galvo_x).velocity_feedforward = 1;
                   servoOf(m.galvo_x).feedforward_filter_s = 0;
                 },
                 {"galvo_x.feedforward_filter"}},
                {[](Machine& m, Web&) { m.galvo_x.stiffness = 1.0; },
                 {"galvo_x: the load swings on its transmission at 355.881 Hz"}},
                {[](Machine& m, Web&) { m.belt.stiffness_n_m = 1e3; }, {"line: the load swings"}}},
               twoMirror, lineWeb);
}

TEST(MachineFaults, AServoThatSwingsUpIsRefusedAndOneThatDoesNotIsNot) {
  Machine machine = twoMirror();
  // The current loop's lag takes more of the phase than damping gives.
  servoOf(machine.galvo_x).current_lag_s = 1e-3;
  EXPECT_THAT(faultsOf(machine, lineWeb()),
              ElementsAre(HasSubstr("galvo_x: servo, current loop and transmission together swing up at")));
  servoOf(machine.galvo_x).current_lag_s = 20e-6;
  EXPECT_THAT(faultsOf(machine, lineWeb()), IsEmpty());
}

TEST(MachineFaults, AMotorMustBeStrongerThanTheFrictionOfItsLoad) {
  expectFaults(
      {{[](Machine& m, Web&) {
          m.gantry_x.friction.coulomb = 500;
          servoOf(m.gantry_x).max_torque = 1.0;
        },
        {"gantry_x: the motor's 1 N m cannot move a load that rubs with 500 N, 3.1831 N m at the motor"}},
       {[](Machine& m, Web&) {
          m.gantry_y.drive = stepper();
          m.gantry_y.friction.coulomb = 70;
        },
        {"gantry_y: the motor's 0.38 N m cannot"}},
       {[](Machine& m, Web&) {
          m.belt.line_servo.max_torque = 0.1;
          m.belt.bed_friction.coulomb = 5;
          m.belt.bed_friction.presliding = 20e-6;
        },
        {"line: the drive's 0.1 N m cannot pull"}}},
      gantry, lineWeb);
}

TEST(MachineFaults, TheFieldMustBeWithinReach) {
  expectFaults({{[](Machine& m, Web&) {
                   m.controller.field_max_mm = {600, 0};
                 },
                 {"the field's corner is 600 mm from the centre", "degrees"}},
                {[](Machine& m, Web&) {
                   m.head.lens = LensDescription{.focal_length_mm = 100};
                   m.controller.field_min_mm = {-80, 0};
                 },
                 {"the lens reaches 70 mm"}},
                {[](Machine& m, Web&) {
                   m.controller.field_min_mm = {1, 0};
                 },
                 {"controller.field along x ends before it begins"}}},
               twoMirror, lineWeb);
  expectFaults({{[](Machine& m, Web&) {
                   m.controller.field_max_mm = {2.5, 0};
                 },
                 {"the controller's field along x, 0 … 2.5 mm, is beyond the travel of -2 … 2 mm"}},
                {[](Machine& m, Web&) { m.travel_min_mm[1] = 4; }, {"travel along y ends before it begins"}},
                {[](Machine& m, Web&) { m.gantry_x.load_inertia = 3; }, {"gantry_x must move more mass"}},
                {[](Machine& m, Web&) { m.squareness_rad = 0.2; }, {"squareness"}}},
               gantry, lineWeb);
}

TEST(MachineFaults, OnlyWhatAMachineUsesIsLookedAt) {
  Machine machine = twoMirror();
  machine.gantry_x = machine.gantry_y = {};
  machine.belt.feed = {};
  machine.travel_min_mm = {5, 5};
  EXPECT_THAT(faultsOf(machine, lineWeb()), IsEmpty());
  EXPECT_THAT(faultsOf(machine, fedWeb()), Contains(HasSubstr("feed.step")));
  Machine strip = gantry();
  strip.galvo_x = {};
  strip.head.throw_mm = -1;
  EXPECT_THAT(faultsOf(strip, lineWeb()), IsEmpty());
}

}  // namespace
}  // namespace kerfbench::twin
