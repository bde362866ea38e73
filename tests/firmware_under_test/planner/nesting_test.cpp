// SPDX-License-Identifier: Apache-2.0
// What is cut alone is cut as in the whole job: nesting and the side of the kerf come from the whole drawing.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/geometry/jump_curve.h"
#include "firmware_under_test/planner/order/cut_order.h"
#include "firmware_under_test/planner/order/kerf.h"
#include "firmware_under_test/planner/program/selection.h"
#include "hil/dieline/geometry.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using dieline::Process;
using Order = JobParameters::Order;
using test::arc;
using test::line;
using test::refusal;
using test::twoMirror;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A label (E0 to E7) with a round hole (E8), a square one (E9 to E12) with an island (E13 to E16), a crease
/// (E17) in it, and a round label beside it (E18).
dieline::Dieline nestedDrawing() {
  std::vector<dieline::Entity> entities = test::label().entities;
  entities.push_back(arc(-30.0, 12.0, 2.5, 0.0, 360.0));
  for (const auto& [x, y, half] : {std::tuple(-45.0, -5.0, 5.0), std::tuple(-45.0, -5.0, 2.0)}) {
    entities.push_back(line(x - half, y - half, x + half, y - half));
    entities.push_back(line(x + half, y + half, x + half, y - half));  // Against the others.
    entities.push_back(line(x + half, y + half, x - half, y + half));
    entities.push_back(line(x - half, y + half, x - half, y - half));
  }
  entities.push_back(line(-20.0, -15.0, -20.0, 15.0, Process::kCrease));
  entities.push_back(arc(-30.0, 40.0, 8.0, 0.0, -360.0));
  return test::dielineOf(entities);
}

dieline::Dieline chosen(dieline::Dieline dieline, const std::string& entities,
                        const std::string& processes = "") {
  select(dieline, selectionFrom(entities, "", processes));
  return dieline;
}

JobParameters jobWith(Order order, double radius_mm) {
  JobParameters job = test::mirrorJob();
  job.order = order;
  job.kerf_radius_mm = radius_mm;
  return job;
}

/// Marks by entity.
std::map<int, std::vector<Segment>> marksOf(const dieline::Dieline& dieline, const JobParameters& job) {
  std::map<int, std::vector<Segment>> marks;
  for (const Segment& segment : readGcode(makeGcode(dieline, twoMirror(), job))) {
    if (!segment.jump) marks[segment.entity].push_back(segment);
  }
  return marks;
}

double distanceTo(const std::vector<Segment>& path, const Eigen::Vector2d& p) {
  double nearest = INFINITY;
  for (const Segment& segment : path) {
    const int parts = segment.isArc() ? 400 : 1;
    for (int i = 0; i < parts; ++i) {
      const Eigen::Vector2d a = segment.at(segment.lengthMm() * i / parts);
      const Eigen::Vector2d b = segment.at(segment.lengthMm() * (i + 1) / parts);
      const double u = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (a + u * (b - a) - p).norm());
    }
  }
  return nearest;
}

/// Farthest that a path is from another one, seen from both.
double apart(const std::vector<Segment>& a, const std::vector<Segment>& b) {
  double worst = 0.0;
  for (const auto& [from, to] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    for (const Segment& segment : *from) {
      for (int i = 0; i <= 20; ++i)
        worst = std::max(worst, distanceTo(*to, segment.at(segment.lengthMm() * i / 20)));
    }
  }
  return worst;
}

/// Radius of a round hole as cut.
double radiusOf(const std::vector<Segment>& path) {
  return (path.front().start_mm - path.front().centre_mm).norm();
}

TEST(Nesting, EachEntityIsCutAloneAsInTheWholeJob) {
  const std::vector<std::string> selections{"8",    "0-7",  "0-8",     "9-12", "13-16",   "9-16",
                                            "8,18", "9,11", "0,13,14", "3-5",  "13,17,18"};
  for (const double radius_mm : {0.0, 0.1}) {
    const auto whole = marksOf(nestedDrawing(), jobWith(Order::kShortest, radius_mm));
    ASSERT_EQ(whole.size(), nestedDrawing().entities.size());
    for (const Order order : {Order::kShortest, Order::kNearest, Order::kDrawn}) {
      for (const std::string& selection : selections) {
        const dieline::Dieline part = chosen(nestedDrawing(), selection);
        const auto marks = marksOf(part, jobWith(order, radius_mm));
        for (const dieline::Entity& entity : part.entities) {
          const std::string what = fmt::format("E{} of {}, order {}, radius {}", entity.id, selection,
                                               static_cast<int>(order), radius_mm);
          const bool wanted = entity.process != Process::kIgnore;
          ASSERT_EQ(marks.count(entity.id), wanted ? 1U : 0U) << what;
          if (!wanted) continue;
          EXPECT_LT(apart(marks.at(entity.id), whole.at(entity.id)), 3e-4) << what;
          EXPECT_NEAR(lengthOf(marks.at(entity.id)), lengthOf(whole.at(entity.id)), 2e-3) << what;
        }
      }
    }
  }
}

TEST(Nesting, AHoleAloneIsCutInsideOfItsLine) {
  for (const Order order : {Order::kShortest, Order::kNearest, Order::kDrawn}) {
    const JobParameters job = jobWith(order, 0.132);
    EXPECT_NEAR(radiusOf(marksOf(chosen(nestedDrawing(), "8"), job).at(8)), 2.368, 1e-3);
    EXPECT_NEAR(radiusOf(marksOf(chosen(nestedDrawing(), "18"), job).at(18)), 8.132, 1e-3);
  }
}

TEST(Nesting, OfALayerThatIsIgnoredDoesNotCount) {
  dieline::Dieline dieline = nestedDrawing();
  for (int id = 0; id < 8; ++id) dieline.entities[static_cast<std::size_t>(id)].process = Process::kIgnore;
  const auto marks = marksOf(chosen(dieline, "8"), jobWith(Order::kShortest, 0.132));
  EXPECT_NEAR(radiusOf(marks.at(8)), 2.632, 1e-3);
}

TEST(Nesting, SeesAHoleCloseToTheArcOfALargeOutline) {
  // The hole comes within 0.05 mm of a circle of 100 mm, where a polygon of 79 sides would have left it
  // outside.
  const double angle_rad = 1.0 / 24.0;
  const Eigen::Vector2d centre = 98.95 * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
  const double towards_centre_deg = 180.0 + angle_rad * 180.0 / 3.14159265358979;
  const dieline::Dieline dieline =
      test::dielineOf({arc(0, 0, 100, 0, 360), arc(centre.x(), centre.y(), 1, towards_centre_deg, 360)});
  const Compensated done = compensate(dieline, jobWith(Order::kShortest, 0.02));
  ASSERT_EQ(done.offset.paths.size(), 2U);
  EXPECT_NEAR(radiusOf(done.offset.paths[0].segments), 100.02, 1e-9);
  EXPECT_NEAR(radiusOf(done.offset.paths[1].segments), 0.98, 1e-9);
}

TEST(Nesting, AFurtherSelectionKeepsWhatTheFirstLeftOut) {
  const dieline::Dieline dieline = chosen(chosen(nestedDrawing(), "8-18"), "", "cut");
  const auto marks = marksOf(chosen(dieline, "8"), jobWith(Order::kShortest, 0.132));
  EXPECT_NEAR(radiusOf(marks.at(8)), 2.368, 1e-3);
}

TEST(Nesting, TheOrderDrawnKeepsItsSequenceAndSenseWithAKerf) {
  for (const std::string selection : {"0-18", "3,8-13"}) {
    const dieline::Dieline part = chosen(nestedDrawing(), selection);
    const JobParameters plain = jobWith(Order::kDrawn, 0.0);
    const JobParameters beside = jobWith(Order::kDrawn, 0.1);
    const std::vector<Stop> lines = drawnOrder(part, plain, {});
    const std::vector<Stop> paths = drawnOrder(part, beside, {});
    ASSERT_EQ(lines.size(), paths.size());
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::vector<Segment>& drawn = lines[i].chain.segments;
      const std::vector<Segment>& path = paths[i].chain.segments;
      EXPECT_EQ(drawn.front().entity, path.front().entity);
      EXPECT_EQ(lines[i].chain.process, paths[i].chain.process);
      const auto longest = std::ranges::max_element(path, {}, &Segment::lengthMm);
      const Eigen::Vector2d p = longest->at(0.5 * longest->lengthMm());
      const Eigen::Vector2d q = drawn.front().at(0.5 * drawn.front().lengthMm());
      const auto& curve = part.entities[static_cast<std::size_t>(path.front().entity)].curve;
      const Eigen::Vector2d t = dieline::tangentAt(curve, dieline::nearestOn(curve, p).u);
      EXPECT_GT(longest->tangentAt(0.5 * longest->lengthMm()).dot(t), 0.9) << i;
      const double kerf_mm = path.front().z == 1.0 ? 0.1 : 0.0;
      if (!drawn.front().isArc()) {
        EXPECT_NEAR((p - q).norm(), kerf_mm, 1e-6) << i;
      }
    }
  }
}

TEST(Nesting, NotesAndRefusalsConcernWhatIsChosen) {
  dieline::Dieline dieline = nestedDrawing();
  std::vector<dieline::Entity> entities = dieline.entities;
  entities.push_back(arc(-10.0, 0.0, 0.05, 0.0, 360.0));  // E19: smaller than the kerf.
  entities.push_back(line(-12.0, -10.0, -12.0, -5.0));    // E20: open.
  dieline = test::dielineOf(entities);
  const JobParameters job = jobWith(Order::kShortest, 0.1);
  const auto refusalOf = [&](const std::string& selection) {
    return refusal([&] { makeGcode(chosen(dieline, selection), twoMirror(), job); });
  };
  EXPECT_THAT(refusalOf("19"), HasSubstr("E19"));
  EXPECT_EQ(refusalOf("0-18,20"), "");
  EXPECT_THAT(compensate(chosen(dieline, "8"), job).notes, IsEmpty());
  EXPECT_THAT(compensate(chosen(dieline, "20"), job).notes,
              testing::ElementsAre(HasSubstr("E20 at (-12.000, -10.000): an open cut")));
}

TEST(Nesting, ThatCannotBeToldIsRefusedThoughTheReasonIsNotChosen) {
  std::vector<dieline::Entity> entities = nestedDrawing().entities;
  entities.push_back(arc(-30.0, 12.0, 2.5, 90.0, 360.0));  // The hole once more.
  const dieline::Dieline dieline = test::dielineOf(entities);
  const auto refusalOf = [&](double radius_mm) {
    return refusal(
        [&] { makeGcode(chosen(dieline, "8"), twoMirror(), jobWith(Order::kShortest, radius_mm)); });
  };
  EXPECT_THAT(refusalOf(0.1), AllOf(HasSubstr("E8 and E19"), HasSubstr("meets another one"),
                                    HasSubstr("cuts that are not selected")));
  EXPECT_EQ(refusalOf(0.0), "");
}

TEST(Nesting, HolesOfOneLabelGoBeforeTheOutlineOfAnother) {
  const dieline::Dieline part = chosen(nestedDrawing(), "8,18");
  const std::vector<Stop> order = nearestOrder(part, jobWith(Order::kNearest, 0.0), {}, {});
  ASSERT_EQ(order.size(), 2U);
  EXPECT_EQ(order[0].chain.segments[0].entity, 8);
  EXPECT_LT(order[0].rank, order[1].rank);
}

}  // namespace
}  // namespace kerfbench::planner
