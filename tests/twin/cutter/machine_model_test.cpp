// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/machine_model.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/twin/cutter/machines.h"
#include "tests/twin/cutter/model_rigs.h"
#include "twin/machine/multibody.h"

namespace kerfbench::twin {
namespace {

class Model : public testing::TestWithParam<Fidelity> {};
INSTANTIATE_TEST_SUITE_P(Fidelities, Model, testing::Values(Fidelity::kReference, Fidelity::kFast),
                         [](const auto& of) { return of.param == Fidelity::kFast ? "fast" : "reference"; });

TEST_P(Model, ALineThatRunsWithFrictionAndDragStartsWithoutAJolt) {
  for (const double feedforward : {0.0, 1.0}) {
    MachineDescription machine = twoMirror();
    machine.belt.bed_friction = {6.0, 10.0, 1e-6};
    machine.belt.sheet_drag_n = {-0.1, 0.05};
    machine.belt.line_servo.velocity_feedforward = feedforward;
    machine.belt.line_servo.input_delay_s = 137e-6;
    machine.belt.line_servo.current_lag_s = 1e-4;
    MachineModel model(machine, lineWeb(), GetParam());
    runModel(model, 0.2, [&](double t) {
      ASSERT_NEAR(model.pose().belt_travel_mm, 60.0 * t, 1e-9);
      ASSERT_NEAR(model.pose().roller_mm, 60.0 * t, 1e-9);
      ASSERT_LT(model.pose().sheet_slip_mm.norm(), 1e-9);
      ASSERT_NEAR(model.sheetSpeed_mm_s(), 60.0, 1e-7);
      ASSERT_NEAR(model.rollerAcceleration_mm_s2(), 0.0, 1e-3);
    });
  }
}

TEST_P(Model, ASheetStoppedTooHardSlidesOnAsFarAsItsFrictionLetsIt) {
  const MachineDescription machine = twoMirror();
  WebDescription web = lineWeb();
  web.belt_speed_mm_s = 600.0;
  // The belt slows down at 20 m/s², friction allows 5.88.
  web.belt_speed_changes = {{0.05, 600.0}, {0.08, 0.0}};
  MachineModel model(machine, web, GetParam());
  double travel_before_mm = 0.0;
  double sliding_mm = 0.0;   // Place of the board at 90 ms, when the belt has all but stopped.
  double sliding_m_s = 0.0;  // Speed of the board at that time.
  double at_140_ms_mm = 0.0;
  runModel(model, 0.4, [&](double t) {
    const MachinePose at = model.pose();
    const double travel_mm = at.belt_travel_mm + at.sheet_slip_mm.x();
    ASSERT_NEAR(model.sheetSpeed_mm_s(), (travel_mm - travel_before_mm) / MachineModel::kStep_s, 0.2);
    travel_before_mm = travel_mm;
    if (t < 0.1400001) at_140_ms_mm = travel_mm;
    if (t < 0.0900001) {
      sliding_mm = travel_mm;
      sliding_m_s = 1e-3 * model.sheetSpeed_mm_s();
    }
    if (t > 0.09 && t < 0.14) {
      ASSERT_NEAR(model.sheetAcceleration_mm_s2(), -0.6 * 9806.65, 1e-3);
    }
  });
  EXPECT_GT(sliding_m_s, 0.3);
  const double farther_mm = 1e3 * (sliding_m_s * 0.05 - 0.5 * 0.6 * 9.80665 * 0.05 * 0.05);
  EXPECT_NEAR(at_140_ms_mm - sliding_mm, farther_mm, 1e-6);
  EXPECT_GT(model.pose().sheet_slip_mm.x(), 20.0);
  EXPECT_EQ(model.pose().sheet_slip_mm.y(), 0.0);
  EXPECT_NEAR(model.sheetSpeed_mm_s(), 0.0, 1e-6);
}

TEST_P(Model, TheSpotOfALeaningGantryIsWhereItsBodiesAre) {
  MachineDescription machine = gantryOnFeet();
  machine.squareness_rad = 0.01;
  MachineModel model(machine, lineWeb(), GetParam());
  feed(model, Axis::kGantryX, trapezoid(1e-3, 900, 2e4, 1e6));
  feed(model, Axis::kGantryY, trapezoid(2e-3, -1500, 3e4, 2e6));
  const MachineMechanism mechanism = mechanismOf(machine, lineWeb());
  Multibody body(mechanism.description.joints);
  std::vector<double> q(body.size(), 0.0);
  double shaken_mm = 0.0;
  runModel(model, 0.1, [&](double) {
    const MachinePose at = model.pose();
    shaken_mm = std::max(shaken_mm, at.frame_mm.norm());
    q[*mechanism.frame_x] = 1e-3 * at.frame_mm.x();
    q[*mechanism.frame_y] = 1e-3 * at.frame_mm.y();
    q[*mechanism.head_x] = 1e-3 * at.gantry_mm.x();
    q[*mechanism.head_y] = 1e-3 * at.gantry_mm.y();
    const Eigen::Vector3d carriage_mm = 1e3 * body.pose(q, *mechanism.head_y).translation();
    const auto spot = model.spot();
    ASSERT_TRUE(spot);
    ASSERT_LT((spot->p_WQ_mm - carriage_mm.head<2>()).norm(), 1e-11);
  });
  EXPECT_GT(shaken_mm, 1e-3);
  EXPECT_NEAR(model.pose().gantry_mm.y(), -1500 * kTravelStepMm, 0.05);
  EXPECT_NEAR(model.spot()->p_WQ_mm.x(), (900 + 1500 * 0.01) * kTravelStepMm, 0.05);
}

TEST(Mechanism, MirrorsTurnInTheirPlaceAboutTheirAxis) {
  MachineDescription machine = twoMirror();
  machine.head.x.axis_tilt_rad = {0.01, -0.02};
  const ScanHead head(machine.head, machine.beam);
  const MachineMechanism mechanism = mechanismOf(machine, lineWeb());
  Multibody body(mechanism.description.joints);
  std::vector<double> q(body.size(), 0.0);
  q[*mechanism.head_x] = 0.1;
  q[*mechanism.head_y] = -0.2;
  const Eigen::Isometry3d x = body.pose(q, *mechanism.head_x);
  const Eigen::Isometry3d y = body.pose(q, *mechanism.head_y);
  EXPECT_LT((x.linear() - Eigen::AngleAxisd(0.1, head.xMirrorAxis()).toRotationMatrix()).norm(), 1e-14);
  EXPECT_LT((y.linear() - Eigen::AngleAxisd(-0.2, head.yMirrorAxis()).toRotationMatrix()).norm(), 1e-14);
  EXPECT_LT((1e3 * x.translation() - head.xMirrorPlace_mm()).norm(), 1e-10);
  EXPECT_LT((1e3 * y.translation() - head.yMirrorPlace_mm()).norm(), 1e-10);
}

TEST_P(Model, AMirrorTrailsItsPulsesByItsTrackingDelay) {
  const MachineDescription machine = twoMirror();
  MachineModel model(machine, lineWeb(), GetParam());
  feed(model, Axis::kGalvoY, trapezoid(0.0, 3000, 40e3, 1e9));
  runModel(model, 0.05);
  const double delay_s =
      2.0 * 0.7 / std::get<ServoDescription>(machine.galvo_y.drive).natural_frequency_rad_s;
  const double from_s = 0.5 * 40e3 / 1e9;  // Half the time of the ramp.
  EXPECT_NEAR(model.pose().mirror_rad.y(), kGalvoStepRad * 40e3 * (0.05 - from_s - delay_s), 3e-7);
}

TEST_P(Model, AnInputDelayShiftsTheMotionByItself) {
  MachineDescription machine = twoMirror();
  const auto path = [&] {
    MachineModel model(machine, lineWeb(), GetParam());
    feed(model, Axis::kGalvoX, trapezoid(1e-3, 300, 40e3, 1e8));
    std::vector<double> angles;
    runModel(model, 0.02, [&](double) { angles.push_back(model.pose().mirror_rad.x()); });
    return angles;
  };
  const std::vector<double> prompt = path();
  std::get<ServoDescription>(machine.galvo_x.drive).input_delay_s = 20 * MachineModel::kStep_s;
  const std::vector<double> late = path();
  for (std::size_t i = 20; i < late.size(); ++i) ASSERT_NEAR(late[i], prompt[i - 20], 1e-12) << i;
  EXPECT_GT(prompt.back(), 299 * kGalvoStepRad);
}

TEST_P(Model, AStepperThatIsDrivenTooHardSaysWhatItHasLost) {
  MachineModel model(stepperGantry(), lineWeb(), GetParam());
  feed(model, Axis::kGantryX, trapezoid(1e-3, -3000, 80e3, 4e6));  // The profile has 50 m/s² to 1 m/s.
  runModel(model, 0.25);
  ASSERT_FALSE(model.lostSteps().empty());
  long long full_steps = 0;
  double last_s = 0.0;
  for (const LostSteps& lost : model.lostSteps()) {
    EXPECT_EQ(lost.axis, "gantry_x");
    EXPECT_GE(lost.time_s, last_s);
    EXPECT_LE(lost.place, 0.0);
    EXPECT_GE(lost.place, -3000 * kTravelStepMm);
    EXPECT_EQ(lost.full_steps % 4, 0);
    last_s = lost.time_s;
    full_steps += lost.full_steps;
  }
  EXPECT_LT(full_steps, 0);  // The rotor is behind in the direction of -.
  const double missing_mm = -3000 * kTravelStepMm - model.pose().gantry_mm.x();
  EXPECT_NEAR(missing_mm, static_cast<double>(full_steps) * 40.0 / 200.0, 0.02);
}

TEST_P(Model, WithinItsTorqueAStepperLosesNothing) {
  MachineModel model(stepperGantry(), lineWeb(), GetParam());
  feed(model, Axis::kGantryX, trapezoid(1e-3, 3000, 40e3, 4e5));  // The profile has 5 m/s² to 0.5 m/s.
  runModel(model, 0.4);
  EXPECT_TRUE(model.lostSteps().empty());
  EXPECT_NEAR(model.pose().gantry_mm.x(), 3000 * kTravelStepMm, 0.05);
}

TEST_P(Model, PulsesOfAnAxisThatIsNotThereMoveNothing) {
  MachineModel model(twoMirror(), lineWeb(), GetParam());
  feed(model, Axis::kGantryX, trapezoid(0.0, 100, 1e4, 1e6));
  feed(model, Axis::kFeed, trapezoid(0.0, 100, 1e4, 1e6));
  runModel(model, 0.02);
  EXPECT_EQ(model.pose().gantry_mm.norm(), 0.0);
  EXPECT_NEAR(model.pose().belt_travel_mm, 60.0 * 0.02, 1e-9);
}

TEST_P(Model, AFeedWithBacklashLosesItWhenItTurnsBack) {
  MachineDescription machine = twoMirror();
  machine.belt.feed.backlash = 2e-3;  // Backlash of the roller: 60 um of the belt.
  // The drive is hardly displaced by friction, and friction holds the roller when the motor slows down.
  machine.belt.feed.drive = nema23Stepper();
  machine.belt.feed.friction = {0.2, 1e-3, 1e-5};
  MachineModel model(machine, fedWeb(), GetParam());
  const auto forth = trapezoid(1e-3, 800, 4e3, 1e4);
  feed(model, Axis::kFeed, forth);
  feed(model, Axis::kFeed, trapezoid(endOf(forth) + 0.1, -400, 4e3, 1e4));
  double reached_mm = 0.0;
  runModel(model, endOf(forth) + 0.5, [&](double t) {
    if (t < endOf(forth) + 0.1) reached_mm = model.pose().roller_mm;
  });
  // Ringing of the motor when it stops knocks the roller a little back into the play.
  const double play_mm = 2e-3 * machine.belt.roller_radius_mm;
  const double lost_mm = 400 * kTravelStepMm - (reached_mm - model.pose().roller_mm);
  EXPECT_GT(lost_mm, 0.5 * play_mm);
  EXPECT_LT(lost_mm, 1.02 * play_mm);
}

TEST_P(Model, TheSameRunGivesTheSameBits) {
  const auto end = [&] {
    MachineModel model(stepperGantry(), lineWeb(), GetParam());
    feed(model, Axis::kGantryX, trapezoid(0.0, 500, 2e4, 1e6));
    feed(model, Axis::kGantryY, trapezoid(0.0, -300, 2e4, 1e6));
    runModel(model, 0.04);
    return model.spot()->p_WQ_mm;
  };
  EXPECT_EQ(end(), end());
}

TEST(ModelDescription, RefusesAnAxisWithoutATransmission) {
  MachineDescription machine = twoMirror();
  machine.galvo_x.stiffness = 0.0;
  try {
    const MachineModel model(machine, lineWeb());
    FAIL() << "was accepted";
  } catch (const std::invalid_argument& fault) {
    EXPECT_NE(std::string(fault.what()).find("galvo_x.mirror: stiffness"), std::string::npos) << fault.what();
  }
}

}  // namespace
}  // namespace kerfbench::twin
