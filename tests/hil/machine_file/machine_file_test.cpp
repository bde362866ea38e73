// SPDX-License-Identifier: Apache-2.0
#include "hil/machine_file/machine_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "tests/hil/machine_file/machine_file_fixture.h"
#include "twin/cutter/twin.h"

namespace kerfbench::machine_file {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using twin::MachineDescription;

constexpr double kTurn_rad = 2.0 * std::numbers::pi;

const twin::ServoDescription& servoOf(const twin::AxisDescription& axis) {
  return std::get<twin::ServoDescription>(axis.drive);
}

TEST_F(MachineFileTest, TheTwoMirrorMachineReads) {
  const MachineDescription machine = readMachine(base::fixture("machines/two-mirror.yaml"));
  EXPECT_EQ(machine.name, "two-mirror");
  EXPECT_EQ(machine.kind, MachineDescription::Kind::kTwoMirror);
  EXPECT_EQ(machine.head.throw_mm, 500.0);
  EXPECT_EQ(machine.head.mirror_spacing_mm, 15.0);
  EXPECT_FALSE(machine.frame.has_value());
  for (const auto* galvo : {&machine.galvo_x, &machine.galvo_y}) {
    EXPECT_EQ(galvo->profile.name, "galvo-pul-dir");
    EXPECT_TRUE(galvo->profile.active_edge_rising);
    EXPECT_DOUBLE_EQ(galvo->profile.setup_s, 5e-6);
    EXPECT_DOUBLE_EQ(galvo->profile.width_s, 2.5e-6);
    EXPECT_DOUBLE_EQ(galvo->step, 12.5e-6);
    EXPECT_EQ(galvo->motor_inertia_kg_m2, 3e-7);
    EXPECT_EQ(galvo->load_inertia, 2e-7);
    EXPECT_DOUBLE_EQ(servoOf(*galvo).natural_frequency_rad_s, kTurn_rad * 1200.0);
    // The catalogue's current limit, an acceleration, at the inertia of motor and mirror.
    EXPECT_DOUBLE_EQ(servoOf(*galvo).max_torque, 1.6e5 * 5e-7);
    EXPECT_DOUBLE_EQ(servoOf(*galvo).max_speed, 150.0);
  }
  EXPECT_EQ(machine.belt.feed.step, 0.0125);
  EXPECT_DOUBLE_EQ(machine.belt.feed.load_inertia, machine.belt.roller_inertia_kg_m2);
  EXPECT_EQ(machine.signals.pin(Signal::kGalvoXPul), (PinId{0, 0}));
  EXPECT_EQ(machine.signals.pin(Signal::kEncoderA), (PinId{3, 2}));
  EXPECT_EQ(machine.signals.pin(Signal::kInterlock), (PinId{11, 2}));
  EXPECT_DOUBLE_EQ(machine.laser.rise_time_s, 20e-6);
}

TEST_F(MachineFileTest, EveryMachineOfTheHouseCanRun) {
  for (const char* name : {"two-mirror", "two-mirror-linecutter", "two-mirror-stepper", "two-mirror-geared",
                           "two-mirror-slow", "two-mirror-fast", "two-mirror-100", "two-mirror-300",
                           "two-mirror-800", "f-theta-300", "f-theta-300-mounted", "strip-gantry"}) {
    const MachineDescription machine = readMachine(base::fixture(std::string("machines/") + name + ".yaml"));
    EXPECT_EQ(machine.name, name);
    EXPECT_NO_THROW(twin::Twin(machine, twin::WebDescription{}, TickRate{})) << name;
  }
}

TEST_F(MachineFileTest, TheDefaultSpreadIsThatOfTheTwin) {
  const twin::ImperfectionSpread known;
  const twin::ImperfectionSpread read = readMachineFile(base::fixture("machines/strip-gantry.yaml")).spread;
  const twin::ImperfectionSpread shown = readMachineFile(base::fixture("machines/two-mirror.yaml")).spread;
  for (const auto& spread : {read, shown}) {
    EXPECT_DOUBLE_EQ(spread.axis_tilt_rad, known.axis_tilt_rad);
    EXPECT_DOUBLE_EQ(spread.scale, known.scale);
    EXPECT_DOUBLE_EQ(spread.power, known.power);
    EXPECT_DOUBLE_EQ(spread.bandwidth, known.bandwidth);
    EXPECT_DOUBLE_EQ(spread.curl_1_mm, known.curl_1_mm);
    EXPECT_DOUBLE_EQ(spread.gate_delay_s, known.gate_delay_s);
    EXPECT_DOUBLE_EQ(spread.power_monitor_scale, known.power_monitor_scale);
    EXPECT_DOUBLE_EQ(spread.mark_sensor_mm, known.mark_sensor_mm);
  }
}

TEST_F(MachineFileTest, ASpreadIsReadInTheUnitsOfItsKeys) {
  const auto path = extending(
      "two-mirror.yaml", "imperfections: {zero_urad: 30, scale_ppm: 50, power_percent: 3, curl_1_m: 0.5}\n");
  const twin::ImperfectionSpread spread = readMachineFile(path).spread;
  EXPECT_DOUBLE_EQ(spread.zero_rad, 30e-6);
  EXPECT_DOUBLE_EQ(spread.scale, 50e-6);
  EXPECT_DOUBLE_EQ(spread.power, 0.03);
  EXPECT_DOUBLE_EQ(spread.curl_1_mm, 0.5e-3);
}

TEST_F(MachineFileTest, TheShaftBetweenRotorAndMirrorSwingsAsTheFileSays) {
  const twin::AxisDescription galvo = readMachine(base::fixture("machines/two-mirror.yaml")).galvo_x;
  // The two rotors are on a spring: w² = k (1/J1 + 1/J2); damping c makes 2 zeta w = c (1/J1 + 1/J2).
  const double compliance = 1.0 / galvo.motor_inertia_kg_m2 + 1.0 / galvo.load_inertia;
  const double w = std::sqrt(galvo.stiffness * compliance);
  EXPECT_NEAR(w / kTurn_rad, 4000.0, 1e-6);
  EXPECT_NEAR(galvo.stiffness_damping * compliance / (2.0 * w), 0.01, 1e-9);
}

TEST_F(MachineFileTest, ABeltsStiffnessIsInNewtonsAMetreOfTheSlide) {
  const twin::AxisDescription gantry = readMachine(base::fixture("machines/strip-gantry.yaml")).gantry_x;
  EXPECT_DOUBLE_EQ(gantry.stiffness, 4e6);
  // The motor as seen from the slide.
  const double motor_kg = gantry.motor_inertia_kg_m2 / std::pow(1e-3 * gantry.load_per_motor, 2);
  const double compliance = 1.0 / motor_kg + 1.0 / gantry.load_inertia;
  EXPECT_NEAR(gantry.stiffness_damping * compliance / (2.0 * std::sqrt(gantry.stiffness * compliance)), 0.02,
              1e-9);
  EXPECT_DOUBLE_EQ(kTurn_rad * gantry.load_per_motor, 40.0);
}

TEST_F(MachineFileTest, TheFrameSwingsOnItsFeetAsTheFileSays) {
  const auto frame = readMachine(base::fixture("machines/strip-gantry.yaml")).frame.value();
  EXPECT_NEAR(std::sqrt(frame.stiffness_n_m[0] / frame.mass_kg) / kTurn_rad, 22.0, 1e-9);
  EXPECT_NEAR(frame.damping_n_s_m[1] / (2.0 * std::sqrt(frame.stiffness_n_m[1] * frame.mass_kg)), 0.05,
              1e-12);
  const auto path =
      extending("strip-gantry.yaml", "frame: {resonance_hz: ~, stiffness_n_mm: [3000, 4000]}\n");
  EXPECT_DOUBLE_EQ(readMachine(path).frame.value().stiffness_n_m[1], 4e6);
}

TEST_F(MachineFileTest, AStepperStepsByItsTeethAndItsSubdivision) {
  const MachineDescription machine = readMachine(base::fixture("machines/two-mirror-stepper.yaml"));
  const auto& motor = std::get<twin::StepperDescription>(machine.galvo_x.drive);
  EXPECT_EQ(motor.rotor_teeth, 50);
  EXPECT_DOUBLE_EQ(machine.galvo_x.step, kTurn_rad / 51200);
  EXPECT_DOUBLE_EQ(machine.belt.feed.step, kTurn_rad / 3200 * 0.2 * 30.0);
  // The statements of the file itself: a pulse is not more than 0.05 mm anywhere in the field, the delay is
  // that of the field's spring, and the detents are the largest error.
  const double rim_mm = machine.controller.field_max_mm[0];
  const double far_mm =
      std::hypot(machine.head.throw_mm, machine.controller.field_max_mm[1]) + machine.head.mirror_spacing_mm;
  EXPECT_LT(2.0 * machine.galvo_x.step * far_mm * (1.0 + std::pow(rim_mm / far_mm, 2)), 0.05);
  const double stiffness = motor.holding_torque_nm * motor.rotor_teeth;
  EXPECT_NEAR(machine.controller.tracking_delay_s, motor.damping_nm_s / stiffness, 1e-9);
  EXPECT_NEAR(2.0 * motor.detent_torque_nm / stiffness * 190.0, 0.4, 0.05);
}

TEST_F(MachineFileTest, WhatASubdivisionSettlesIsNotSaidAgain) {
  const auto path = extending("two-mirror-stepper.yaml", "galvo_x: {step_urad: 100}\n");
  EXPECT_THAT(faultsAt(path), HasSubstr("galvo_x.step_urad: follows from the full steps"));
  const auto both = extending("two-mirror.yaml", "galvo_x: {stepper: {profile: 17HS4401}}\n");
  EXPECT_THAT(faultsAt(both), HasSubstr("galvo_x.stepper: an axis has one drive"));
}

TEST_F(MachineFileTest, ALensIsReadInRadiansAndMillimetres) {
  const auto lens = readMachine(base::fixture("machines/f-theta-300.yaml")).head.lens.value();
  EXPECT_EQ(lens.focal_length_mm, 430.0);
  EXPECT_EQ(lens.k1, -0.02);
  EXPECT_EQ(lens.incidence_ratio, 0.6);
  EXPECT_FALSE(readMachine(base::fixture("machines/two-mirror.yaml")).head.lens.has_value());
}

TEST_F(MachineFileTest, APowerCurveMustAscendFromNothingToAll) {
  const auto curve = [&](const char* points) {
    return faultsAt(extending("two-mirror.yaml",
                              fmt::format("laser: {{power_curve: {}, demand_filter_us: 200}}\n", points)));
  };
  EXPECT_EQ(curve("[{demand: 0, power: 0}, {demand: 0.3, power: 0.1}, {demand: 1, power: 1}]"), "");
  EXPECT_THAT(
      curve("[{demand: 0.5, power: 0.2}, {demand: 0.3, power: 0.4}, {demand: 1, power: 1}]"),
      testing::AllOf(HasSubstr("m.yaml:2: laser.power_curve: must ascend"), HasSubstr("must go from")));
}

TEST_F(MachineFileTest, APowerCurveThatBendsNeedsTheMeanOfThePwm) {
  const auto path = extending("two-mirror.yaml",
                              "laser: {power_curve: [{demand: 0, power: 0}, {demand: 0.5, power: 0.2}, "
                              "{demand: 1, power: 1}]}\n");
  EXPECT_THAT(faultsAt(path), HasSubstr("laser.demand_filter_us: must be > 0 with a power_curve that bends"));
}

TEST_F(MachineFileTest, AShaftTooStiffForTheStepIsAFault) {
  const auto path = extending("two-mirror.yaml", "galvo_x: {resonance_hz: ~, stiffness_n_m_rad: 1.0e+6}\n");
  EXPECT_THAT(faultsAt(path),
              HasSubstr("m.yaml:2: galvo_x.stiffness_n_m_rad: motor and load would swing at"));
}

TEST_F(MachineFileTest, WhatTheTwinNamesIsFoundInTheFile) {
  const auto path = extending("strip-gantry.yaml", "gantry_x: {mass_kg: 20}\n");
  const MachineFile file = readMachineFile(path);
  EXPECT_EQ(file.placeOf("gantry_x.mass_kg"), path.string() + ":2");
  EXPECT_THAT(
      file.placeOf("gantry_y.mass_kg"),
      testing::EndsWith("strip-gantry.yaml:" +
                        std::to_string(base::lineOf(
                            base::contentOf(base::fixture("machines/strip-gantry.yaml")), "mass_kg: 3\n"))));
  // The place of an unknown key is its section, the place of nothing is the file.
  EXPECT_EQ(file.placeOf("gantry_x.wings"), path.string() + ":2");
  EXPECT_THAT(file.placeOf("wings"), HasSubstr("strip-gantry.yaml:"));
}

TEST_F(MachineFileTest, ControllersAreToldTheTruth) {
  const MachineDescription mirrors = readMachine(base::fixture("machines/two-mirror.yaml"));
  EXPECT_EQ(mirrors.controller.throw_mm, mirrors.head.throw_mm);
  EXPECT_EQ(mirrors.controller.mirror_spacing_mm, mirrors.head.mirror_spacing_mm);
  const MachineDescription strip = readMachine(base::fixture("machines/strip-gantry.yaml"));
  EXPECT_EQ(strip.controller.gantry_step_mm, strip.gantry_x.step);
  EXPECT_EQ(strip.controller.gantry_step_mm, strip.gantry_y.step);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_GT(strip.controller.field_min_mm.at(i), strip.travel_min_mm.at(i));
    EXPECT_LT(strip.controller.field_max_mm.at(i), strip.travel_max_mm.at(i));
  }
  const MachineDescription stepper = readMachine(base::fixture("machines/two-mirror-stepper.yaml"));
  const MachineDescription lens = readMachine(base::fixture("machines/f-theta-300.yaml"));
  const MachineDescription slow = readMachine(base::fixture("machines/two-mirror-slow.yaml"));
  const MachineDescription fast = readMachine(base::fixture("machines/two-mirror-fast.yaml"));
  for (const auto* machine : {&mirrors, &stepper, &slow, &fast, &lens}) {
    EXPECT_NEAR(machine->controller.mirror_step_rad, machine->galvo_x.step, 1e-18);
    EXPECT_NEAR(machine->controller.mirror_step_rad, machine->galvo_y.step, 1e-18);
    EXPECT_NEAR(machine->controller.feed_step_mm, machine->belt.feed.step, 1e-15);
  }
  for (const auto* machine : {&mirrors, &slow, &fast, &lens}) {
    const twin::ServoDescription& servo = servoOf(machine->galvo_x);
    EXPECT_NEAR(machine->controller.tracking_delay_s, 2.0 * servo.damping / servo.natural_frequency_rad_s,
                2e-8);
  }
  for (const auto* machine : {&mirrors, &stepper, &slow, &fast, &lens, &strip}) {
    EXPECT_EQ(machine->controller.encoder_count_mm, machine->belt.encoder.count_mm);
    EXPECT_EQ(machine->controller.print_mark_sensor_x_mm, machine->belt.print_mark_sensor.x_mm);
    EXPECT_EQ(machine->controller.full_power_w, machine->laser.full_power_w);
    EXPECT_EQ(twin::faultsOf(machine->spot_camera), "");
    EXPECT_EQ(twin::faultsOf(machine->kerf_camera), "");
  }
}

TEST_F(MachineFileTest, APulseOfTheFastMachineMovesTheSpotByThreeMicrometresAtMost) {
  const MachineDescription machine = readMachine(base::fixture("machines/two-mirror-fast.yaml"));
  const auto& told = machine.controller;
  double longest_mm = 0.0;  // Derivatives of Cheng et al. 2014, eq. 1.
  for (const double x_mm : {told.field_min_mm[0], 0.0, told.field_max_mm[0]}) {
    for (const double y_mm : {told.field_min_mm[1], 0.0, told.field_max_mm[1]}) {
      const double slant_mm = std::hypot(machine.head.throw_mm, y_mm);
      const double reach_mm = slant_mm + machine.head.mirror_spacing_mm;
      const double x_by_x = 2.0 * (reach_mm + x_mm * x_mm / reach_mm) * machine.galvo_x.step;
      const double y_by_y = 2.0 * slant_mm * slant_mm / machine.head.throw_mm * machine.galvo_y.step;
      const double x_by_y = x_mm / reach_mm * y_mm / slant_mm * y_by_y;
      longest_mm = std::max({longest_mm, x_by_x, std::hypot(y_by_y, x_by_y)});
    }
  }
  RecordProperty("longest_pulse_um", std::to_string(1e3 * longest_mm));
  EXPECT_LE(longest_mm, 3e-3);
  EXPECT_GE(longest_mm, 2.9e-3) << "finer steps would cost pulse rate";
}

TEST_F(MachineFileTest, TheSpotCameraSeesTheWholeField) {
  for (const char* file :
       {"two-mirror.yaml", "two-mirror-stepper.yaml", "f-theta-300.yaml", "strip-gantry.yaml"}) {
    const MachineDescription machine = readMachine(base::fixture(std::string("machines/") + file));
    const auto& camera = machine.spot_camera;
    const auto& told = machine.controller;
    for (const double x : {told.field_min_mm[0], told.field_max_mm[0]}) {
      for (const double y : {told.field_min_mm[1], told.field_max_mm[1]}) {
        const Eigen::Vector3d p = camera.X_CP * Eigen::Vector3d(x, y, 0.0);
        ASSERT_GT(p.z(), 0.0) << file;  // The place is in front of the camera.
        const Eigen::Vector2d n = p.head<2>() / p.z();
        const double stretch = 1.0 + camera.distortion[0] * n.squaredNorm();
        EXPECT_NEAR(camera.fx_px * stretch * n.x() + camera.cx_px, 0.5 * camera.width_px,
                    0.5 * camera.width_px - 5)
            << file;
        EXPECT_NEAR(camera.fy_px * stretch * n.y() + camera.cy_px, 0.5 * camera.height_px,
                    0.5 * camera.height_px - 5)
            << file;
      }
    }
  }
}

TEST_F(MachineFileTest, TheDriveProfilesAreThoseOfTheDataSheets) {
  const auto path = extending("two-mirror.yaml", "galvo_x: {driver: Gecko201}\n");
  const DriverProfile profile = readMachine(path).galvo_x.profile;
  EXPECT_EQ(profile.name, "Gecko201");
  EXPECT_FALSE(profile.active_edge_rising);
  EXPECT_DOUBLE_EQ(profile.setup_s, 1e-6);
  EXPECT_DOUBLE_EQ(profile.hold_s, 20e-6);
  EXPECT_DOUBLE_EQ(profile.width_s, 0.5e-6);
  EXPECT_DOUBLE_EQ(profile.space_s, 4e-6);
}

TEST_F(MachineFileTest, AnAxisMayHaveOtherLevelsThanItsDriver) {
  const auto machine = readMachine(extending("two-mirror.yaml",
                                             "galvo_x: {driver: Gecko201, active_edge: rising}\n"
                                             "galvo_y: {dir_low: true}\n"));
  EXPECT_TRUE(machine.galvo_x.profile.active_edge_rising);
  EXPECT_DOUBLE_EQ(machine.galvo_x.profile.hold_s, 20e-6);
  EXPECT_EQ(machine.galvo_x.profile.senseOf(true), 1);
  EXPECT_EQ(machine.galvo_y.profile.senseOf(true), -1);
  EXPECT_EQ(machine.galvo_y.profile.senseOf(false), 1);
}

TEST_F(MachineFileTest, TheLaserMayListenToLowLevels) {
  const auto usual = readMachine(base::fixture("machines/two-mirror.yaml")).laser;
  EXPECT_FALSE(usual.gate_low);
  EXPECT_FALSE(usual.pwm_low);
  const auto gate = readMachine(extending("two-mirror.yaml", "laser: {gate_low: true}\n")).laser;
  EXPECT_TRUE(gate.gate_low);
  EXPECT_FALSE(gate.pwm_low);
  EXPECT_TRUE(readMachine(extending("two-mirror.yaml", "laser: {pwm_low: true}\n")).laser.pwm_low);
}

TEST_F(MachineFileTest, OnePinMayEnableSeveralDrives) {
  const auto machine = readMachine(base::fixture("machines/gantry-grbl.yaml"));
  EXPECT_EQ(machine.signals.pin(Signal::kGantryXEnable), (PinId{1, 0}));
  EXPECT_EQ(machine.signals.pin(Signal::kGantryYEnable), (PinId{1, 0}));
  EXPECT_TRUE(machine.signals.hasOwnWire(Signal::kGantryXEnable));
  EXPECT_FALSE(machine.signals.hasOwnWire(Signal::kGantryYEnable));
  EXPECT_FALSE(machine.signals.hasOwnWire(Signal::kGalvoXEnable)) << "it has no pin";
  EXPECT_TRUE(machine.gantry_x.profile.enabledBy(false));
  EXPECT_FALSE(machine.gantry_x.profile.enabledBy(true));
  EXPECT_DOUBLE_EQ(machine.gantry_x.profile.enable_setup_s, 5e-6);
  EXPECT_TRUE(readMachine(base::fixture("machines/two-mirror.yaml")).galvo_x.profile.enabledBy(true));
}

TEST_F(MachineFileTest, TheSpotCameraSeesItsCentreInTheMiddleOfThePicture) {
  std::string content = base::withValue(text("strip-gantry.yaml"), "centre_mm", "[370, -20]");
  content = base::withValue(base::withValue(content, "height_mm", "2500"), "pitch_mm", "0.2");
  const auto machine = readMachine(temp_.write("m.yaml", content));
  const Eigen::Vector3d centre = machine.spot_camera.X_CP * Eigen::Vector3d(370.0, -20.0, 0.0);
  EXPECT_NEAR(centre.x(), 0.0, 1e-9);
  EXPECT_NEAR(centre.y(), 0.0, 1e-9);
  EXPECT_NEAR(centre.z(), 2500.0, 1e-9);
  EXPECT_NEAR(machine.spot_camera.fx_px / centre.z(), 1.0 / 0.2, 1e-9);
}

TEST_F(MachineFileTest, PicturesAreAsHardAsTheFileSays) {
  const MachineDescription clean = readMachine(base::fixture("machines/two-mirror.yaml"));
  EXPECT_EQ(clean.spot_camera.bits, 8);
  EXPECT_EQ(clean.spot_camera.texture.grain_gray, 0.0);
  const MachineDescription hard = readMachine(extending(
      "two-mirror.yaml",
      "cameras:\n  spot: {bits: 12, texture: {glow_percent: 10}, plume: {percent: 20, offset_mm: [2, -1]},\n"
      "         link: {drop_percent: 1, stamp_jitter_us: 5, late_ms: 3, lost: [{first: 7, count: 2}],\n"
      "                late: [{first: 30}]}, light: {gradient_percent: [20, -10]}}\n"
      "  kerf: {roughness: {rms_mm: 0.008}, hot_pixels: {percent: 0.01}}\n"));
  EXPECT_EQ(hard.spot_camera.bits, 12);
  EXPECT_DOUBLE_EQ(hard.spot_camera.texture.glow_share, 0.1);
  EXPECT_DOUBLE_EQ(hard.spot_camera.plume.share, 0.2);
  EXPECT_EQ(hard.spot_camera.plume.offset_mm.y(), -1.0);
  EXPECT_DOUBLE_EQ(hard.spot_camera.link.drop_share, 0.01);
  EXPECT_DOUBLE_EQ(hard.spot_camera.link.stamp_jitter_s, 5e-6);
  ASSERT_EQ(hard.spot_camera.link.lost.size(), 1U);
  EXPECT_EQ(hard.spot_camera.link.lost[0].first, 7U);
  EXPECT_EQ(hard.spot_camera.link.lost[0].count, 2U);
  ASSERT_EQ(hard.spot_camera.link.late.size(), 1U);
  EXPECT_EQ(hard.spot_camera.link.late[0].count, 1U);
  EXPECT_THAT(faultsAt(extending("two-mirror.yaml",
                                 "cameras: {spot: {link: {lost: [{count: 0}], late: [{first: 1}]}}}\n")),
              AllOf(HasSubstr("first: missing"), HasSubstr("count"), HasSubstr("says no late_ms")));
  EXPECT_DOUBLE_EQ(hard.spot_camera.light.gradient_y, -0.1);
  EXPECT_DOUBLE_EQ(hard.kerf_camera.roughness.rms_mm, 0.008);
  EXPECT_DOUBLE_EQ(hard.kerf_camera.hot.share, 1e-4);
  EXPECT_THAT(faultsAt(extending("two-mirror.yaml", "cameras: {kerf: {plume: {percent: 5}}}\n")),
              HasSubstr("cameras.kerf.plume: unknown key"));
}

}  // namespace
}  // namespace kerfbench::machine_file
