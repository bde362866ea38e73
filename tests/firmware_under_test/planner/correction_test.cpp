// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/head/correction.h"

#include <cmath>
#include <functional>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/program/check.h"
#include "firmware_under_test/planner/program/job_issues.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using Field = std::function<Vector2d(const Vector2d&)>;

/// Effect of each axis's angle (in steps) on the beam: the formula's inverse, then a distortion that no
/// formula has.
Vector2d idealPlace(const Vector2d& steps, const MachineParameters& m) {
  const Vector2d optical = 2.0 * steps * m.mirror_step_rad;
  if (m.head == MachineParameters::Head::kFTheta) return m.focal_length_mm * optical;
  const double y = m.throw_mm * std::tan(optical.y());
  return {(std::hypot(m.throw_mm, y) + m.mirror_spacing_mm) * std::tan(optical.x()), y};
}

/// Distortion: pincushion along x, barrel along y, shear and an offset, no two directions alike. Millimetres
/// at the rim.
Vector2d distorted(const Vector2d& q, double half_mm) {
  const Vector2d u = q / half_mm;
  const double r2 = u.squaredNorm();
  return q + half_mm * Vector2d(0.012 * u.x() * r2 + 0.003 * u.y() * u.y() + 0.002,
                                -0.009 * u.y() * r2 + 0.004 * u.x());
}

/// Aim for which the distorted beam lands at p, by fixed-point iteration.
Vector2d aimFor(const Vector2d& p, double half_mm) {
  Vector2d q = p;
  for (int i = 0; i < 100; ++i) q += p - distorted(q, half_mm);
  return q;
}

std::string csv(const char* header, double half_mm, int nodes, const Field& value) {
  std::string text = std::string("# made by a test\n") + header + "\n";
  for (int row = 0; row < nodes; ++row) {
    for (int column = 0; column < nodes; ++column) {
      const Vector2d p(-half_mm + 2 * half_mm * column / (nodes - 1),
                       -half_mm + 2 * half_mm * row / (nodes - 1));
      const Vector2d d = value(p);
      text += fmt::format("{},{},{},{}\n", p.x(), p.y(), d.x(), d.y());
    }
  }
  return text;
}

constexpr const char* kMm = "x_mm,y_mm,dx_mm,dy_mm";
constexpr const char* kSteps = "x_mm,y_mm,dx_steps,dy_steps";

std::string faultsIn(const std::string& text) {
  try {
    CorrectionTable::parse(text, "t.csv");
  } catch (const PlanError& error) {
    return error.what();
  }
  return {};
}

MachineParameters fTheta() {
  MachineParameters machine = test::twoMirror();
  machine.head = MachineParameters::Head::kFTheta;
  machine.focal_length_mm = 430.0;
  machine.mirror_step_rad = 5e-6;
  for (int i = 0; i < 2; ++i) machine.field_min_mm[i] = -150.0, machine.field_max_mm[i] = 150.0;
  return machine;
}

MachineParameters with(MachineParameters machine, const std::string& text) {
  machine.correction = std::make_shared<CorrectionTable>(CorrectionTable::parse(text, "t.csv"));
  return machine;
}

/// Worst distance between wanted and reached place, at places of no node.
double residualMm(const MachineParameters& machine, double half_mm) {
  const Axes axes(machine, {});
  std::mt19937 random(42);
  double worst = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const auto share = [&] { return double(random() % 20001) / 10000.0 - 1.0; };
    const Vector2d p(share() * half_mm, share() * half_mm);
    worst = std::max(worst, (distorted(idealPlace(axes.stepsAt(p), machine), half_mm) - p).norm());
  }
  return worst;
}

TEST(Correction, TakesAKnownDistortionOutToWhatInterpolationLeaves) {
  for (const MachineParameters& head : {test::twoMirror(), fTheta()}) {
    const double half = head.field_max_mm[0];
    ASSERT_GT(residualMm(head, half), 0.02 * half) << "the distortion is of millimetres";
    double before = 1e9;
    for (const int nodes : {5, 9, 17, 33}) {
      const std::string text =
          csv(kMm, half, nodes, [&](const Vector2d& p) { return Vector2d(aimFor(p, half) - p); });
      const MachineParameters machine = with(head, text);
      const double residual = residualMm(machine, half);
      EXPECT_LT(residual, 3.0 * machine.correction->coarseness().error) << nodes;
      EXPECT_LT(residual, before / 8.0) << nodes << ": fourth order would be 16";
      before = residual;
    }
    EXPECT_LT(before, 1e-4) << "33 x 33";
  }
}

TEST(Correction, InStepsDoesTheSame) {
  const MachineParameters head = test::twoMirror();
  const double half = head.field_max_mm[0];
  const Axes plain(head, {});
  const std::string text = csv(kSteps, half, 33, [&](const Vector2d& p) {
    return Vector2d(plain.stepsAt(aimFor(p, half)) - plain.stepsAt(p));
  });
  EXPECT_LT(residualMm(with(head, text), half), 1e-4);
  EXPECT_EQ(jobIssues(with(head, text), test::mirrorJob()), std::vector<std::string>{});
}

TEST(Correction, AnAsymmetricTableTellsAxesOrderAndSign) {
  // +0.3 mm of aim where x > 0, +0.1 mm in y where y > 0: nothing else may come out.
  const auto table = CorrectionTable::parse(
      csv(kMm, 100, 5, [](const Vector2d& p) { return Vector2d(p.x() > 0 ? 0.3 : 0, p.y() > 0 ? 0.1 : 0); }),
      "t.csv");
  EXPECT_EQ(table.at({100, -100}).d, Vector2d(0.3, 0.0));
  EXPECT_EQ(table.at({-100, 100}).d, Vector2d(0.0, 0.1));
  MachineParameters machine = test::gantry();
  for (int i = 0; i < 2; ++i) machine.field_min_mm[i] = -100, machine.field_max_mm[i] = 100;
  machine = with(machine, csv(kMm, 100, 5, [](const Vector2d&) { return Vector2d(0.25, -0.125); }));
  EXPECT_TRUE(Axes(machine, {}).stepsAt({10, 20}).isApprox(Vector2d(10.25, 19.875) / machine.gantry_step_mm));
  EXPECT_EQ(Axes(machine, {.no_pincushion = true}).stepsAt({10, 20}),
            Vector2d(10, 20) / machine.gantry_step_mm);
}

TEST(Correction, ZerosChangeNothing) {
  const MachineParameters head = test::twoMirror();
  const MachineParameters machine =
      with(head, csv(kMm, 80, 9, [](const Vector2d&) { return Vector2d(0, 0); }));
  EXPECT_EQ(planner::plan(test::label(), machine, test::mirrorJob()).program.ops,
            planner::plan(test::label(), head, test::mirrorJob()).program.ops);
}

TEST(Correction, SlopesAreThoseOfTheSteps) {
  for (const MachineParameters& head : {test::twoMirror(), fTheta()}) {
    const double half = head.field_max_mm[0];
    for (const char* header : {kMm, kSteps}) {
      const double scale = header == kMm ? 1.0 : 40.0;
      const Axes axes(
          with(head, csv(header, half, 9,
                         [&](const Vector2d& p) { return Vector2d(scale * (aimFor(p, half) - p)); })),
          {});
      std::mt19937 random(9);
      for (int i = 0; i < 200; ++i) {
        const Vector2d p(double(random() % 2000) / 1000.0 * half - half + 0.0005 * half,
                         double(random() % 2000) / 1000.0 * half - half + 0.0005 * half);
        constexpr double kH = 1e-4;
        Eigen::Matrix2d seen;
        seen.col(0) = (axes.stepsAt(p + Vector2d(kH, 0)) - axes.stepsAt(p - Vector2d(kH, 0))) / (2 * kH);
        seen.col(1) = (axes.stepsAt(p + Vector2d(0, kH)) - axes.stepsAt(p - Vector2d(0, kH))) / (2 * kH);
        EXPECT_LT((axes.stepsPerMm(p) - seen).norm(), 1e-3 * seen.norm()) << p.transpose();
        EXPECT_EQ(axes.xStepsPerMm(p), axes.stepsPerMm(p)(0, 0));
      }
    }
  }
}

TEST(Correction, TheMachineWakesWhereItsTableWantsNoSteps) {
  for (const MachineParameters& head : {test::twoMirror(), fTheta()}) {
    const double half = head.field_max_mm[0];
    EXPECT_EQ(Axes(head, {}).wakesAt(), Vector2d::Zero());
    for (const Vector2d& off :
         {Vector2d(0.0, 0.0), Vector2d(1.25, -0.5), Vector2d(-0.01 * half, 0.03 * half)}) {
      const auto correction = [&](const Vector2d& p) { return Vector2d(aimFor(p, half) + off - p); };
      const Axes axes(with(head, csv(kMm, half, 33, correction)), {});
      const Vector2d place = axes.wakesAt();
      EXPECT_LT(axes.stepsAt(place).cwiseAbs().maxCoeff(), 1e-3);
      EXPECT_LT((place - distorted(-off, half)).norm(), 1e-3) << off.transpose();
    }
  }
}

TEST(Correction, TheBeamIsWhereItsStepsPutIt) {
  MachineParameters gantry = test::twoMirror();
  gantry.head = MachineParameters::Head::kGantry;
  gantry.gantry_step_mm = 0.0125;
  for (const MachineParameters& head : {test::twoMirror(), fTheta(), gantry}) {
    const double half = head.field_max_mm[0];
    const auto bowed = [&](const Vector2d& p) { return Vector2d(aimFor(p, half) - p); };
    for (const Axes& axes : {Axes(head, {}), Axes(with(head, csv(kMm, half, 33, bowed)), {})}) {
      for (const double x : {-0.95, -0.2, 0.0, 0.6}) {
        for (const double y : {-0.8, 0.0, 0.9}) {
          const Vector2d p = half * Vector2d(x, y);
          EXPECT_LT((axes.placeAt(axes.stepsAt(p)) - p).norm(), 1e-4) << p.transpose();
        }
      }
    }
  }
}

TEST(Correction, ATableWithoutARestingPlaceIsRefused) {
  const MachineParameters head = test::twoMirror();
  // The mirrors are sent at least 10 mm to the right everywhere: the slope keeps its sign and never meets
  // zero.
  const double half = head.field_max_mm[0];
  const auto never = [&](const Vector2d& p) { return Vector2d(10.0 + std::abs(p.x()) - p.x(), 0.0); };
  try {
    (void)Axes(with(head, csv(kMm, half, 17, never)), {}).wakesAt();
    FAIL() << "there is no such place";
  } catch (const PlanError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("t.csv: no place of the field has its mirrors at rest"));
  }
}

TEST(Correction, NoAxisMakesMoreStepsThanItMay) {
  JobParameters job = test::mirrorJob();
  job.belt_speed_mm_s = 120.0;
  job.mark_speed_mm_s = 5000.0;
  job.jump_speed_mm_s = 5000.0;
  job.acceleration_mm_s2 = 200000.0;
  job.cut_energy_j_per_mm = 0.001;
  const MachineParameters machine = with(
      test::twoMirror(), csv(kMm, 80, 17, [](const Vector2d& p) { return Vector2d(aimFor(p, 80) - p); }));
  const Plan plan = planner::plan(test::label(), machine, job);
  const test::Played played = test::play(plan.program, machine, job);
  int most = 0;
  for (const test::Period& period : played.periods) most = std::max(most, period.largest_steps);
  EXPECT_LE(most, Target::stepBudget(31) + 1);
  EXPECT_GT(most, Target::stepBudget(31) - 4) << "and the budget is used";
}

TEST(Correction, IsUsedByTheWholeJob) {
  JobParameters job = test::mirrorJob();
  job.belt_speed_mm_s = 60.0;
  const double half = 80.0;
  const MachineParameters machine =
      with(test::twoMirror(),
           csv(kMm, half, 17, [&](const Vector2d& p) { return Vector2d(aimFor(p, half) - p); }));
  const Plan plan = planner::plan(test::label(), machine, job);
  // The head, distorted, turns the steps into places: a machine that differs from its data sheet.
  test::Played played = test::play(plan.program, machine, job);
  test::Played raw = played;
  for (test::Period& period : played.periods) {
    for (auto [W, S] :
         {std::pair(&period.from_W_mm, &period.from_S_mm), std::pair(&period.to_W_mm, &period.to_S_mm)}) {
      const Vector2d shift = distorted(*W, half) - *W;
      *S += shift;
    }
  }
  EXPECT_LT(test::worstDeviationMm(played, test::label(), job), 0.015);
  EXPECT_LT(test::worstGapMm(played, test::label(), job, 0), 0.015);
  EXPECT_GT(test::worstDeviationMm(raw, test::label(), job), 0.2);
}

/// Bytes of a program, and of its longest operation.
struct Bytes {
  std::size_t all{}, longest{};
};
Bytes bytesOf(const Program& program) {
  Bytes bytes;
  for (const auto& op : program.ops) {
    bytes.all += op.size();
    bytes.longest = std::max(bytes.longest, op.size());
  }
  return bytes;
}

TEST(Correction, CostsTheControllerNoMemoryAndItsLineNextToNothing) {
  JobParameters job = test::mirrorJob();
  job.belt_speed_mm_s = 30.0;
  job.pitch_mm = 160.0;
  const auto table = [](int nodes) {
    return csv(kMm, 80.0, nodes, [](const Vector2d& p) { return Vector2d(aimFor(p, 80.0) - p); });
  };
  const Plan without = plan(test::carton(), test::twoMirror(), job);
  const Plan with_9 = plan(test::carton(), with(test::twoMirror(), table(9)), job);
  const Plan with_129 = plan(test::carton(), with(test::twoMirror(), table(129)), job);
  // The program is otherwise as before, however large the table; only both mirrors move on every line now.
  EXPECT_LT(bytesOf(with_9.program).all, 1.1 * static_cast<double>(bytesOf(without.program).all));
  EXPECT_NEAR(static_cast<double>(bytesOf(with_129.program).all),
              static_cast<double>(bytesOf(with_9.program).all), 50.0);
  // An operation has op, two axes, power, gain; of the 20 bytes that the line carries in a period.
  EXPECT_EQ(bytesOf(without.program).longest, 6U);
  EXPECT_EQ(bytesOf(with_129.program).longest, 6U);
}

TEST(Correction, WhatFollowingTheBeltLeavesIsTheSlopeOfYAlongX) {
  // The firmware moves the x axis alone, by the gain of the place: y stays where the table has it for the
  // nominal belt.
  const double half = 80.0;
  const Axes axes(with(test::twoMirror(),
                       csv(kMm, half, 33, [&](const Vector2d& p) { return Vector2d(aimFor(p, half) - p); })),
                  {});
  for (const double belt_mm : {-2.0, -0.5, 0.5, 2.0}) {
    for (const Vector2d& p : {Vector2d(0, 0), Vector2d(60, 70), Vector2d(-70, 40), Vector2d(30, -75)}) {
      const Vector2d made = axes.stepsAt(p) + Vector2d(axes.xStepsPerMm(p) * belt_mm, 0.0);
      Vector2d reached = p + Vector2d(belt_mm, 0.0);
      for (int i = 0; i < 10; ++i)
        reached += axes.stepsPerMm(reached).inverse() * (made - axes.stepsAt(reached));
      const Eigen::Matrix2d slopes = axes.stepsPerMm(p);
      const Vector2d left = reached - p - Vector2d(belt_mm, 0.0);
      // The remainder is 3 µm for a shear of 3 mrad and a millimetre of belt; along x the curvature leaves
      // 0.3 µm for the first millimetre.
      EXPECT_NEAR(left.y(), -slopes(1, 0) / slopes(1, 1) * belt_mm, 0.001 * belt_mm * belt_mm);
      EXPECT_NEAR(left.x(), 0.0, 0.001 * belt_mm * belt_mm + 2e-4 * std::abs(belt_mm));
    }
  }
}

TEST(Correction, FaultsOfTheFileAreListedWithTheirLines) {
  const std::string head = std::string(kMm) + "\n";
  EXPECT_THAT(faultsIn(""), HasSubstr("no header"));
  EXPECT_THAT(faultsIn("x,y,dx,dy\n"), HasSubstr("t.csv:1: the header must be"));
  EXPECT_THAT(faultsIn(head + "0,0,nan,0\n0,1,0\n0,1,0,0,0\n0,x,0,0\n1e300,0,0,0\n0,0,inf,1e9\n"),
              AllOf(HasSubstr("t.csv:2: 'nan'"), HasSubstr("t.csv:3: a node has 4 numbers, this line has 3"),
                    HasSubstr("t.csv:4: a node has 4"), HasSubstr("t.csv:5: 'x'"),
                    HasSubstr("t.csv:6: 1e+300 is out"), HasSubstr("t.csv:7: 'inf'")));
  const std::string good = csv(kMm, 10, 3, [](const Vector2d&) { return Vector2d(0, 0); });
  EXPECT_EQ(faultsIn(good), "");
  EXPECT_THAT(faultsIn(good.substr(0, good.size() - 10)), HasSubstr("the last row has 2 of 3 nodes"));
  EXPECT_THAT(faultsIn(good + "-10,5,0,0\n0,5,0,0\n10,5,0,0\n"),
              HasSubstr("t.csv:12: y must ascend from row to row: 5 after 10"));
  EXPECT_THAT(faultsIn(head + "0,0,0,0\n0,0,0,0\n"), HasSubstr("x must ascend"));
  EXPECT_THAT(faultsIn(head + "0,0,0,0\n1,0,0,0\n0,1,0,0\n2,1,0,0\n"),
              HasSubstr("t.csv:5: the grid wants the node (1, 1)"));
  EXPECT_THAT(faultsIn(head + "0,0,0,0\n1,0,0,0\n0,1,0,0\n1,1,0,0\n"), HasSubstr("3 x 3"));
  std::string many = head;
  for (int i = 0; i < 1000; ++i) many += "a,b,c,d\n";
  EXPECT_THAT(faultsIn(many), HasSubstr("and 980 more"));
}

TEST(Correction, TablesThatTheMachineCannotUseAreRefused) {
  const JobParameters job = test::mirrorJob();
  const auto faults = [&](double half, int nodes, const Field& value) {
    return jobIssues(with(test::twoMirror(), csv(kMm, half, nodes, value)), job);
  };
  EXPECT_THAT(faults(79, 9, [](const Vector2d&) { return Vector2d(0, 0); }),
              Contains(HasSubstr("t.csv: covers x -79 … 79, y -79 … 79 mm; the field is x -80 … 80")));
  EXPECT_THAT(faults(80, 9, [](const Vector2d& p) { return Vector2d(0.4 * std::sin(p.x() / 6), 0); }),
              Contains(HasSubstr("too coarse")));
  EXPECT_THAT(faults(80, 9, [](const Vector2d& p) { return Vector2d(-1.1 * p.x(), 0); }),
              Contains(HasSubstr("not monotonic")));
  EXPECT_THAT(faults(80, 9, [](const Vector2d& p) { return Vector2d(1.5 * p.y(), 1.5 * p.x()); }),
              Contains(HasSubstr("not monotonic")));
  EXPECT_TRUE(faults(80, 9, [](const Vector2d& p) { return Vector2d(-0.02 * p.x(), 0.01 * p.x()); }).empty());
}

}  // namespace
}  // namespace kerfbench::planner
