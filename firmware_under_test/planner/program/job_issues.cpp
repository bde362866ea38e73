// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/program/job_issues.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "firmware_under_test/controller/protocol.h"
#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/head/correction.h"
#include "firmware_under_test/planner/motion/solve.h"
#include "firmware_under_test/planner/power/model.h"

namespace kerfbench::planner {
namespace {

/// Coarsest allowed correction table; a fifth of a cut's tolerance.
constexpr double kCoarsestMm = 0.01;
/// Smallest corner error: below, the fourth decimal of the G-code says more.
constexpr double kLeastCornerMm = 0.0005;
/// Faults of the table against head and field.
std::vector<std::string> correctionFaults(const MachineParameters& machine) {
  const CorrectionTable& table = *machine.correction;
  const Eigen::AlignedBox2d area = table.area_mm();
  const Eigen::Vector2d low(machine.field_min_mm[0], machine.field_min_mm[1]);
  const Eigen::Vector2d high(machine.field_max_mm[0], machine.field_max_mm[1]);
  std::vector<std::string> faults;
  if (!area.contains(low) || !area.contains(high)) {
    faults.push_back(fmt::format(
        "{}: covers x {:g} … {:g}, y {:g} … {:g} mm; the field is x {:g} … {:g}, y {:g} … {:g} mm",
        table.name(), area.min().x(), area.max().x(), area.min().y(), area.max().y(), low.x(), high.x(),
        low.y(), high.y()));
  }
  const Axes axes(machine, {});
  const CorrectionTable::Coarseness coarse = table.coarseness();
  const double unit_mm = table.unit() == CorrectionTable::Unit::kMm
                             ? 1.0
                             : 1.0 / axes.stepsPerMm(coarse.p_W_mm).diagonal().cwiseAbs().minCoeff();
  if (!(coarse.error * unit_mm <= kCoarsestMm)) {
    faults.push_back(
        fmt::format("{}: too coarse for its bends: near ({:g}, {:g}) mm two cubics through its nodes differ "
                    "by {:.4f} mm; {:g} mm may be",
                    table.name(), coarse.p_W_mm.x(), coarse.p_W_mm.y(), coarse.error * unit_mm, kCoarsestMm));
  }
  constexpr int kParts = 64;
  for (int i = 0; i < (kParts + 1) * (kParts + 1); ++i) {
    const int row = i / (kParts + 1);
    const Eigen::Vector2d share(i % (kParts + 1) / double(kParts), row / double(kParts));
    const Eigen::Vector2d p = low + share.cwiseProduct(high - low);
    const Eigen::Matrix2d slopes = axes.stepsPerMm(p);
    if (slopes(0, 0) > 0.0 && slopes(1, 1) > 0.0 && slopes.determinant() > 0.0) continue;
    faults.push_back(
        fmt::format("{}: not monotonic: at ({:g}, {:g}) mm the beam would go back where it should go on",
                    table.name(), p.x(), p.y()));
    break;
  }
  return faults;
}

/// Checks machine and job, section by section; every fault is kept.
class JobChecker {
 public:
  JobChecker(const MachineParameters& machine, const JobParameters& job) : machine_(machine), job_(job) {}

  std::vector<std::string> faults() {
    checkHead();
    checkField();
    checkDelays();
    checkMotion();
    if (job_.power_loop) checkPowerLoop();
    checkMarks();
    checkFeed();
    if (job_.belt_speed_mm_s > 0.0) checkBelt();
    return std::move(faults_);
  }

 private:
  void check(bool holds, const std::string& what) {
    if (!holds) faults_.push_back(what);
  }
  // The upper bounds are beyond every machine; they keep all computed numbers finite.
  [[nodiscard]] std::string named(Parameter parameter) const { return nameOf(parameter, job_.given_by); }
  /// Value in the unit of its name.
  [[nodiscard]] double shown(Parameter parameter, double value) const {
    return value * scaleOf(parameter, job_.given_by);
  }
  void positive(double value, Parameter parameter, double most = 1e6, double least = 0.0) {
    const std::string name = named(parameter);
    const double told = shown(parameter, value);
    check(std::isfinite(value) && value > 0.0, fmt::format("{} must be > 0, but is {:g}", name, told));
    check(!(value > most),
          fmt::format("{} must be at most {:g}, but is {:g}", name, shown(parameter, most), told));
    check(!(value > 0.0 && value < least),
          fmt::format("{} must be at least {:g}, but is {:g}", name, shown(parameter, least), told));
  }
  void notNegative(double value, Parameter parameter) {
    const std::string name = named(parameter);
    const double told = shown(parameter, value);
    check(std::isfinite(value) && value >= 0.0, fmt::format("{} must be >= 0, but is {:g}", name, told));
    check(!(value > 1e6),
          fmt::format("{} must be at most {:g}, but is {:g}", name, shown(parameter, 1e6), told));
  }
  void checkHead() {
    if (machine_.head == MachineParameters::Head::kTwoMirror) {
      positive(machine_.throw_mm, Parameter::kThrow, 1e6, 0.1);
      notNegative(machine_.mirror_spacing_mm, Parameter::kMirrorSpacing);
      positive(machine_.mirror_step_rad, Parameter::kMirrorStep, 0.1, 1e-9);
      notNegative(machine_.mirror_acceleration_rad_s2, Parameter::kMirrorAcceleration);
      checkSteppers();
    } else if (machine_.head == MachineParameters::Head::kFTheta) {
      positive(machine_.focal_length_mm, Parameter::kFocalLength, 1e6, 0.1);
      positive(machine_.mirror_step_rad, Parameter::kMirrorStep, 0.1, 1e-9);
      notNegative(machine_.mirror_acceleration_rad_s2, Parameter::kMirrorAcceleration);
      checkSteppers();
    } else {
      positive(machine_.gantry_step_mm, Parameter::kGantryStep, 1e3, 1e-6);
    }
  }

  void checkSteppers() {
    const StepperMotors& motors = machine_.steppers;
    notNegative(motors.full_step_pulses, Parameter::kFullStepPulses);
    notNegative(motors.resonance_hz, Parameter::kRotorResonance);
    check(std::abs(motors.detent_share) <= 0.5,
          fmt::format("{} must be in -0.5 … 0.5, but is {:g}", named(Parameter::kDetentShare),
                      motors.detent_share));
    check(motors.resonance_damping >= 0.0 && motors.resonance_damping <= 0.9,
          fmt::format("{} must be in 0 … 0.9, but is {:g}", named(Parameter::kRotorDamping),
                      motors.resonance_damping));
    check(motors.detent_share == 0.0 || motors.full_step_pulses > 0.0,
          fmt::format("{} needs {}: the magnets' pull repeats with each full step",
                      named(Parameter::kDetentShare), named(Parameter::kFullStepPulses)));
    const double most_hz = 0.5 / machine_.target.periodS();
    check(!(motors.resonance_hz > most_hz),
          fmt::format(
              "{} is {:g} Hz, but steps in periods of {:g} ms lead no swing above {:g} Hz: leave it out",
              named(Parameter::kRotorResonance), motors.resonance_hz, machine_.target.periodS() * 1e3,
              most_hz));
  }

  void checkField() {
    for (int i = 0; i < 2; ++i) {
      const double low = machine_.field_min_mm[i];
      const double high = machine_.field_max_mm[i];
      check(low >= -1e5 && high <= 1e5 && low <= 0.0 && high >= 0.0 && low < high,
            fmt::format("the field along {} ({}) must hold the resting beam at 0, but is {:g} … {:g} mm",
                        "xy"[i], named(i == 0 ? Parameter::kFieldX : Parameter::kFieldY), low, high));
    }
    if (faults_.empty() && machine_.correction) {
      const std::vector<std::string> wrong = correctionFaults(machine_);
      faults_.insert(faults_.end(), wrong.begin(), wrong.end());
    }
  }

  void checkDelays() {
    const auto upTo = [&](double value, Parameter parameter, double most, const char* why) {
      check(value >= 0.0 && value <= most,
            fmt::format("{} must be in 0 … {:g}{}, but is {:g}", named(parameter), shown(parameter, most),
                        why, shown(parameter, value)));
    };
    upTo(machine_.tracking_delay_s, Parameter::kTrackingDelay, machine_.target.longestDelayS(),
         ", by which this controller can delay the laser");
    upTo(machine_.laser_lag_s, Parameter::kLaserLag, 1.0, "");
    for (std::string& fault : driveFaults(machine_.target, machine_.drives))
      faults_.push_back(std::move(fault));
  }

  void checkMotion() {
    positive(machine_.full_power_w, Parameter::kFullPower);
    positive(job_.mark_speed_mm_s, Parameter::kMarkSpeed, 1e6, 1e-3);
    positive(job_.jump_speed_mm_s, Parameter::kJumpSpeed, 1e6, 1e-3);
    positive(job_.acceleration_mm_s2, Parameter::kAcceleration, 1e9, 1e-3);
    notNegative(job_.jump_acceleration_mm_s2, Parameter::kJumpAcceleration);
    check(job_.corner_error_mm == 0.0 ||
              (job_.corner_error_mm >= kLeastCornerMm && job_.corner_error_mm <= 1.0),
          fmt::format("{} must be 0, or {:g} … 1, but is {:g}", named(Parameter::kCornerError),
                      kLeastCornerMm, job_.corner_error_mm));
    check(job_.jump_radius_mm == kRadiusOfDrawing ||
              (std::isfinite(job_.jump_radius_mm) && job_.jump_radius_mm >= 0.0),
          fmt::format("{} must be >= 0, or {:g} for that of the drawing, but is {:g}",
                      named(Parameter::kJumpRadius), kRadiusOfDrawing, job_.jump_radius_mm));
    check(job_.run_up_mm == kRunUpOfSpeed || (job_.run_up_mm >= 0.0 && job_.run_up_mm <= 1e3),
          fmt::format("{} must be in 0 … 1000, or {:g} for what the speed takes, but is {:g}",
                      named(Parameter::kRunUp), kRunUpOfSpeed, job_.run_up_mm));
    check(job_.run_up_mm == 0.0 || job_.jump_radius_mm == 0.0,
          fmt::format("{} is for straight jumps: with a {} the beam runs through marks and jumps anyway",
                      named(Parameter::kRunUp), named(Parameter::kJumpRadius)));
    if (!job_.power) positive(job_.cut_energy_j_per_mm, Parameter::kCutEnergy);
    check(std::isfinite(job_.jerk_mm_s3) && job_.jerk_mm_s3 >= 0.0,
          fmt::format("{} must be >= 0, but is {:g}", named(Parameter::kJerk), job_.jerk_mm_s3));
  }

  void checkPowerLoop() {
    check(job_.power != nullptr, "a loop on the measured power needs a material and a laser");
    positive(machine_.power_quantum_j, Parameter::kPowerQuantum, 1e3, 1e-6);
    // The controller looks back over a limited number of ticks, the gate's delay and its own tick among them.
    const double longest_s = (KB_POWER_DELAY_MAX - 2) * machine_.target.tick_s;
    // The gate waits for what the mirrors lag more than the laser does.
    const double lag_s = std::max(machine_.tracking_delay_s, machine_.laser_lag_s);
    check(machine_.power_delay_s >= 0.0 && machine_.power_delay_s + lag_s <= longest_s,
          fmt::format("{}, {:g}, and the longer of {} and {} must be in 0 … {:g} together",
                      named(Parameter::kPowerDelay), shown(Parameter::kPowerDelay, machine_.power_delay_s),
                      named(Parameter::kTrackingDelay), named(Parameter::kLaserLag),
                      shown(Parameter::kPowerDelay, longest_s)));
    // The controller counts to 255, and also for a tube with half as much power again.
    const double full_w = job_.power == nullptr ? 0.0 : job_.power->laser().power.greatest().y;
    const double edges = full_w * machine_.target.periodS() / (2.0 * machine_.power_quantum_j);
    check(job_.power == nullptr || (edges >= 16.0 && edges <= 160.0 * (1.0 + 1e-9)),
          fmt::format(
              "at full power the power meter sends {:.1f} edges in a period; the loop works with 16 … 160",
              edges));
  }

  void checkMarks() {
    check(job_.half_z > 0.0 && job_.half_z <= 1.0,
          fmt::format("{} must be in (0, 1], but is {:g}", named(Parameter::kHalfZ), job_.half_z));
    positive(job_.perforation_cut_mm, Parameter::kPerforationCut, 1e6, 0.01);
    positive(job_.perforation_gap_mm, Parameter::kPerforationGap, 1e6, 0.01);
    notNegative(job_.kerf_radius_mm, Parameter::kKerfRadius);
    check(job_.units >= 1 && job_.units <= 1'000'000,
          fmt::format("{} must be in 1 … 1000000, but is {}", named(Parameter::kUnits), job_.units));
    if (job_.units > 1) positive(job_.pitch_mm, Parameter::kPitch);
    if (job_.units <= 1) notNegative(job_.pitch_mm, Parameter::kPitch);
    check(std::abs(job_.web_start_x_mm) <= 1e9,
          fmt::format("{} must be a number within ±1e9", named(Parameter::kWebStart)));
    notNegative(job_.belt_speed_mm_s, Parameter::kBeltSpeed);
    checkBeltRange();
  }

  void checkBeltRange() {
    const double v = job_.belt_speed_mm_s;
    notNegative(job_.belt_min_mm_s, Parameter::kBeltMin);
    notNegative(job_.belt_max_mm_s, Parameter::kBeltMax);
    check(!(job_.belt_min_mm_s > v) && !(job_.belt_max_mm_s > 0.0 && job_.belt_max_mm_s < v),
          fmt::format("the belt speed of {:g} mm/s must lie between the lowest and the highest, but these "
                      "are {:g} and {:g}",
                      v, job_.belt_min_mm_s, job_.belt_max_mm_s));
    check(!((job_.belt_min_mm_s > 0.0 || job_.belt_max_mm_s > 0.0) && job_.stop_and_go),
          "a belt that stops for each cut has no lowest and highest speed");
  }

  void checkFeed() {
    if (job_.feed_by_controller) {
      positive(machine_.feed_step_mm, Parameter::kFeedStep, 1e3, 1e-6);
      positive(job_.feed_acceleration_mm_s2, Parameter::kFeedAcceleration, 1e9, 1e-3);
    }
    if (job_.stop_and_go) {
      const bool by_key = job_.given_by == GivenBy::kScenario;
      check(job_.feed_by_controller, fmt::format("{} needs {}{}", named(Parameter::kStopAndGo),
                                                 named(Parameter::kFeed), by_key ? ": controller" : ""));
      positive(job_.belt_speed_mm_s, Parameter::kBeltSpeed);
      check(!(job_.belt_speed_mm_s > feedLimit(machine_)),
            fmt::format("a feed of {:g} mm/s ({}) is too fast: by {} the feed makes no more than {:.1f} mm/s",
                        job_.belt_speed_mm_s, named(Parameter::kBeltSpeed), named(Parameter::kFeedStep),
                        feedLimit(machine_)));
    }
  }

  void checkBelt() {
    positive(machine_.encoder_count_mm, Parameter::kEncoderCount, 1e3, 1e-6);
    for (const auto& [value, parameter] :
         {std::pair(machine_.print_mark_sensor_x_mm, Parameter::kPrintMarkSensor),
          std::pair(job_.eye_mark_x_mm, Parameter::kEyeMark)})
      check(std::abs(value) <= 1e6, fmt::format("{} must be a number within ±1e6", named(parameter)));
    // The follow gain is an i16 of steps per count times 4096.
    const double per_mm = !faults_.empty() ? 0.0 : Axes(machine_, {}).xStepsPerMm(Eigen::Vector2d::Zero());
    check(!(per_mm * machine_.encoder_count_mm * 4096.0 > 32767.0),
          fmt::format("{}: a count of {:g} mm is {:.2f} steps; the controller follows no more than 7.99",
                      named(Parameter::kEncoderCount), machine_.encoder_count_mm,
                      per_mm * machine_.encoder_count_mm));
  }

  const MachineParameters& machine_;
  const JobParameters& job_;
  std::vector<std::string> faults_;
};

}  // namespace

std::vector<std::string> jobIssues(const MachineParameters& machine, const JobParameters& job) {
  return JobChecker(machine, job).faults();
}

}  // namespace kerfbench::planner
