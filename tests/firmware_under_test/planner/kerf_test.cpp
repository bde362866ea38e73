// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/order/kerf.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "hil/dieline/geometry.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using test::carton;
using test::dielineOf;
using test::mirrorJob;
using test::twoMirror;
using ::testing::HasSubstr;

JobParameters kerfJob(double radius_mm) {
  JobParameters job = mirrorJob();
  job.kerf_radius_mm = radius_mm;
  return job;
}

std::vector<dieline::Entity> rectangle(double x0, double y0, double x1, double y1) {
  return {test::line(x0, y0, x1, y0), test::line(x1, y0, x1, y1), test::line(x1, y1, x0, y1),
          test::line(x0, y1, x0, y0)};
}

/// A label with a round hole, a square hole and an island in that.
dieline::Dieline labelWithHoles() {
  dieline::Dieline dieline = test::label();
  std::vector<dieline::Entity> entities = dieline.entities;
  entities.push_back(test::arc(-30.0, 12.0, 2.5, 0.0, 360.0));
  for (const auto& part : {rectangle(-50.0, -10.0, -40.0, 0.0), rectangle(-47.0, -7.0, -43.0, -3.0)}) {
    entities.insert(entities.end(), part.begin(), part.end());
  }
  return dielineOf(entities);
}

std::string refusal(const dieline::Dieline& dieline, const JobParameters& job) {
  try {
    makeGcode(dieline, twoMirror(), job);
  } catch (const PlanError& error) {
    return error.what();
  }
  return {};
}

double widthOf(const BeamPath& path) {
  double x_low = INFINITY;
  double x_high = -INFINITY;
  for (const Segment& segment : path.segments) {
    x_low = std::min(x_low, segment.start_mm.x());
    x_high = std::max(x_high, segment.start_mm.x());
  }
  return x_high - x_low;
}

TEST(Kerf, TheBeamRunsOutsideOfOutlinesInsideOfHolesAndOutsideOfIslands) {
  const Compensated done = compensate(labelWithHoles(), kerfJob(0.2));
  ASSERT_EQ(done.offset.paths.size(), 4U);
  std::vector<double> widths;
  for (std::size_t i = 0; i < 4; ++i) widths.push_back(widthOf(done.offset.paths[i]));
  EXPECT_NEAR(widths[0], 60.4, 1e-9);
  EXPECT_NEAR(done.offset.paths[1].segments[0].radiusMm(), 2.3, 1e-9);
  EXPECT_NEAR(widths[2], 9.6, 1e-9);
  EXPECT_NEAR(widths[3], 4.4, 1e-9);
}

TEST(Kerf, AsPlayedTheBeamKeepsItsRadiusFromTheDieline) {
  const dieline::Dieline dieline = labelWithHoles();
  for (const double belt : {0.0, 60.0}) {
    JobParameters job = kerfJob(0.15);
    job.belt_speed_mm_s = belt;
    const Plan plan = planner::plan(dieline, twoMirror(), job);
    const test::Played played = test::play(plan.program, twoMirror(), job);
    EXPECT_EQ(played.error, "");
    double nearest = INFINITY;
    double farthest = 0.0;
    for (const test::Period& period : played.periods) {
      if (period.power < 0) continue;
      double distance = INFINITY;
      for (const dieline::Entity& entity : dieline.entities) {
        distance = std::min(distance, dieline::nearestOn(entity.curve, period.to_S_mm).distance_mm);
      }
      nearest = std::min(nearest, distance);
      farthest = std::max(farthest, distance);
    }
    EXPECT_NEAR(nearest, 0.15, 0.015);
    EXPECT_NEAR(farthest, 0.15 * std::sqrt(2.0), 0.015);  // Distance of the island's corners.
  }
}

TEST(Kerf, OffChangesNoByte) {
  JobParameters job = mirrorJob();
  const std::string before = makeGcode(carton(), twoMirror(), job);
  job.allow_lost = {{0, 99}};
  job.open_cuts = JobParameters::OpenCuts::kLeft;
  EXPECT_EQ(makeGcode(carton(), twoMirror(), job), before);
}

TEST(Kerf, OnlyCutsAreMoved) {
  const JobParameters job = kerfJob(0.2);
  std::vector<Segment> moved;
  const Compensated done = compensate(carton(), job);
  for (const Chain& chain : done.chains) {
    if (chain.process == dieline::Process::kCut) continue;
    for (const Segment& segment : chain.segments) {
      for (const dieline::Entity& entity : carton().entities) {
        if (entity.id != segment.entity) continue;
        EXPECT_LT(dieline::nearestOn(entity.curve, segment.start_mm).distance_mm, 1e-9);
        moved.push_back(segment);
      }
    }
  }
  EXPECT_EQ(moved.size(), 4U);  // Two creases, a half-cut, a perforation.
}

TEST(Kerf, OpenCutsStayOnTheLineAndAreNamedUnlessASideIsChosen) {
  JobParameters job = kerfJob(0.5);
  const dieline::Dieline dieline = dielineOf({test::line(0.0, -10.0, 0.0, 10.0)});
  Compensated done = compensate(dieline, job);
  EXPECT_TRUE(done.offset.paths.empty());
  ASSERT_EQ(done.chains.size(), 1U);
  EXPECT_DOUBLE_EQ(done.chains[0].start().x(), 0.0);
  ASSERT_EQ(done.notes.size(), 1U);
  EXPECT_THAT(done.notes[0], HasSubstr("E0 at (0.000, -10.000): an open cut"));
  job.open_cuts = JobParameters::OpenCuts::kLeft;
  EXPECT_DOUBLE_EQ(compensate(dieline, job).chains[0].start().x(), -0.5);
  job.open_cuts = JobParameters::OpenCuts::kRight;
  done = compensate(dieline, job);
  EXPECT_DOUBLE_EQ(done.chains[0].start().x(), 0.5);
  EXPECT_TRUE(done.notes.empty());
}

TEST(Kerf, FeaturesSmallerThanTheKerfAreRefusedByNameAndOnDemandOnlyNamed) {
  dieline::Dieline dieline = test::label();
  std::vector<dieline::Entity> entities = dieline.entities;
  const auto hole_id = entities.size();
  entities.push_back(test::arc(-30.0, 12.0, 0.2, 0.0, 360.0));
  const auto slit = rectangle(-50.0, -10.0, -40.0, -9.7);
  entities.insert(entities.end(), slit.begin(), slit.end());
  dieline = dielineOf(entities);
  JobParameters job = kerfJob(0.25);
  const std::string fault = refusal(dieline, job);
  EXPECT_THAT(fault, HasSubstr("E" + std::to_string(hole_id)));
  EXPECT_THAT(fault, HasSubstr("smaller than the kerf of 0.5 mm"));
  EXPECT_THAT(fault, HasSubstr("at (-50.000, -10.000)"));
  EXPECT_THAT(fault, HasSubstr("planner.allow_lost_features: E8 cuts the rest"));
  job.given_by = GivenBy::kCommandLine;
  EXPECT_THAT(refusal(dieline, job), HasSubstr("--allow-lost E8 cuts the rest"));
  job.allow_lost = {{8, 12}};
  EXPECT_EQ(refusal(dieline, job), "");
  EXPECT_EQ(compensate(dieline, job).notes.size(), 2U);
}

TEST(Kerf, OnlyTheFeaturesThatAreNamedMayBeLost) {
  std::vector<dieline::Entity> entities = test::label().entities;
  entities.push_back(test::arc(-30.0, 12.0, 0.2, 0.0, 360.0));  // E8
  for (const auto& side : rectangle(-50.0, -10.0, -40.0, -9.7))
    entities.push_back(side);                                  // E9 to E12, a slit.
  entities.push_back(test::arc(-20.0, 0.0, 3.0, 0.0, 360.0));  // E13
  const dieline::Dieline dieline = dielineOf(entities);
  const auto refusalOf = [&](const EntityRanges& allowed) {
    JobParameters job = kerfJob(0.25);
    job.allow_lost = allowed;
    return refusal(dieline, job);
  };
  EXPECT_THAT(refusalOf({{8, 8}}),
              testing::AllOf(HasSubstr("E9,E10,E11,E12 cuts the rest"), testing::Not(HasSubstr("E8"))));
  EXPECT_THAT(refusalOf({{9, 12}}), testing::AllOf(HasSubstr("E8 at"), testing::Not(HasSubstr("E9"))));
  EXPECT_THAT(refusalOf({{8, 8}, {9, 11}}), HasSubstr("E9,E10,E11,E12 cuts the rest"));
  EXPECT_EQ(refusalOf({{8, 12}}), "");
  EXPECT_THAT(refusalOf({{8, 12}, {14, 20}}), HasSubstr("there is no E14-E20 in the drawing"));
  JobParameters job = kerfJob(0.25);
  job.allow_lost = {{8, 12}, {13, 13}};
  EXPECT_THAT(compensate(dieline, job).notes, testing::Contains(HasSubstr("nothing of E13 is lost")));
}

TEST(Kerf, InnerCornersAreNotedWithTheirDepth) {
  const Compensated done = compensate(labelWithHoles(), kerfJob(0.2));
  ASSERT_EQ(done.notes.size(), 1U);
  EXPECT_THAT(done.notes[0], HasSubstr("4 inner corners rounded by the beam, by 0.083 mm at most"));
}

TEST(Kerf, DielinesWithoutAnInsideAreRefused) {
  EXPECT_THAT(refusal(dielineOf({test::line(0, 0, 4, 4), test::line(4, 4, 4, 0), test::line(4, 0, 0, 4),
                                 test::line(0, 4, 0, 0)}),
                      kerfJob(0.1)),
              HasSubstr("E0 and E2 at (2.000, 2.000)"));
  std::vector<dieline::Entity> entities = rectangle(-20, 0, -10, 10);
  for (const dieline::Entity& entity : rectangle(-15, 5, -5, 15)) entities.push_back(entity);
  EXPECT_THAT(refusal(dielineOf(entities), kerfJob(0.1)), HasSubstr("meets another one"));
  // The drawing has one circle twice.
  EXPECT_THAT(refusal(dielineOf({test::arc(0, 0, 5, 0, 360), test::arc(0, 0, 5, 90, 360)}), kerfJob(0.1)),
              HasSubstr("meets another one"));
  EXPECT_THAT(refusal(dielineOf({test::line(0, 0, 4, 0), test::line(4, 0, 0, 0)}), kerfJob(0.1)),
              HasSubstr("encloses nothing"));
  EXPECT_THAT(refusal(test::label(), kerfJob(double(NAN))), HasSubstr("kerf_radius_mm"));
}

}  // namespace
}  // namespace kerfbench::planner
