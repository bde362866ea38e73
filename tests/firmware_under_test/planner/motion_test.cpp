// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/geometry/flatten.h"
#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/motion/speed.h"
#include "firmware_under_test/planner/motion/unit.h"
#include "hil/dieline/geometry.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

double worstMm(const dieline::Curve& curve, const std::vector<Segment>& path) {
  double worst = 0.0;
  for (const Segment& segment : path) {
    for (int i = 0; i <= 40; ++i) {
      const Vector2d p = segment.at(segment.lengthMm() * i / 40);
      worst = std::max(worst, dieline::nearestOn(curve, p).distance_mm);
    }
  }
  return worst;
}

TEST(Flatten, CurvesBecomeArcsWithinTwoMicrometres) {
  const std::vector<dieline::Curve> curves{
      dieline::EllipseCurve{{-30, 4}, {25, 5}, {-2, 10}, 0.3, 2.0 * std::numbers::pi},
      dieline::EllipseCurve{{0, 0}, {60, 0}, {0, 1}, 1.0, -3.0},
      dieline::BezierCurve{(Eigen::Matrix<double, 2, 4>() << 0, 40, -40, 0, 0, 30, 30, 0).finished(),
                           Eigen::Vector4d::Ones()},
      dieline::BezierCurve{(Eigen::Matrix<double, 2, 4>() << 0, 10, 20, 30, 0, 20, -20, 5).finished(),
                           Eigen::Vector4d(1, 0.4, 3, 1)},
      dieline::BezierCurve{(Eigen::Matrix<double, 2, 4>() << 0, 10, 20, 30, 0, 5, 10, 15).finished(),
                           Eigen::Vector4d::Ones()},
  };
  for (const dieline::Curve& curve : curves) {
    const std::vector<Segment> path = flatten(curve, 0.002);
    EXPECT_LT(worstMm(curve, path), 0.002);
    EXPECT_LT((path.front().start_mm - dieline::pointAt(curve, 0)).norm(), 1e-9);
    EXPECT_LT((path.back().end_mm - dieline::pointAt(curve, 1)).norm(), 1e-9);
    double length = 0.0;
    for (std::size_t i = 0; i < path.size(); ++i) {
      length += path[i].lengthMm();
      if (i == 0) continue;
      EXPECT_LT((path[i].start_mm - path[i - 1].end_mm).norm(), 1e-9);
      EXPECT_LT(turnRad(path[i - 1], path[i]), kTangentRad);
    }
    EXPECT_NEAR(length, dieline::lengthOf(curve), 1e-4 * length);
    EXPECT_LT(path.size(), 250U);
  }
}

SpeedLimits limits(double speed, double acceleration) {
  return {speed, acceleration, 0.8e-3, [](const Vector2d&) { return 1e9; }};
}

Segment straight(Vector2d from, Vector2d to) {
  Segment segment;
  segment.start_mm = from;
  segment.end_mm = to;
  return segment;
}

TEST(Speed, ALineTakesTheTimeOfItsTrapezoid) {
  const std::vector<Segment> run{straight({0, 0}, {100, 0})};
  // 100 mm at 200 mm/s and 2000 mm/s²: 0.1 s up, 0.4 s level, 0.1 s down.
  EXPECT_EQ(planRun(run, limits(200, 2000)).size() - 1, static_cast<std::size_t>(std::lround(0.6 / 0.8e-3)));
  // The run is too short for full speed: 2 sqrt(l / a), rounded up to a period.
  const std::vector<Segment> short_run{straight({0, 0}, {1, 0})};
  EXPECT_EQ(planRun(short_run, limits(200, 2000)).size() - 1,
            static_cast<std::size_t>(std::ceil(2.0 * std::sqrt(1.0 / 2000.0) / 0.8e-3)));
}

/// Largest acceleration and speed of a path sampled at period ends, from its differences.
std::pair<double, double> measured(const std::vector<Vector2d>& points) {
  double speed = 0.0;
  double acceleration = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    speed = std::max(speed, (points[i] - points[i - 1]).norm() / 0.8e-3);
    if (i + 1 < points.size()) {
      acceleration = std::max(acceleration,
                              (points[i + 1] - 2.0 * points[i] + points[i - 1]).norm() / (0.8e-3 * 0.8e-3));
    }
  }
  return {speed, acceleration};
}

TEST(Speed, NoSampleBreaksSpeedOrAcceleration) {
  for (const bool gantry : {false, true}) {
    const MachineParameters machine = gantry ? test::gantry() : test::twoMirror();
    const JobParameters job = gantry ? test::gantryJob() : test::mirrorJob();
    const Axes axes(machine, {});
    for (const dieline::Dieline& dieline : {test::label(), test::carton()}) {
      for (const double belt : {0.0, 150.0}) {
        const auto unit = planUnit(readGcode(makeGcode(dieline, machine, job)), job, axes, belt);
        ASSERT_TRUE(unit);
        std::vector<Vector2d> points{unit->start_S_mm, unit->start_S_mm};
        for (const Block& block : unit->blocks) {
          for (const Sample& sample : block.samples) points.push_back(sample.p_S_mm);
        }
        const auto [speed, acceleration] = measured(points);
        EXPECT_LE(speed, job.jump_speed_mm_s * 1.001);
        // A joint that the fourth decimal bends turns within one period; hence 10 %.
        EXPECT_LE(acceleration, job.acceleration_mm_s2 * 1.1);
        EXPECT_GE(acceleration, job.acceleration_mm_s2 * 0.5) << "the machine should be used";
      }
    }
  }
}

TEST(Speed, ASmoothOutlineIsRunThroughAndARightAngleNearlyStops) {
  const JobParameters job = test::mirrorJob();
  const Axes axes(test::twoMirror(), {});
  const auto slowest = [&](const std::string& gcode) {
    const auto unit = planUnit(readGcode(gcode), job, axes, 0.0);
    double least = 1e9;
    const auto& samples = unit->blocks[0].samples;
    for (std::size_t i = samples.size() / 4; i < samples.size() * 3 / 4; ++i)
      least = std::min(least, samples[i].marked_mm);
    return least / 0.8e-3;
  };
  EXPECT_GT(slowest(makeGcode(test::label(), test::twoMirror(), job)), 200.0);
  // A right angle is passed at 3.3 mm/s, and a period on at 16 mm/s more.
  EXPECT_LT(slowest("G00 X0 Y0\nG01 X20 Y0 Z1\nG01 X20 Y20\n"), 12.0);
}

TEST(AxisMove, ArrivesAtRestWithinItsLimits) {
  for (const double v0 : {0.0, 200.0, -150.0, 500.0}) {
    for (const double x1 : {-700.0, -3.0, 0.0, 2.0, 8.0, 30.0, 400.0}) {
      const AxisMove move(0.0, v0, x1, 400.0, 2500.0);
      EXPECT_NEAR(move.at(0.0), 0.0, 1e-12);
      EXPECT_NEAR(move.at(move.durationS() - 1e-12), x1, 1e-6);
      constexpr double kDt = 1e-4;
      double before = v0;
      for (double t = 0.0; t < move.durationS() + 5 * kDt; t += kDt) {
        const double v = (move.at(t + kDt) - move.at(t)) / kDt;
        EXPECT_LE(std::abs(v), std::max(400.0, std::abs(v0)) + 1e-6);
        EXPECT_LE(std::abs(v - before), 2500.0 * kDt * 1.01 + 1e-6)
            << "v0 " << v0 << " x1 " << x1 << " t " << t;
        before = v;
      }
    }
  }
}

TEST(CatchUp, BeginsAtRestAndEndsWithTheBelt) {
  const int periods = catchUpPeriods(200.0, 2500.0, 0.8e-3);
  const double total_s = periods * 0.8e-3;
  const auto x = [&](double t) { return catchUpMm(t / total_s, 200.0, periods, 0.8e-3); };
  EXPECT_NEAR(x(total_s), 0.5 * 200.0 * total_s, 1e-9);
  EXPECT_NEAR((x(1e-6) - x(0)) / 1e-6, 0.0, 1e-3);
  EXPECT_NEAR((x(total_s) - x(total_s - 1e-6)) / 1e-6, 200.0, 1e-3);
  for (double t = 1e-3; t < total_s - 1e-3; t += 1e-3) {
    EXPECT_LE(std::abs(x(t + 1e-3) - 2 * x(t) + x(t - 1e-3)) / 1e-6, 2500.0 * 1.001);
  }
}

TEST(Axes, SpeedLimitHoldsEverywhereInTheField) {
  const MachineParameters machine = test::twoMirror();
  const Axes axes(machine, {});
  for (const double belt : {0.0, 200.0, 400.0}) {
    for (double angle = 0.0; angle < 6.28; angle += 0.1) {
      const Vector2d u(std::cos(angle), std::sin(angle));
      const double s = axes.speedLimit(u, belt);
      const Vector2d v = s * u + Vector2d(belt, 0.0);
      double largest = 0.0;
      for (double x = -79.0; x <= 79.0; x += 15.8) {
        for (double y = -79.0; y <= 79.0; y += 15.8) {
          const Vector2d p(x, y);
          largest = std::max(largest, (axes.stepsAt(p + v * 0.8e-3) - axes.stepsAt(p)).cwiseAbs().maxCoeff());
        }
      }
      EXPECT_LE(largest, Target::stepBudget(31) + 0.05);
      EXPECT_GE(largest, Target::stepBudget(31) * 0.93) << "the bound should not waste speed";
    }
  }
  EXPECT_EQ(axes.speedLimit(Vector2d::UnitX(), 500.0), 0.0);
}

TEST(Axes, GainIsTheDerivative) {
  const Axes axes(test::twoMirror(), {});
  for (const Vector2d& p : {Vector2d(0, 0), Vector2d(70, -60), Vector2d(-75, 20)}) {
    const double numeric =
        (axes.stepsAt(p + Vector2d(1e-4, 0)).x() - axes.stepsAt(p - Vector2d(1e-4, 0)).x()) / 2e-4;
    EXPECT_NEAR(axes.xStepsPerMm(p), numeric, 1e-5 * numeric);
  }
}

}  // namespace
}  // namespace kerfbench::planner
