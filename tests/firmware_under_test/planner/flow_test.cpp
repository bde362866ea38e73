// SPDX-License-Identifier: Apache-2.0
// Motion that runs through marks and jumps (S2): its limits, and the marks that it must not move.
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/head/axes.h"
#include "firmware_under_test/planner/motion/solve.h"
#include "firmware_under_test/planner/motion/unit.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;
constexpr double kMirrorLimit_rad_s2 = 9.0;

MachineParameters slowMirrors() {
  MachineParameters machine = test::twoMirror();
  machine.mirror_acceleration_rad_s2 = kMirrorLimit_rad_s2;
  return machine;
}

JobParameters smoothJob(double radius_mm) {
  JobParameters job = test::mirrorJob();
  job.jump_speed_mm_s = 430.0;
  job.acceleration_mm_s2 = 12000.0;
  job.jump_radius_mm = radius_mm;
  return job;
}

dieline::Dieline button() {
  return dieline::readDieline(std::string(KERFBENCH_SOURCE_DIR) + "/fixtures/dielines/button.dxf",
                              dieline::defaultLayerProfile());
}

/// Strokes of 1 … 6 mm anywhere in 50 x 50 mm.
dieline::Dieline strokes(unsigned seed) {
  std::mt19937 bits(seed);
  std::uniform_real_distribution<double> place(0.0, 50.0);
  std::uniform_real_distribution<double> length(1.0, 6.0);
  std::uniform_real_distribution<double> angle(0.0, 6.2831853);
  std::vector<dieline::Entity> entities;
  for (int i = 0; i < 40; ++i) {
    const Vector2d from(-place(bits), place(bits) - 25.0);
    const double l = length(bits);
    const double a = angle(bits);
    entities.push_back(
        test::line(from.x(), from.y(), from.x() + l * std::cos(a), from.y() + l * std::sin(a)));
  }
  return test::dielineOf(std::move(entities));
}

struct Case {
  const char* name;
  dieline::Dieline dieline;
  double belt_mm_s;
  double radius_mm;
};

std::vector<Case> cases() {
  std::vector<Case> all{{"button", button(), 0.0, 5.0},
                        {"button on the belt", button(), 35.0, 5.0},
                        {"button with small arcs", button(), 0.0, 1.0},
                        {"button by its size", button(), 30.0, kRadiusOfDrawing},
                        {"label", test::label(), 60.0, 5.0},
                        {"carton", test::carton(), 5.0, 5.0}};
  for (unsigned seed = 1; seed <= 6; ++seed)
    all.push_back({"strokes", strokes(seed), seed % 2 == 0 ? 0.0 : 60.0, 0.7 * seed});
  return all;
}

class EveryFlow : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    case_ = cases()[std::size_t(GetParam())];
    job_ = smoothJob(case_.radius_mm);
    machine_ = slowMirrors();
    path_ = readGcode(makeGcode(case_.dieline, machine_, job_));
    while (path_.front().jump) path_.erase(path_.begin());
  }
  UnitPath planned(const JobParameters& job) const {
    const auto unit = planUnit(path_, job, Axes(machine_, {}), case_.belt_mm_s);
    EXPECT_TRUE(unit);
    return unit.value_or(UnitPath{});
  }
  static std::vector<Sample> samplesOf(const UnitPath& unit) {
    std::vector<Sample> samples;
    for (const Block& block : unit.blocks)
      samples.insert(samples.end(), block.samples.begin(), block.samples.end());
    return samples;
  }
  Case case_;
  JobParameters job_;
  MachineParameters machine_;
  std::vector<Segment> path_;
};

/// Mirror angles at the period ends. A second difference is a mean of the acceleration over two periods, so
/// it exceeds no bound that the motion keeps, but for a corner between two periods, by up to 2.6 %
/// (motion/corners.h). The rest of the margin is for the turn of the tangent within an interval of the
/// planner (0.04 rad either way) and for the rounding of the G-code.
TEST_P(EveryFlow, KeepsEachMirrorWithinItsLimitsOnTheMovingSheet) {
  const Axes axes(machine_, {});
  const UnitPath unit = planned(job_);
  std::vector<Vector2d> points(3, unit.start_S_mm);
  for (const Sample& sample : samplesOf(unit)) points.push_back(sample.p_S_mm);
  points.insert(points.end(), 3, unit.endS());
  double largest_rate = 0.0;
  double largest_acceleration = 0.0;
  double largest_path = 0.0;
  // The unit lies anywhere in the field: the middle, and as far off as it goes.
  for (const double x_ref_mm : {-20.0, 5.0, 30.0}) {
    std::vector<Vector2d> steps;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double t_s = static_cast<double>(i) * Target{}.periodS();
      double x_mm = points[i].x() + x_ref_mm + case_.belt_mm_s * t_s;
      // A long unit would run out of the field: it is folded back at the limit, where a test of limits ends.
      if (std::abs(x_mm) > 80.0) x_mm = std::nan("");
      steps.push_back(axes.stepsAt({x_mm, points[i].y()}));
    }
    for (std::size_t i = 1; i + 1 < steps.size(); ++i) {
      if (!steps[i - 1].allFinite() || !steps[i].allFinite() || !steps[i + 1].allFinite()) continue;
      largest_rate = std::max(largest_rate, (steps[i] - steps[i - 1]).cwiseAbs().maxCoeff());
      const Vector2d second = steps[i + 1] - 2.0 * steps[i] + steps[i - 1];
      largest_acceleration = std::max(largest_acceleration, second.cwiseAbs().maxCoeff());
    }
  }
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    largest_path = std::max(largest_path, (points[i + 1] - 2.0 * points[i] + points[i - 1]).norm());
  }
  const double per_s2 = machine_.mirror_step_rad / (Target{}.periodS() * Target{}.periodS());
  EXPECT_LE(largest_rate, Target::stepBudget(31) + 0.05);
  EXPECT_LE(largest_acceleration * per_s2, kMirrorLimit_rad_s2 * 1.03);
  EXPECT_GE(largest_acceleration * per_s2, kMirrorLimit_rad_s2 * 0.85) << "the mirrors should be used";
  EXPECT_LE(largest_path / (Target{}.periodS() * Target{}.periodS()), job_.acceleration_mm_s2 * 1.03);
  RecordProperty("largest_rad_s2", std::to_string(largest_acceleration * per_s2));
}

TEST_P(EveryFlow, PositionsAreContinuousAndNoFasterThanToldTo) {
  const UnitPath unit = planned(job_);
  Vector2d before = unit.start_S_mm;
  for (const Sample& sample : samplesOf(unit)) {
    const double way_mm = (sample.p_S_mm - before).norm();
    const double most_mm_s = sample.marked_mm > 0.0 ? job_.mark_speed_mm_s : job_.jump_speed_mm_s;
    EXPECT_LE(way_mm, most_mm_s * Target{}.periodS() * (1.0 + 1e-9));
    before = sample.p_S_mm;
  }
  EXPECT_LT((before - path_.back().end_mm).norm(), 1e-12);
}

/// The laser is on from the first point of each mark to its last, at borders of periods, and nowhere else.
TEST_P(EveryFlow, MarksAreCoveredExactly) {
  const UnitPath unit = planned(job_);
  double wanted_mm = 0.0;
  std::vector<Vector2d> ends;  // Ends of marks, in order, as drawn.
  for (std::size_t i = 0; i < path_.size(); ++i) {
    if (path_[i].jump) continue;
    wanted_mm += path_[i].z * path_[i].lengthMm();
    if (i == 0 || path_[i - 1].jump) ends.push_back(path_[i].start_mm);
    if (i + 1 == path_.size() || path_[i + 1].jump) ends.push_back(path_[i].end_mm);
  }
  double marked_mm = 0.0;
  std::vector<Vector2d> switched;
  Vector2d before = unit.start_S_mm;
  bool on = false;
  for (const Sample& sample : samplesOf(unit)) {
    if ((sample.marked_mm > 0.0) != on) switched.push_back(before);
    on = sample.marked_mm > 0.0;
    marked_mm += sample.marked_mm;
    before = sample.p_S_mm;
    if (!on) continue;
    double off_mm = 1e9;
    for (const dieline::Entity& entity : case_.dieline.entities)
      off_mm = std::min(off_mm, dieline::nearestOn(entity.curve, before).distance_mm);
    EXPECT_LT(off_mm, 0.0025) << "of the dieline: 2 um of flattening, and the G-code's decimals";
  }
  if (on) switched.push_back(before);
  EXPECT_NEAR(marked_mm, wanted_mm, 1e-9 * wanted_mm);
  ASSERT_EQ(switched.size(), ends.size());
  for (std::size_t i = 0; i < ends.size(); ++i) EXPECT_LT((switched[i] - ends[i]).norm(), 1e-9) << i;
}

TEST_P(EveryFlow, TakesNoLongerThanStraightJumps) {
  JobParameters straight = job_;
  straight.jump_radius_mm = 0.0;
  EXPECT_LE(samplesOf(planned(job_)).size(), samplesOf(planned(straight)).size());
}

TEST_P(EveryFlow, TheWholeProgramBurnsTheDieline) {
  job_.belt_speed_mm_s = case_.belt_mm_s;
  job_.web_start_x_mm = 25.0;
  if (std::string(case_.name) == "carton" && case_.belt_mm_s == 0.0) return;
  const Plan plan = planFromGcode(makeGcode(case_.dieline, machine_, job_), machine_, job_);
  const test::Played played = test::play(plan.program, machine_, job_);
  EXPECT_EQ(played.error, "");
  EXPECT_LT(test::worstDeviationMm(played, case_.dieline, job_), 0.016);
  EXPECT_LT(test::worstGapMm(played, case_.dieline, job_, 0), 0.016);
  for (const test::Period& period : played.periods) {
    EXPECT_LE(period.largest_steps, 29);
    for (int i = 0; i < 2; ++i) {
      EXPECT_GE(period.to_W_mm[i], machine_.field_min_mm[i] - 0.007);
      EXPECT_LE(period.to_W_mm[i], machine_.field_max_mm[i] + 0.007);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Planner, EveryFlow, ::testing::Range(0, static_cast<int>(cases().size())),
                         [](const auto& instance) {
                           std::string name = cases()[std::size_t(instance.param)].name;
                           for (char& c : name)
                             c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
                           return name + "_" + std::to_string(instance.param);
                         });

TEST(Flow, TheButtonGainsAThirdOfItsMeanSpeed) {
  const MachineParameters machine = slowMirrors();
  JobParameters job = smoothJob(5.0);
  job.acceleration_mm_s2 = 9000.0;
  job.web_start_x_mm = 25.0;
  // The order of the scenarios native/button and native/button-straight.
  job.order = JobParameters::Order::kNearest;
  const Plan smooth = planner::plan(button(), machine, job);
  job.jump_radius_mm = 0.0;
  const Plan straight = planner::plan(button(), machine, job);
  EXPECT_LT(smooth.unit_time_s * 1.33, straight.unit_time_s);
  EXPECT_GT(smooth.jump_length_mm, straight.jump_length_mm) << "longer ways, sooner done";
}

TEST(Flow, DashesOnALineAreRunThroughAtFullSpeed) {
  std::vector<dieline::Entity> dashes;
  for (int i = 0; i < 12; ++i) dashes.push_back(test::line(-5.0 * i, 0, -5.0 * i - 3.0, 0));
  const MachineParameters machine = slowMirrors();
  JobParameters job = smoothJob(5.0);
  job.jump_speed_mm_s = job.mark_speed_mm_s;
  job.web_start_x_mm = 30.0;
  const Plan plan = planner::plan(test::dielineOf(std::move(dashes)), machine, job);
  // The ideal is 58 mm at 300 mm/s and one ramp at either end, without the wait for a border of periods at
  // each of 22 ends.
  const double ideal_s = 58.0 / 300.0 + 300.0 / 9000.0;
  EXPECT_LT(plan.unit_time_s, ideal_s * 1.08);
}

TEST(Flow, WaitsForTheSheetAtRest) {
  // The field is a third as long as the drawing: units of which the far end comes into reach long after the
  // near one.
  std::vector<dieline::Entity> rows;
  for (int i = 0; i < 40; ++i) rows.push_back(test::line(-10.0 * i, -3, -10.0 * i, 3));
  const dieline::Dieline dieline = test::dielineOf(std::move(rows));
  JobParameters job = smoothJob(5.0);
  job.belt_speed_mm_s = 20.0;
  const Plan plan = planner::plan(dieline, slowMirrors(), job);
  const test::Played played = test::play(plan.program, slowMirrors(), job);
  EXPECT_EQ(played.error, "");
  EXPECT_LT(test::worstDeviationMm(played, dieline, job), 0.016);
  EXPECT_LT(test::worstGapMm(played, dieline, job, 0), 0.016);
}

/// Most that either mirror has to do anywhere in the field while the box is used to its corners.
double largestInTheField(const MachineParameters& machine, double speed_mm_s) {
  const Axes axes(machine, {});
  const Vector2d box = axes.accelerationBox(speed_mm_s);
  double largest = 0.0;
  constexpr double kDt = 1e-4;
  for (int i = -5; i <= 5; ++i) {
    for (int k = -5; k <= 5; ++k) {
      const Vector2d place(15.8 * i, 15.8 * k);
      for (int turn = 0; turn < 21; ++turn) {
        const double angle = 0.3 * turn;
        for (const Vector2d& corner : {Vector2d(1, 1), Vector2d(1, -1), Vector2d(-1, 1), Vector2d(-1, -1)}) {
          const Vector2d v = speed_mm_s * Vector2d(std::cos(angle), std::sin(angle));
          const auto at = [&](double t) {
            return axes.stepsAt(place + v * t + 0.5 * t * t * box.cwiseProduct(corner));
          };
          const Vector2d second = (at(kDt) - 2.0 * at(0.0) + at(-kDt)) / (kDt * kDt);
          largest = std::max(largest, second.cwiseAbs().maxCoeff() * machine.mirror_step_rad);
        }
      }
    }
  }
  return largest;
}

TEST(AccelerationBox, HoldsEverywhereInTheField) {
  MachineParameters machine = slowMirrors();
  EXPECT_LE(largestInTheField(machine, 500.0), kMirrorLimit_rad_s2 * 1.0001);
  EXPECT_GE(largestInTheField(machine, 500.0), kMirrorLimit_rad_s2 * 0.97)
      << "the bound should not waste acceleration";
  // At this throw the field is as wide as the throw is long: x feels y, and the head's distortion takes its
  // share.
  machine.throw_mm = 100.0;
  machine.mirror_spacing_mm = 0.0;
  for (const double speed_mm_s : {0.0, 30.0, 120.0}) {
    EXPECT_LE(largestInTheField(machine, speed_mm_s), kMirrorLimit_rad_s2 * 1.0001) << speed_mm_s;
    EXPECT_GE(largestInTheField(machine, speed_mm_s), kMirrorLimit_rad_s2 * 0.6) << speed_mm_s;
  }
}

TEST(AccelerationBox, KnowsNoLimitWhereNoneIsTold) {
  EXPECT_GT(Axes(test::twoMirror(), {}).accelerationBox(1000.0).minCoeff(), 1e11);
  EXPECT_GT(Axes(slowMirrors(), {.no_mirror_limit = true}).accelerationBox(1000.0).minCoeff(), 1e11);
  EXPECT_LT(Axes(slowMirrors(), {}).accelerationBox(1e5).minCoeff(), 0.0)
      << "too fast for the head's distortion";
}

/// Hostile G-code: tiny marks, jumps on jumps, marks without power, ends that meet, half power.
TEST(Flow, AnyGcodeIsRunInOrderWithFiniteNumbers) {
  const MachineParameters machine = slowMirrors();
  for (unsigned seed = 1; seed <= 60; ++seed) {
    std::mt19937 bits(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::string gcode = "G00 X0 Y0\n";
    Vector2d at(0, 0);
    for (int i = 0; i < 60; ++i) {
      const double reach = std::pow(10.0, 4.0 * unit(bits) - 3.0);  // 1 um … 10 mm
      const double angle = std::floor(8.0 * unit(bits)) * 0.7853981634;
      const Vector2d to =
          (at + reach * Vector2d(std::cos(angle), std::sin(angle))).cwiseMax(-40.0).cwiseMin(40.0);
      const double kind = unit(bits);
      if (kind < 0.4) {
        gcode += fmt::format("G00 X{:.4f} Y{:.4f}\n", to.x(), to.y());
      } else if (kind < 0.5) {
        gcode += fmt::format("G02 X{0:.4f} Y{1:.4f} I{2:.4f} J0 Z1\n", at.x(), at.y(), 0.01 + reach);
        continue;
      } else {
        gcode += fmt::format("G01 X{:.4f} Y{:.4f} Z{}\n", to.x(), to.y(),
                             kind < 0.6    ? 0.0
                             : kind < 0.75 ? 0.5
                                           : 1.0);
      }
      at = to;
    }
    gcode += "G01 X1 Y1 Z1\n";
    std::vector<Segment> path = readGcode(gcode);
    while (path.front().jump) path.erase(path.begin());
    double wanted_mm = 0.0;
    for (const Segment& segment : path) wanted_mm += segment.jump ? 0.0 : segment.z * segment.lengthMm();
    JobParameters job = smoothJob(seed % 3 == 0 ? kRadiusOfDrawing : 0.1 * seed);
    // A rounded corner is shorter, by less than two thirds of its error for each radian of its turn.
    if (seed % 2 == 0) job.corner_error_mm = 0.0;
    const double shorter_mm = 60.0 * job.corner_error_mm;
    const auto planned = planUnit(path, job, Axes(machine, {}), seed % 2 == 0 ? 0.0 : 30.0);
    ASSERT_TRUE(planned) << seed;
    double marked_mm = 0.0;
    Vector2d before = planned->start_S_mm;
    for (const Block& block : planned->blocks) {
      for (const Sample& sample : block.samples) {
        ASSERT_TRUE(sample.p_S_mm.allFinite() && std::isfinite(sample.marked_mm)) << seed;
        EXPECT_GE(sample.marked_mm, 0.0);
        EXPECT_LE((sample.p_S_mm - before).norm(), 430.0 * Target{}.periodS() * 1.001) << seed;
        marked_mm += sample.marked_mm;
        before = sample.p_S_mm;
      }
    }
    EXPECT_LE(marked_mm, wanted_mm * (1.0 + 1e-9)) << seed;
    EXPECT_GE(marked_mm, wanted_mm * (1.0 - 1e-9) - shorter_mm) << seed;
    EXPECT_LT((before - path.back().end_mm).norm(), 1e-12);
  }
}

TEST(Flow, AJumpAwayAndBackIsAStopAtTheMostAndNoWay) {
  const std::vector<Segment> path = readGcode(
      "G00 X0 Y0\nG01 X5 Y0 Z1\nG00 X20 Y20\nG00 X5 Y0\nG01 X5 Y5 Z1\nG00 X9 Y9\nG00 X5 Y5\nG01 X5 Y9 Z1\n");
  const auto first = std::find_if(path.begin(), path.end(), [](const Segment& s) { return !s.jump; });
  const auto unit = planUnit({first, path.end()}, smoothJob(2.0), Axes(slowMirrors(), {}), 0.0);
  ASSERT_TRUE(unit);
  EXPECT_EQ(unit->blocks.size(), 2U) << "the corner is a stop, the straight run is not";
  EXPECT_LT(unit->jump_length_mm, 1e-9);
  double marked_mm = 0.0;
  for (const Block& block : unit->blocks)
    for (const Sample& sample : block.samples) marked_mm += sample.marked_mm;
  EXPECT_NEAR(marked_mm, 14.0, 1e-9);
}

TEST(Reposition, KeepsTheMirrorsWithinTheirLimitOnTheWayBack) {
  const MachineParameters machine = slowMirrors();
  const Axes axes(machine, {});
  JobParameters job = smoothJob(5.0);
  job.jump_acceleration_mm_s2 = 1e6;  // The mirrors alone are the limit.
  for (const Vector2d& to : {Vector2d(-70, 70), Vector2d(60, 70), Vector2d(-70, -70), Vector2d(20, -65)}) {
    const Vector2d from(60, -70);
    const Reposition way(from, 25.0, to, job, axes);
    std::vector<Vector2d> steps{axes.stepsAt(from - Vector2d(25.0 * Target{}.periodS(), 0.0))};
    for (int k = 0; k <= way.periods() + 1; ++k) steps.push_back(axes.stepsAt(way.at(k)));
    double largest = 0.0;
    for (std::size_t i = 1; i + 1 < steps.size(); ++i) {
      const Vector2d second =
          (steps[i + 1] - 2.0 * steps[i] + steps[i - 1]) / (Target{}.periodS() * Target{}.periodS());
      largest = std::max(largest, second.cwiseAbs().maxCoeff() * machine.mirror_step_rad);
    }
    EXPECT_LE(largest, kMirrorLimit_rad_s2 * 1.001);
    EXPECT_GE(largest, kMirrorLimit_rad_s2 * 0.9);
  }
}

}  // namespace
}  // namespace kerfbench::planner
