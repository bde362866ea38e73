// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/job/parameter_names.h"

#include <algorithm>
#include <array>

namespace kerfbench::planner {
namespace {

constexpr double kMilli = 1e3;
constexpr double kMicro = 1e6;

constexpr std::array<ParameterName, 48> kParameterNames{{
    {Parameter::kThrow, "--throw", "controller.throw_mm"},
    {Parameter::kMirrorSpacing, "--mirror-spacing", "controller.mirror_spacing_mm"},
    {Parameter::kMirrorStep, "--mirror-step", "controller.mirror_step_urad", kMicro},
    {Parameter::kMirrorAcceleration, "--mirror-acceleration", "controller.mirror_acceleration_rad_s2"},
    {Parameter::kFullStepPulses, "--full-step-pulses", "controller.full_step_pulses"},
    {Parameter::kDetentShare, "--detent-share", "controller.detent_share"},
    {Parameter::kRotorResonance, "--rotor-resonance", "controller.rotor_resonance_hz"},
    {Parameter::kRotorDamping, "--rotor-damping", "controller.rotor_damping"},
    {Parameter::kFocalLength, "--focal-length", "controller.focal_length_mm"},
    {Parameter::kGantryStep, "--gantry-step", "controller.gantry_step_mm"},
    {Parameter::kFieldX, "--x-min, --x-max", "controller.field_x_mm"},
    {Parameter::kFieldY, "--y-min, --y-max", "controller.field_y_mm"},
    {Parameter::kTrackingDelay, "--tracking-delay", "controller.tracking_delay_ms", kMilli},
    {Parameter::kEncoderCount, "--encoder-count", "controller.encoder_count_mm"},
    {Parameter::kPrintMarkSensor, "--print-mark-sensor", "controller.print_mark_sensor_x_mm"},
    {Parameter::kFeedStep, "--feed-step", "controller.feed_step_mm"},
    {Parameter::kFullPower, "--full-power", "controller.full_power_w"},
    {Parameter::kPowerQuantum, nullptr, "controller.power_quantum_mj", kMilli},
    {Parameter::kPowerDelay, nullptr, "controller.power_delay_ms", kMilli},
    {Parameter::kLaserLag, nullptr, "controller.laser_lag_ms", kMilli},
    {Parameter::kBeltSpeed, "--belt-speed", "belt.speed_mm_s"},
    {Parameter::kBeltMin, "--belt-min", "belt.min_mm_s"},
    {Parameter::kBeltMax, "--belt-max", "belt.max_mm_s"},
    {Parameter::kMarkSpeed, "--mark-speed", "planner.mark_speed_mm_s"},
    {Parameter::kJumpSpeed, "--jump-speed", "planner.jump_speed_mm_s"},
    {Parameter::kAcceleration, "--acceleration", "planner.acceleration_mm_s2"},
    {Parameter::kJumpAcceleration, "--jump-acceleration", "planner.jump_acceleration_mm_s2"},
    {Parameter::kJumpRadius, "--jump-radius", "planner.jump_radius_mm"},
    {Parameter::kRunUp, "--run-up", "planner.run_up_mm"},
    {Parameter::kCornerError, "--corner-error", "planner.corner_error_mm"},
    {Parameter::kJerk, "--jerk", "planner.jerk_mm_s3"},
    {Parameter::kCutEnergy, "--cut-energy", "planner.cut_energy_j_per_mm"},
    {Parameter::kHalfZ, "--half-z", "planner.half_z"},
    {Parameter::kPerforationCut, "--perforation-cut", "planner.perforation_cut_mm"},
    {Parameter::kPerforationGap, "--perforation-gap", "planner.perforation_gap_mm"},
    {Parameter::kKerfRadius, "--kerf-radius", "planner.kerf_radius_mm"},
    {Parameter::kAllowLost, "--allow-lost", "planner.allow_lost_features"},
    {Parameter::kUnits, "--units", "print.units"},
    {Parameter::kPitch, "--pitch", "print.pitch_mm"},
    {Parameter::kEyeMark, "--eye-mark", "print.eye_mark_x_mm"},
    {Parameter::kWebStart, "--web-start", "belt.start_x_mm"},
    {Parameter::kFeed, "--feed", "belt.drive"},
    {Parameter::kFeedAcceleration, "--feed-acceleration", nullptr},
    {Parameter::kStopAndGo, "--stop-and-go", "planner.stop_and_go"},
    {Parameter::kMaterial, "--material", "planner.power.material"},
    {Parameter::kDepth, "--depth", "planner.power.depth_mm"},
    {Parameter::kHalfDepth, "--half-depth", "planner.power.half_depth_mm"},
    {Parameter::kSpotDiameter, "--spot-diameter", "planner.power.spot_diameter_mm"},
}};

const ParameterName& rowOf(Parameter parameter) {
  return *std::ranges::find(kParameterNames, parameter, &ParameterName::parameter);
}

/// What has no name of one kind is known by the other.
bool isKey(const ParameterName& row, GivenBy given_by) {
  return row.option == nullptr || (given_by == GivenBy::kScenario && row.key != nullptr);
}

}  // namespace

std::span<const ParameterName> parameterNames() { return kParameterNames; }

std::string nameOf(Parameter parameter, GivenBy given_by) {
  const ParameterName& row = rowOf(parameter);
  return isKey(row, given_by) ? row.key : row.option;
}

double scaleOf(Parameter parameter, GivenBy given_by) {
  const ParameterName& row = rowOf(parameter);
  return isKey(row, given_by) ? row.key_scale : 1.0;
}

}  // namespace kerfbench::planner
