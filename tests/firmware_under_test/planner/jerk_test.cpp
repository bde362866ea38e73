// SPDX-License-Identifier: Apache-2.0
// Jerk-limited speed planning: on the sheet and in the mirrors' own angles.
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/motion/jerk_profile.h"
#include "firmware_under_test/planner/motion/speed.h"
#include "firmware_under_test/planner/motion/unit.h"
#include "hil/dieline/geometry.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

constexpr double kJerkPeriod_s = 0.8e-3;

SpeedLimits limits(double speed, double acceleration, double jerk) {
  return {speed, acceleration, kJerkPeriod_s, [](const Vector2d&) { return 1e9; }, jerk};
}

Segment straight(Vector2d from, Vector2d to) {
  Segment segment;
  segment.start_mm = from;
  segment.end_mm = to;
  return segment;
}

/// Largest third difference over the period's cube, with rests before and after.
double jerkOf(std::vector<Vector2d> points) {
  points.insert(points.begin(), 3, points.front());
  points.insert(points.end(), 3, points.back());
  double most = 0.0;
  for (std::size_t i = 3; i < points.size(); ++i) {
    const Vector2d third = points[i] - 3.0 * points[i - 1] + 3.0 * points[i - 2] - points[i - 3];
    most = std::max(most, third.norm() / (kJerkPeriod_s * kJerkPeriod_s * kJerkPeriod_s));
  }
  return most;
}

std::vector<Vector2d> pointsOf(const UnitPath& unit) {
  std::vector<Vector2d> points{unit.start_S_mm};
  for (const Block& block : unit.blocks) {
    for (const Sample& sample : block.samples) points.push_back(sample.p_S_mm);
  }
  return points;
}

TEST(Jerk, ALineTakesTheTimeOfItsSCurve) {
  const std::vector<Segment> run{straight({0, 0}, {100, 0})};
  // Each ramp takes v/a + a/j, over half of the length each; of the jerk a line has 0.8.
  const double ramp_s = 200.0 / 2000.0 + 2000.0 / (0.8 * 25000.0);
  const double total_s = 2.0 * ramp_s + (100.0 - 200.0 * ramp_s) / 200.0;
  EXPECT_EQ(planRun(run, limits(200, 2000, 25000)).size() - 1,
            static_cast<std::size_t>(std::ceil(total_s / kJerkPeriod_s - 1e-6)));
  // The run is too short for full acceleration: four bows of cbrt(l / (2 j)) each.
  const std::vector<Segment> short_run{straight({0, 0}, {0.1, 0})};
  const double bow_s = std::cbrt(0.1 / (2.0 * 0.8 * 25000.0));
  EXPECT_EQ(planRun(short_run, limits(200, 2000, 25000)).size() - 1,
            static_cast<std::size_t>(std::ceil(4.0 * bow_s / kJerkPeriod_s - 1e-6)));
}

TEST(Jerk, WithoutALimitOrWithAGreatOneItIsTheTrapezoid) {
  const std::vector<Segment> run{straight({0, 0}, {3, 0}), straight({3, 0}, {40, 1})};
  const auto free = planRun(run, limits(200, 2000, 0));
  const auto great = planRun(run, limits(200, 2000, 1e12));
  ASSERT_EQ(free.size(), great.size());
  for (std::size_t i = 0; i < free.size(); ++i) EXPECT_NEAR(free[i], great[i], 0.02);
}

TEST(Jerk, NoSampleOfALineBreaksIt) {
  for (const double jerk : {2e4, 2e5, 5e6}) {
    for (const double length_mm : {0.01, 0.3, 2.0, 17.0, 90.0}) {
      std::vector<Vector2d> points;
      for (const double s :
           planRun(std::vector<Segment>{straight({0, 0}, {length_mm, 0})}, limits(300, 9000, jerk)))
        points.emplace_back(s, 0.0);
      EXPECT_LE(jerkOf(points), 0.8 * jerk * 1.0001) << length_mm;
      EXPECT_GE(jerkOf(points), 0.3 * jerk) << "it should be used " << length_mm;
    }
  }
}

/// Mirror angles by the formula of Cheng, Cui, Zhang 2014, times what makes them millimetres in the middle of
/// the field.
std::vector<Vector2d> inMirrors(const std::vector<Vector2d>& points, const MachineParameters& machine) {
  std::vector<Vector2d> out;
  const double L = machine.throw_mm;
  const double d = machine.mirror_spacing_mm;
  for (const Vector2d& p : points) {
    const double x = 0.5 * std::atan(p.x() / (std::hypot(L, p.y()) + d));
    const double y = 0.5 * std::atan(p.y() / L);
    out.emplace_back(2.0 * (L + d) * x, 2.0 * L * y);
  }
  return out;
}

TEST(Jerk, TheMirrorsKeepItOverWholeDrawings) {
  const MachineParameters machine = test::twoMirror();
  JobParameters job = test::mirrorJob();
  const Axes axes(machine, {});
  for (const dieline::Dieline& dieline : {test::label(), test::carton()}) {
    const std::vector<Segment> gcode = readGcode(makeGcode(dieline, machine, job));
    job.jerk_mm_s3 = 0.0;
    const auto free = planUnit(gcode, job, axes, 0.0);
    for (const double jerk : {1e6, 5e6}) {
      job.jerk_mm_s3 = jerk;
      const auto unit = planUnit(gcode, job, axes, 0.0);
      ASSERT_TRUE(free && unit);
      const double in_mirrors = jerkOf(inMirrors(pointsOf(*unit), machine));
      // Joints that the fourth decimal bends, as in motion_test.
      EXPECT_LE(in_mirrors, 1.1 * jerk);
      EXPECT_GE(in_mirrors, 0.5 * jerk) << "the machine should be used";
      EXPECT_GT(jerkOf(inMirrors(pointsOf(*free), machine)), 4.0 * jerk) << "else this shows nothing";
      EXPECT_GT(pointsOf(*unit).size(), pointsOf(*free).size());
    }
  }
}

/// Short strokes side by side, as the button's, with a corner and an arc in the marks.
std::vector<Segment> strokes() {
  std::vector<dieline::Entity> entities;
  for (int i = 0; i < 8; ++i) {
    const double x = -8.0 * i;
    entities.push_back(i % 2 == 0 ? test::line(x, -6.0, x, 6.0) : test::line(x, 6.0, x + 1.0, -6.0));
  }
  entities.push_back(test::arc(-30.0, 20.0, 6.0, 0.0, 200.0));
  MachineParameters machine = test::twoMirror();
  std::vector<Segment> path = readGcode(makeGcode(test::dielineOf(entities), machine, test::mirrorJob()));
  while (path.front().jump) path.erase(path.begin());
  return path;
}

TEST(Jerk, TheMirrorsKeepItThroughSmoothJumps) {
  MachineParameters machine = test::twoMirror();
  machine.mirror_acceleration_rad_s2 = 9.0;
  const Axes axes(machine, {});
  const std::vector<Segment> path = strokes();
  JobParameters job = test::mirrorJob();
  job.acceleration_mm_s2 = 12000.0;
  for (const double radius_mm : {1.0, 5.0}) {
    job.jump_radius_mm = radius_mm;
    job.jerk_mm_s3 = 0.0;
    const auto free = planUnit(path, job, axes, 0.0);
    for (const double jerk : {1e6, 5e6}) {
      job.jerk_mm_s3 = jerk;
      job.jump_radius_mm = radius_mm;
      const auto unit = planUnit(path, job, axes, 0.0);
      job.jump_radius_mm = 0.0;
      const auto straight = planUnit(path, job, axes, 0.0);
      ASSERT_TRUE(free && unit && straight);
      const double in_mirrors = jerkOf(inMirrors(pointsOf(*unit), machine));
      EXPECT_LE(in_mirrors, 1.1 * jerk) << radius_mm;
      EXPECT_GE(in_mirrors, 0.4 * jerk) << "the machine should be used, radius " << radius_mm;
      EXPECT_GT(jerkOf(inMirrors(pointsOf(*free), machine)), 1.5 * jerk) << "else this shows nothing";
      EXPECT_GE(pointsOf(*unit).size(), pointsOf(*free).size());
      // Whoever wishes arcs gets them, where a stop under so little jerk would be sooner as well.
      EXPECT_LE(5 * pointsOf(*unit).size(), (jerk < 5e6 ? 6U : 5U) * pointsOf(*straight).size());
    }
  }
}

TEST(Jerk, SmoothJumpsStillSwitchAtTheEndsOfMarks) {
  const MachineParameters machine = test::twoMirror();
  const std::vector<Segment> path = strokes();
  JobParameters job = test::mirrorJob();
  job.jump_radius_mm = 5.0;
  job.jerk_mm_s3 = 5e6;
  const auto unit = planUnit(path, job, Axes(machine, {}), 0.0);
  ASSERT_TRUE(unit);
  double wanted_mm = 0.0;
  for (const Segment& segment : path) wanted_mm += segment.jump ? 0.0 : segment.z * segment.lengthMm();
  double marked_mm = 0.0;
  for (const Block& block : unit->blocks) {
    for (const Sample& sample : block.samples) marked_mm += sample.marked_mm;
  }
  EXPECT_NEAR(marked_mm, wanted_mm, 1e-9 * wanted_mm);
}

FlowLimits flowLimits(double jerk) {
  FlowLimits flow;
  flow.mark_mm_s = flow.jump_mm_s = 200.0;
  flow.acceleration_mm_s2 = flow.jump_acceleration_mm_s2 = 5000.0;
  flow.period_s = kJerkPeriod_s;
  flow.axes_mm_s = [](const Vector2d&) { return 1e9; };
  flow.jerk_mm_s3 = jerk;
  return flow;
}

TEST(Jerk, AProfileIsRealisedInAnyTimeBetweenItsBounds) {
  Segment arc = straight({0, 0}, {20, 0});
  arc.centre_mm = {10, 0};
  arc.sweep_rad = -3.14159265358979;
  const std::vector<Segment> run{straight({0, -15}, {0, 0}), arc, straight({20, 0}, {20, -3})};
  const double jerk = 1e6;
  const JerkProfile profile(run, flowLimits(jerk));
  const auto fast_from = profile.fastestFrom(90.0);
  const auto fast_to = profile.fastestTo(30.0);
  const auto slow_from = profile.slowestFrom(90.0);
  const auto slow_to = profile.slowestTo(30.0);
  JerkProfile::Speeds fast, slow;
  for (std::size_t i = 0; i < fast_from.size(); ++i) {
    fast.push_back(std::min(fast_from[i], fast_to[i]));
    slow.push_back(std::max(slow_from[i], slow_to[i]));
  }
  ASSERT_DOUBLE_EQ(fast.front(), 90.0);
  ASSERT_DOUBLE_EQ(fast.back(), 30.0);
  const auto least = static_cast<int>(std::ceil(profile.shortestS(fast) / kJerkPeriod_s));
  for (const int periods : {least, least + 1, least + 7, 2 * least, 5 * least}) {
    ASSERT_TRUE(profile.canTake(slow, periods * kJerkPeriod_s));
    const std::vector<double> s = profile.stations(slow, fast, periods, kJerkPeriod_s);
    ASSERT_EQ(s.size(), static_cast<std::size_t>(periods) + 1);
    EXPECT_NEAR((s[1] - s[0]) / kJerkPeriod_s, 90.0, 1.5) << periods;
    EXPECT_NEAR((s[s.size() - 1] - s[s.size() - 2]) / kJerkPeriod_s, 30.0, 1.5) << periods;
    for (std::size_t i = 3; i < s.size(); ++i) {
      const double third = s[i] - 3.0 * s[i - 1] + 3.0 * s[i - 2] - s[i - 3];
      EXPECT_LE(std::abs(third) / std::pow(kJerkPeriod_s, 3), 0.8 * jerk * 1.001) << periods << " at " << i;
    }
  }
}

TEST(Jerk, AShorterWayIsNoReasonToGoTooFast) {
  // An S-curve to rest is shorter than one to a third of the speed: both must find room.
  const Ramp ramp{5000.0, 1e6};
  for (const double high : {1.0, 30.0, 400.0}) {
    double before_mm = 1e300;
    for (double low = 0.0; low <= high; low += high / 64.0) {
      EXPECT_GE(ramp.mostTravelMm(low, high), ramp.travelMm(low, high));
      EXPECT_LE(ramp.mostTravelMm(low, high), before_mm * (1.0 + 1e-12));
      EXPECT_LE(ramp.mostTravelMm(low, high),
                1.09 * std::max(ramp.travelMm(0.0, high), ramp.travelMm(low, high)));
      before_mm = ramp.mostTravelMm(low, high);
    }
  }
}

}  // namespace
}  // namespace kerfbench::planner
