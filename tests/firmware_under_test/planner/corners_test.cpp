// SPDX-License-Identifier: Apache-2.0
// Corners of marks: how fast they are passed, how far the beam misses them, and that no angle is a cliff.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/motion/rounding.h"
#include "firmware_under_test/planner/motion/unit.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

constexpr double kPeriod_s = 0.8e-3;
constexpr double kRadiusMm = 20.0;

std::vector<Segment> polyline(const std::vector<Vector2d>& corners) {
  std::vector<Segment> path;
  for (std::size_t i = 1; i < corners.size(); ++i) {
    Segment segment;
    segment.start_mm = corners[i - 1];
    segment.end_mm = corners[i];
    segment.z = 1.0;
    path.push_back(segment);
  }
  return path;
}

std::vector<Segment> polygon(int corners) {
  std::vector<Vector2d> points;
  for (int i = 0; i <= corners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / corners;
    points.emplace_back(kRadiusMm * std::cos(angle), kRadiusMm * std::sin(angle));
  }
  return polyline(points);
}

/// Lines of one length that turn by the same angle, to the left and to the right in turn.
std::vector<Segment> zigzag(double turn_rad, int lines, double length_mm) {
  std::vector<Vector2d> points{{0.0, 0.0}};
  for (int i = 0; i < lines; ++i) {
    const double heading = i % 2 == 0 ? 0.0 : turn_rad;
    points.emplace_back(points.back() + length_mm * Vector2d(std::cos(heading), std::sin(heading)));
  }
  return polyline(points);
}

MachineParameters wide() {
  MachineParameters machine = test::twoMirror();
  for (int i = 0; i < 2; ++i) {
    machine.field_min_mm[i] = -80.0;
    machine.field_max_mm[i] = 80.0;
  }
  return machine;
}

std::vector<Vector2d> samplesOf(const std::vector<Segment>& path, const MachineParameters& machine,
                                const JobParameters& job) {
  const auto unit = planUnit(path, job, Axes(machine, {}), 0.0);
  std::vector<Vector2d> points;
  if (!unit) return points;
  points.push_back(unit->start_S_mm);
  for (const Block& block : unit->blocks) {
    for (const Sample& sample : block.samples) points.push_back(sample.p_S_mm);
  }
  return points;
}

std::size_t periodsOf(const std::vector<Segment>& path, const JobParameters& job) {
  return samplesOf(path, wide(), job).size() - 1;
}

double distanceTo(const Vector2d& from, const Vector2d& to, const Vector2d& p) {
  const Vector2d along = to - from;
  const double share = std::clamp((p - from).dot(along) / std::max(along.squaredNorm(), 1e-30), 0.0, 1.0);
  return (p - from - share * along).norm();
}

/// Way of the beam behind critically damped drives of this delay, which get even steps between the ends of
/// periods: x'' = w² (u - x) - 2 w x', w = 2 / delay, in steps of a fiftieth of a period.
std::vector<Vector2d> behindDrives(const std::vector<Vector2d>& commands, double delay_s) {
  constexpr int kSteps = 50;
  const double w = 2.0 / delay_s;
  const double dt = kPeriod_s / kSteps;
  Vector2d x = commands.front();
  Vector2d v = Vector2d::Zero();
  std::vector<Vector2d> way{x};
  for (std::size_t k = 1; k < commands.size() + 20; ++k) {
    const Vector2d from = commands[std::min(k - 1, commands.size() - 1)];
    const Vector2d to = commands[std::min(k, commands.size() - 1)];
    for (int i = 0; i < kSteps; ++i) {
      const Vector2d u = from + (to - from) * ((i + 0.5) / kSteps);
      const Vector2d a = w * w * (u - x) - 2.0 * w * v;
      x += dt * (v + 0.5 * dt * a);
      v += dt * a;
      way.push_back(x);
    }
  }
  return way;
}

/// How far the way misses the lines, and how far it misses their corners.
double missMm(const std::vector<Segment>& lines, const std::vector<Vector2d>& way) {
  double worst = 0.0;
  for (std::size_t k = 0; k < way.size(); k += 5) {
    double least = 1e300;
    for (const Segment& line : lines) least = std::min(least, distanceTo(line.start_mm, line.end_mm, way[k]));
    worst = std::max(worst, least);
  }
  for (std::size_t i = 1; i < lines.size(); ++i) {
    double least = 1e300;
    for (std::size_t k = 1; k < way.size(); ++k)
      least = std::min(least, distanceTo(way[k - 1], way[k], lines[i].start_mm));
    worst = std::max(worst, least);
  }
  return worst;
}

TEST(TurnSpeed, FallsSteadilyFromNoLimitToAStop) {
  for (const CornerLimits corners :
       {CornerLimits{}, CornerLimits{0.005, 0.19e-3}, CornerLimits{0.02, 2e-3}}) {
    double before = turnSpeed(0.0, 5000.0, kPeriod_s, corners);
    EXPECT_TRUE(std::isinf(before));
    constexpr int kParts = 20000;
    for (int i = 1; i <= kParts; ++i) {
      const double turn = std::numbers::pi * i / kParts;
      const double now = turnSpeed(turn, 5000.0, kPeriod_s, corners);
      EXPECT_LE(now, before);
      if (i > 100) EXPECT_GT(now, before * (1.0 - 2.0 / i) - 0.01) << "a step at " << turn;
      before = now;
    }
    EXPECT_NEAR(before, 0.0, 1e-9);
  }
  // For small turns it is a T / turn: 66 mm/s at 0.0606 rad, 5000 mm/s² and 0.8 ms, less half of a T for the
  // braking.
  EXPECT_NEAR(turnSpeed(0.0606, 5000.0, kPeriod_s, {}), 66.0 - 2.0, 0.1);
}

TEST(Corners, TheTimeOfALineGrowsSteadilyWithItsTurns) {
  const JobParameters job = test::mirrorJob();
  for (const double error_mm : {0.0, 0.005, 0.02}) {
    JobParameters each = job;
    each.corner_error_mm = error_mm;
    constexpr int kLines = 12;
    const std::size_t straight = periodsOf(zigzag(0.0, kLines, 4.0), each);
    std::size_t before = straight;
    for (int i = 1; i <= 157; ++i) {
      const double turn = 0.02 * i;
      const std::size_t now = periodsOf(zigzag(turn, kLines, 4.0), each);
      // A rounded corner is shorter by its error, and some directions let the mirrors go faster: a period in
      // all. A hundredth of a turn costs at most three periods at each joint.
      EXPECT_GE(now + 1, before) << turn << " " << error_mm;
      EXPECT_LE(now, before + 3 * (kLines - 1)) << turn << " " << error_mm;
      before = now;
    }
    EXPECT_GT(before, straight + straight / 2) << "turning back costs";
  }
}

/// Time of the circle as a polygon: 1.80 s for 125 corners and 0.495 for 126 where joints above 0.05 rad were
/// stops.
TEST(Corners, APolygonOfManyCornersIsAsFastAsItsCircle) {
  const JobParameters job = test::mirrorJob();
  const double arc_s =
      kPeriod_s * static_cast<double>(periodsOf(readGcode("G00 X20 Y0\nG03 X20 Y0 I-20 J0 Z1\n"), job));
  std::vector<double> times{0.0, 0.0, 0.0};
  for (int n = 3; n <= 500; n += n < 200 ? 1 : 10) {
    const double now_s = kPeriod_s * static_cast<double>(periodsOf(polygon(n), job));
    if (n < 200) {
      // A corner more costs what a corner does, and the way grows by less than 2 pi² r / n³.
      if (n > 3) EXPECT_NEAR(now_s, times.back(), n < 12 ? 0.05 : 0.012) << n;
      times.push_back(now_s);
    }
    EXPECT_LT(now_s, 1.5 * arc_s) << n;
    if (n >= 80) EXPECT_NEAR(now_s, arc_s, 0.03 * arc_s) << n;
  }
  const auto slowest = static_cast<std::size_t>(std::max_element(times.begin(), times.end()) - times.begin());
  for (std::size_t n = 4; n < times.size(); ++n) {
    if (n <= slowest) EXPECT_GE(times[n], times[n - 1] - kPeriod_s) << n;
    if (n > slowest) EXPECT_LE(times[n], times[n - 1] + kPeriod_s) << n;
  }
  RecordProperty("slowest_corners", std::to_string(slowest));
  RecordProperty("slowest_s", fmt::format("{:.4f}", times[slowest]));
  RecordProperty("arc_s", fmt::format("{:.4f}", arc_s));
}

struct Drive {
  double delay_s, acceleration_mm_s2, error_mm;
};

class BehindDrives : public ::testing::TestWithParam<Drive> {};

/// Second method: the samples through the equation of motion of a drive, and the distance of that way from
/// the lines.
TEST_P(BehindDrives, TheBeamMissesNoCornerByMoreThanStated) {
  const Drive drive = GetParam();
  MachineParameters machine = wide();
  machine.tracking_delay_s = drive.delay_s;
  JobParameters job = test::mirrorJob();
  job.acceleration_mm_s2 = drive.acceleration_mm_s2;
  job.corner_error_mm = drive.error_mm;
  double worst_mm = 0.0;
  std::vector<std::vector<Segment>> shapes;
  for (const int n : {3, 4, 5, 8, 13, 24, 40, 60, 100, 140}) shapes.push_back(polygon(n));
  for (const double turn : {0.03, 0.07, 0.2, 0.5, 1.0, 1.4, 2.0, 3.0}) {
    for (const double length_mm : {0.7, 4.0}) shapes.push_back(zigzag(turn, 9, length_mm));
  }
  for (const std::vector<Segment>& shape : shapes) {
    const double miss_mm = missMm(shape, behindDrives(samplesOf(shape, machine, job), drive.delay_s));
    EXPECT_LE(miss_mm, drive.error_mm * 1.01) << shape.size();
    worst_mm = std::max(worst_mm, miss_mm);
  }
  EXPECT_GT(worst_mm, 0.6 * drive.error_mm) << "the error that is allowed should be used";
  RecordProperty("worst_mm", fmt::format("{:.5f}", worst_mm));
}

INSTANTIATE_TEST_SUITE_P(DelaysAndErrors, BehindDrives,
                         ::testing::Values(Drive{0.19e-3, 20000.0, 0.005}, Drive{0.19e-3, 20000.0, 0.02},
                                           Drive{0.6e-3, 5000.0, 0.005}, Drive{1.2e-3, 9000.0, 0.02}));

TEST(Corners, DrivesKeepTheirAccelerationThroughThem) {
  JobParameters job = test::mirrorJob();
  for (const double radius_mm : {0.0, 5.0}) {
    job.jump_radius_mm = radius_mm;
    for (const double turn : {0.02, 0.06, 0.15, 0.4, 1.0, 1.57, 2.5, 3.1}) {
      std::vector<Vector2d> points = samplesOf(zigzag(turn, 9, 3.0), wide(), job);
      points.insert(points.begin(), points.front());
      points.push_back(points.back());
      double most = 0.0;
      for (std::size_t i = 1; i + 1 < points.size(); ++i) {
        most = std::max(most, (points[i + 1] - 2.0 * points[i] + points[i - 1]).norm());
      }
      EXPECT_LE(most / (kPeriod_s * kPeriod_s), 1.027 * job.acceleration_mm_s2) << turn << " " << radius_mm;
    }
  }
}

TEST(Corners, ARightAngleStaysSharp) {
  const JobParameters job = test::mirrorJob();
  const std::vector<Segment> path = polyline({{0, 0}, {30, 0}, {30, 30}});
  const std::vector<Vector2d> points = samplesOf(path, wide(), job);
  EXPECT_LT(missMm(path, behindDrives(points, 0.19e-3)), 0.0015);
  double slowest_mm_s = 1e9;
  for (std::size_t i = points.size() / 4; i < points.size() * 3 / 4; ++i)
    slowest_mm_s = std::min(slowest_mm_s, (points[i] - points[i - 1]).norm() / kPeriod_s);
  EXPECT_LT(slowest_mm_s, 12.0) << "a stop but for a period's braking";
}

FlowLimits plainLimits(double error_mm) {
  FlowLimits limits;
  limits.mark_mm_s = limits.jump_mm_s = 300.0;
  limits.acceleration_mm_s2 = limits.jump_acceleration_mm_s2 = 20000.0;
  limits.period_s = kPeriod_s;
  limits.axes_mm_s = [](const Vector2d&) { return 1e9; };
  limits.corners = {error_mm, 0.19e-3};
  return limits;
}

/// Corner of two legs, of which each may be bent: from 5 mm left of the origin into it, and on.
std::vector<Segment> corner(double turn_rad, double bend_in_1_mm, double bend_out_1_mm) {
  const auto leg = [](double heading, double bend_1_mm) {
    constexpr double kLengthMm = 5.0;
    Segment segment;
    const Vector2d along(std::cos(heading), std::sin(heading));
    const Vector2d left(-along.y(), along.x());
    segment.z = 1.0;
    segment.end_mm = kLengthMm * along;
    if (bend_1_mm == 0.0) return segment;
    segment.sweep_rad = kLengthMm * bend_1_mm;
    segment.centre_mm = left / bend_1_mm;
    segment.end_mm = segment.centre_mm +
                     (std::sin(segment.sweep_rad) * along - std::cos(segment.sweep_rad) * left) / bend_1_mm;
    return segment;
  };
  return {leg(std::numbers::pi, -bend_in_1_mm).reversed(), leg(turn_rad, bend_out_1_mm)};
}

TEST(Corners, RoundedOnesAreTangentAndWithinTheirErrorWhateverTheLegs) {
  for (const double turn : {0.06, 0.2, 0.7, -0.06, -0.4, -0.8}) {
    for (const double in : {0.0, 0.08, -0.2}) {
      for (const double out : {0.0, 0.3, -0.1}) {
        const std::vector<Segment> legs = corner(turn, in, out);
        const std::vector<Segment> path = roundedCorners(legs, plainLimits(0.01));
        ASSERT_EQ(path.size(), 4U) << turn << " " << in << " " << out;
        EXPECT_LT((path.front().start_mm - legs.front().start_mm).norm(), 1e-12);
        EXPECT_LT((path.back().end_mm - legs.back().end_mm).norm(), 1e-12);
        double nearest_mm = 1e9;
        for (std::size_t i = 0; i < path.size(); ++i) {
          if (i > 0) {
            EXPECT_LT((path[i].start_mm - path[i - 1].end_mm).norm(), 1e-9);
            EXPECT_LT(turnRad(path[i - 1], path[i]), 1e-6);
          }
          for (int k = 0; k <= 40; ++k) {
            const Vector2d p = path[i].at(path[i].lengthMm() * k / 40.0);
            double off_mm = 1e9;
            for (const Segment& leg : legs) {
              for (int m = 0; m <= 500; ++m)
                off_mm = std::min(off_mm, (leg.at(leg.lengthMm() * m / 500.0) - p).norm());
            }
            EXPECT_LT(off_mm, 0.0102);
            nearest_mm = std::min(nearest_mm, p.norm());
          }
        }
        EXPECT_LE(nearest_mm, 0.01 * std::cos(turn) + 1e-4);
      }
    }
  }
}

TEST(Corners, OnlyThoseOfOneCutAreRounded) {
  std::vector<Segment> path = polyline({{0, 0}, {5, 0}, {10, 1}, {15, 0}});
  path[1].z = 0.5;
  EXPECT_EQ(roundedCorners(path, plainLimits(0.01)).size(), 3U) << "where the laser changes";
  path[1].z = 1.0;
  EXPECT_EQ(roundedCorners(path, plainLimits(0.0)).size(), 3U) << "where no error is stated";
  EXPECT_EQ(roundedCorners(path, plainLimits(0.01)).size(), 7U);
  const std::vector<Segment> square = polyline({{0, 0}, {5, 0}, {5, 5}, {0, 5}});
  EXPECT_EQ(roundedCorners(square, plainLimits(0.01)).size(), 3U) << "right angles";
}

}  // namespace
}  // namespace kerfbench::planner
