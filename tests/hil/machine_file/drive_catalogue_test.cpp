// SPDX-License-Identifier: Apache-2.0
// Drives of the catalogue compared with their data sheets, with the twin's own drive.
#include "hil/machine_file/drive_catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include "tests/hil/base/temp_folder.h"
#include "twin/machine/reference_solver.h"

namespace kerfbench::machine_file {
namespace {

using testing::HasSubstr;

constexpr double kStep_s = 10e-6;
constexpr double kTurn_rad = 2.0 * std::numbers::pi;

// Rotor and mirror as one, driven as the profile says, as the data sheet's position sensor sees them.
class Rotor {
 public:
  explicit Rotor(const ServoProfile& profile) : solver_(mechanism(profile), kStep_s) {}
  // Angle at the end of the next step, under the mean command of the step.
  double step(double command_rad) {
    const twin::DriveCommand command{command_rad, command_rad, command_rad};
    solver_.step(time_s_, {&command, 1});
    time_s_ += kStep_s;
    return solver_.q()[0];
  }
  [[nodiscard]] double time_s() const { return time_s_; }

 private:
  static std::shared_ptr<const twin::Mechanism> mechanism(const ServoProfile& profile) {
    const double inertia_kg_m2 = 2.0 * profile.motor_inertia_kg_m2;  // The mirror is as heavy as the rotor.
    twin::MechanismDescription description;
    description.joints.push_back({"rotor", twin::JointDescription::Kind::kRevolute, -1,
                                  Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ(), 0.0, inertia_kg_m2, 0.0,
                                  1e6});
    twin::JointDrive drive;
    drive.name = "galvo";
    drive.drive = profile.servo;
    std::get<twin::ServoDescription>(drive.drive).max_torque =
        std::min(profile.servo.max_torque, inertia_kg_m2 * profile.max_acceleration_rad_s2);
    drive.inertia_kg_m2 = inertia_kg_m2;
    description.drives.push_back(drive);
    return std::make_shared<const twin::Mechanism>(description);
  }
  twin::ReferenceSolver solver_;
  double time_s_{0.0};
};

// Time at which the answer to a step was last further from its end than `share` of it.
double settling_s(const ServoProfile& profile, double step_rad, double share) {
  Rotor rotor(profile);
  double last_s = 0.0;
  while (rotor.time_s() < 0.05) {
    if (std::abs(rotor.step(step_rad) - step_rad) > share * step_rad) last_s = rotor.time_s();
  }
  return last_s;
}

double gainOfSine(const ServoProfile& profile, double amplitude_rad, double frequency_hz) {
  Rotor rotor(profile);
  const double settled_s = 0.02 + 4.0 / frequency_hz;
  double largest = 0.0;
  while (rotor.time_s() < settled_s + 1.0 / frequency_hz) {
    const double middle_s = rotor.time_s() + 0.5 * kStep_s;
    const double at = rotor.step(amplitude_rad * std::sin(kTurn_rad * frequency_hz * middle_s));
    if (rotor.time_s() > settled_s) largest = std::max(largest, std::abs(at));
  }
  return largest / amplitude_rad;
}

DriveCatalogue house() { return readCatalogue(base::fixture("machines/drivers.yaml")); }

class GalvoProfile : public testing::Test {
 protected:
  const DriveCatalogue catalogue_ = house();
  const ServoProfile profile_ = catalogue_.servos.at("galvo-10mm");
  const GalvoDataSheet sheet_ = profile_.data_sheet.value();
  static constexpr double kSettled = 0.05;  // The data sheet does not say how close "settled" is.
  static constexpr double kHalfPower = 0.7079457843841379;
};

TEST_F(GalvoProfile, ASmallStepSettlesInTheTimeOfTheDataSheet) {
  const double time_s = settling_s(profile_, sheet_.small_angle_rad, kSettled);
  RecordProperty("settling_us", std::to_string(1e6 * time_s));
  EXPECT_NEAR(time_s, sheet_.small_step_s, 0.05 * sheet_.small_step_s);
}

TEST_F(GalvoProfile, ASmallSineLosesHalfItsPowerAboveTheBandwidthOfTheDataSheetOnly) {
  EXPECT_GT(gainOfSine(profile_, sheet_.small_angle_rad, sheet_.small_sine_hz), kHalfPower);
  EXPECT_LT(gainOfSine(profile_, sheet_.small_angle_rad, 1.5 * sheet_.small_sine_hz), kHalfPower);
}

TEST_F(GalvoProfile, LargeSinesAreFollowedToTheirFullAngle) {
  EXPECT_NEAR(gainOfSine(profile_, sheet_.full_angle_rad, sheet_.full_sine_hz), 1.0, 0.02);
  EXPECT_NEAR(gainOfSine(profile_, 0.5 * sheet_.full_angle_rad, sheet_.half_sine_hz), 1.0, 0.02);
  // The limits are as tight as the data sheet lets them be: half as fast again is too fast.
  EXPECT_LT(gainOfSine(profile_, 0.5 * sheet_.full_angle_rad, 1.5 * sheet_.half_sine_hz), 0.9);
}

TEST_F(GalvoProfile, LargeStepsAreOverWithinHalfAPeriodOfTheSquareWaves) {
  const double full_s = settling_s(profile_, 2.0 * sheet_.full_angle_rad, 0.01);
  const double half_s = settling_s(profile_, sheet_.full_angle_rad, 0.01);
  EXPECT_LT(full_s, 0.5 / sheet_.full_square_hz);
  EXPECT_LT(half_s, 0.5 / sheet_.half_square_hz);
  EXPECT_GT(half_s, 0.5 * (0.5 / sheet_.half_square_hz));  // A drive without limits would be faster.
}

TEST_F(GalvoProfile, LargeMirrorsTrailByWhatIsUsualInConverting) {
  const twin::ServoDescription& servo = catalogue_.servos.at("galvo-30mm").servo;
  const double delay_s = 2.0 * servo.damping / servo.natural_frequency_rad_s;
  EXPECT_GT(delay_s, 0.3e-3);
  EXPECT_LT(delay_s, 0.8e-3);
}

TEST(DriveCatalogue, TheSteppersAreThoseOfTheirDataSheets) {
  const StepperProfile small = house().steppers.at("17HS4401");
  EXPECT_DOUBLE_EQ(small.motor_inertia_kg_m2, 54e-7);
  EXPECT_DOUBLE_EQ(small.stepper.holding_torque_nm, 0.40);
  EXPECT_DOUBLE_EQ(small.stepper.inductance_h, 2.8e-3);
  EXPECT_EQ(small.stepper.rotor_teeth, 50);
  const StepperProfile large = house().steppers.at("QSH5718-55-30-098");
  EXPECT_DOUBLE_EQ(large.motor_inertia_kg_m2, 209e-7);
  EXPECT_DOUBLE_EQ(large.stepper.detent_torque_nm, 0.030);
  // Dampings are typical: 2 … 15 % of critical, without a load.
  for (const StepperProfile& motor : {small, large}) {
    const double stiffness = motor.stepper.holding_torque_nm * motor.stepper.rotor_teeth;
    const double zeta = motor.stepper.damping_nm_s / (2.0 * std::sqrt(stiffness * motor.motor_inertia_kg_m2));
    EXPECT_GT(zeta, 0.02);
    EXPECT_LT(zeta, 0.15);
  }
}

class BadCatalogue : public testing::Test {
 protected:
  std::string faultsOf(const std::string& content) const {
    try {
      readCatalogue(temp_.write("d.yaml", content));
    } catch (const base::ConfigError& e) {
      return e.what();
    }
    return {};
  }
  const base::TempFolder temp_;
};

TEST_F(BadCatalogue, EveryEntryNamesItsSource) {
  EXPECT_THAT(faultsOf("servos:\n  - {name: a, bandwidth_hz: 10, motor_inertia_kg_m2: 1.0e-6}\n"),
              HasSubstr("d.yaml:2: servos[0].source: missing"));
}

TEST_F(BadCatalogue, TwoCurrentLimitsAreOneTooMany) {
  EXPECT_THAT(faultsOf("servos:\n  - {name: a, source: b, bandwidth_hz: 10, motor_inertia_kg_m2: 1.0e-6, "
                       "max_torque_n_m: 1, max_acceleration_rad_s2: 10}\n"),
              HasSubstr("servos[0].max_acceleration_rad_s2: is given beside max_torque_n_m"));
}

TEST_F(BadCatalogue, AMotorHeldByItsMagnetsAloneIsNoStepper) {
  EXPECT_THAT(
      faultsOf("steppers:\n  - {name: a, source: b, holding_torque_n_m: 0.1, detent_torque_n_m: 0.2, "
               "rated_current_a: 1, resistance_ohm: 1, inductance_mh: 1, motor_inertia_kg_m2: 1.0e-6, "
               "subdivision: 1}\n"),
      HasSubstr("steppers[0].detent_torque_n_m: must be less than holding_torque_n_m"));
}

}  // namespace
}  // namespace kerfbench::machine_file
