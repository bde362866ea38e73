// SPDX-License-Identifier: Apache-2.0
// Compensation in every combination of order, selection, radius and side of open cuts, held by a second
// method: the G-code is decoded here, the beam's places are compared with the drawing's own curves, and the
// kept piece is counted.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "firmware_under_test/planner/program/selection.h"
#include "hil/dieline/geometry.h"
#include "hil/inspect/edges/edges.h"
#include "player.h"

namespace kerfbench::planner {
namespace {

using dieline::Process;
using Eigen::Vector2d;
using OpenCuts = JobParameters::OpenCuts;
using Order = JobParameters::Order;
using Places = std::vector<Vector2d>;
using test::arc;
using test::line;

/// Four decimals of the G-code, along both axes.
constexpr double kText_mm = 2e-4;
constexpr int kFirstSlit = 20;
constexpr int kSecondSlit = 21;

dieline::Entity on(const char* layer, dieline::Entity entity) {
  entity.layer = layer;
  return entity;
}

/// Arc from a to b that bends to the left by `sweep_rad` in all (< 0: to the right).
dieline::Entity bowed(const Vector2d& a, const Vector2d& b, double sweep_rad) {
  const Vector2d chord = b - a;
  const Vector2d centre = 0.5 * (a + b) + 0.5 * Vector2d(-chord.y(), chord.x()) / std::tan(0.5 * sweep_rad);
  dieline::Entity entity;
  const Vector2d from = a - centre;
  entity.curve = dieline::ArcCurve{centre, from.norm(), std::atan2(from.y(), from.x()), sweep_rad};
  return entity;
}

/// Loops of closed cuts in drawing(), by the entities.
const std::vector<std::vector<int>> kLoops{
    {0, 1, 2, 3, 4, 5, 6}, {7}, {8, 9, 10, 11}, {12, 13, 14, 15}, {22}};

/// A label with an inner corner of which one leg is bowed by 5 degrees (E0 to E6), a round hole (E7), a
/// square one (E8 to E11) with an island (E12 to E15), a crease (E16, E17), a half-cut (E18), a perforation
/// (E19), an open cut of two lines that are drawn against each other beside it (E20, E21) and a round label
/// (E22). Senses are mixed.
dieline::Dieline drawing() {
  std::vector<dieline::Entity> all{on("knife", line(-16, -6, -2, -6)),
                                   on("knife", line(-2, 1, -2, -6)),
                                   on("knife", line(-2, 1, -7, 1)),
                                   on("knife", bowed({-7, 1}, {-7, 6}, 5.0 / 180.0 * std::numbers::pi)),
                                   on("knife", line(-14, 6, -7, 6)),
                                   on("knife", arc(-14, 4, 2, 90, 90)),
                                   on("knife", line(-16, -6, -16, 4))};
  all.push_back(on("holes", arc(-12, 3, 1.5, 0, 360)));
  for (const auto& [layer, half] : {std::pair("holes", 2.0), std::pair("islands", 0.8)}) {
    all.push_back(on(layer, line(-10 - half, -3 - half, -10 + half, -3 - half)));
    all.push_back(on(layer, line(-10 + half, -3 + half, -10 + half, -3 - half)));
    all.push_back(on(layer, line(-10 + half, -3 + half, -10 - half, -3 + half)));
    all.push_back(on(layer, line(-10 - half, -3 + half, -10 - half, -3 - half)));
  }
  all.push_back(on("folds", line(-5, -5.5, -5, -3, Process::kCrease)));
  all.push_back(on("folds", line(-5, 0, -5, -3, Process::kCrease)));
  all.push_back(on("folds", line(-7, -5, -7, -1, Process::kHalfCut)));
  all.push_back(on("folds", line(-15, -5, -15, 3, Process::kPerforation)));
  all.push_back(on("slits", line(1, -5, 1, 0)));
  all.push_back(on("slits", line(4, 3, 1, 0)));
  all.push_back(on("round", arc(-12, 12, 2.5, 0, -360)));
  return test::dielineOf(all);
}

/// Marks of a G-code as polylines, by the entity that its comment names. Decoded without the planner.
struct Decoded {
  std::map<int, std::vector<Places>> marks;
  std::vector<int> sequence;  ///< Entities in the order in which they begin.
};

Places arcPlaces(const Vector2d& from, const Vector2d& to, const Vector2d& centre, bool clockwise) {
  const double start = std::atan2((from - centre).y(), (from - centre).x());
  double sweep = std::atan2((to - centre).y(), (to - centre).x()) - start;
  if (clockwise && sweep > -1e-6) sweep -= 2.0 * std::numbers::pi;
  if (!clockwise && sweep < 1e-6) sweep += 2.0 * std::numbers::pi;
  const double radius = (from - centre).norm();
  const int parts = 2 + static_cast<int>(radius * std::abs(sweep) / 0.02);
  Places places;
  for (int i = 0; i <= parts; ++i) {
    const double angle = start + sweep * i / parts;
    places.emplace_back(centre + radius * Vector2d(std::cos(angle), std::sin(angle)));
  }
  return places;
}

Places linePlaces(const Vector2d& from, const Vector2d& to) {
  const int parts = 1 + static_cast<int>((to - from).norm() / 0.1);
  Places places;
  for (int i = 0; i <= parts; ++i) places.emplace_back(from + (to - from) * i / parts);
  return places;
}

Decoded decoded(const std::string& gcode) {
  Decoded result;
  Vector2d at = Vector2d::Zero();
  std::istringstream lines(gcode);
  int entity = -1;
  for (std::string text; std::getline(lines, text);) {
    const std::size_t comment = text.find("(E");
    if (comment != std::string::npos) entity = std::atoi(text.c_str() + comment + 2);
    std::map<char, double> words;
    std::istringstream items(text.substr(0, text.find('(')));
    for (std::string item; items >> item;) words[item.front()] = std::atof(item.c_str() + 1);
    if (words.count('G') == 0 || words.count('X') + words.count('Y') == 0) continue;
    const Vector2d to(words.count('X') > 0 ? words['X'] : at.x(), words.count('Y') > 0 ? words['Y'] : at.y());
    const int code = static_cast<int>(words['G']);
    if (code != 0) {
      const Vector2d centre = at + Vector2d(words['I'], words['J']);
      result.marks[entity].push_back(code == 1 ? linePlaces(at, to) : arcPlaces(at, to, centre, code == 2));
      if (result.sequence.empty() || result.sequence.back() != entity) result.sequence.push_back(entity);
    }
    at = to;
  }
  return result;
}

double distanceTo(const std::vector<Places>& paths, const Vector2d& p) {
  double nearest = INFINITY;
  for (const Places& path : paths) {
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      const Vector2d along = path[i + 1] - path[i];
      const double u = std::clamp((p - path[i]).dot(along) / std::max(1e-18, along.squaredNorm()), 0.0, 1.0);
      nearest = std::min(nearest, (path[i] + u * along - p).norm());
    }
  }
  return nearest;
}

const dieline::Curve& curveOf(const dieline::Dieline& dieline, int entity) {
  return dieline.entities[static_cast<std::size_t>(entity)].curve;
}

/// Polygons of the loops, fine enough for places that are not nearer to them than 0.01 mm.
std::vector<Places> polygonsOf(const dieline::Dieline& dieline) {
  std::vector<Places> polygons;
  for (const std::vector<int>& loop : kLoops) {
    Places polygon;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const dieline::Curve& curve = curveOf(dieline, loop[i]);
      const Vector2d end = dieline::pointAt(curve, 1.0);
      const dieline::Curve& next = curveOf(dieline, loop[(i + 1) % loop.size()]);
      const double gap =
          std::min((dieline::pointAt(next, 0.0) - end).norm(), (dieline::pointAt(next, 1.0) - end).norm());
      for (int k = 0; k < 100; ++k)
        polygon.push_back(dieline::pointAt(curve, gap < 1e-6 ? k / 100.0 : 1.0 - k / 100.0));
    }
    polygons.push_back(std::move(polygon));
  }
  return polygons;
}

/// Whether a place belongs to a piece that is kept: within an odd number of closed cuts.
bool isKept(const std::vector<Places>& polygons, const Vector2d& p) {
  bool kept = false;
  for (const Places& polygon : polygons) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vector2d& a = polygon[i];
      const Vector2d& b = polygon[(i + 1) % polygon.size()];
      if ((a.y() > p.y()) == (b.y() > p.y())) continue;
      if (p.x() < a.x() + (p.y() - a.y()) * (b.x() - a.x()) / (b.y() - a.y())) kept = !kept;
    }
  }
  return kept;
}

struct Combination {
  Order order{Order::kShortest};
  std::string entities, layers, processes;
  double radius_mm{};
  OpenCuts open_cuts{OpenCuts::kOnTheLine};

  [[nodiscard]] JobParameters job() const {
    JobParameters job = test::mirrorJob();
    job.order = order;
    job.kerf_radius_mm = radius_mm;
    job.open_cuts = open_cuts;
    return job;
  }
  [[nodiscard]] dieline::Dieline part() const {
    dieline::Dieline dieline = drawing();
    select(dieline, selectionFrom(entities, layers, processes));
    return dieline;
  }
  [[nodiscard]] std::string name() const {
    return fmt::format("order {}, entities '{}', layers '{}', process '{}', radius {} mm, open cuts {}",
                       static_cast<int>(order), entities, layers, processes, radius_mm,
                       static_cast<int>(open_cuts));
  }
};

/// All orders, selections, radii and sides of open cuts.
std::vector<Combination> combinations() {
  std::vector<Combination> selections;
  for (const char* entities : {"", "7", "2,3", "8-15", "21", "0,12,20-22"})
    selections.push_back({.entities = entities});
  for (const char* layers : {"holes", "islands,slits", "knife,folds"})
    selections.push_back({.layers = layers});
  for (const char* processes : {"cut", "crease,perforation"}) selections.push_back({.processes = processes});
  selections.push_back({.entities = "3-17", .layers = "holes,knife"});
  selections.push_back({.entities = "5-22", .layers = "knife,islands,slits,round", .processes = "cut"});
  std::vector<Combination> all;
  for (Combination c : selections) {
    for (c.order = Order::kShortest;;
         c.order = c.order == Order::kShortest ? Order::kNearest : Order::kDrawn) {
      for (const double radius_mm : {0.0, 0.05, 0.2}) {
        for (const OpenCuts side : {OpenCuts::kOnTheLine, OpenCuts::kLeft, OpenCuts::kRight}) {
          c.radius_mm = radius_mm;
          c.open_cuts = side;
          if (radius_mm > 0.0 || side == OpenCuts::kOnTheLine) all.push_back(c);
        }
      }
      if (c.order == Order::kDrawn) break;
    }
  }
  return all;
}

bool isClosedCut(int entity) { return entity < 16 || entity == 22; }
bool isSlit(int entity) { return entity == kFirstSlit || entity == kSecondSlit; }

/// Distance that the beam has to keep from the middle of an entity, > 0 to its left in its own sense.
double wantedMm(const Combination& c, const dieline::Dieline& dieline, const std::vector<Places>& polygons,
                int entity) {
  const dieline::Curve& curve = curveOf(dieline, entity);
  const Vector2d t = dieline::tangentAt(curve, 0.5);
  if (isClosedCut(entity)) {
    const Vector2d left = dieline::pointAt(curve, 0.5) + 0.03 * Vector2d(-t.y(), t.x());
    return isKept(polygons, left) ? -c.radius_mm : c.radius_mm;
  }
  if (!isSlit(entity) || c.open_cuts == OpenCuts::kOnTheLine) return 0.0;
  // The sense is that of the first line; the second is drawn against it.
  return ((c.open_cuts == OpenCuts::kLeft) == (entity == kFirstSlit)) ? c.radius_mm : -c.radius_mm;
}

void expectBesideItsMiddle(const Combination& c, const dieline::Dieline& dieline,
                           const std::vector<Places>& polygons, const std::vector<Places>& paths,
                           int entity) {
  const dieline::Curve& curve = curveOf(dieline, entity);
  const double wanted_mm = wantedMm(c, dieline, polygons, entity);
  for (const double u : {0.4, 0.5, 0.6}) {
    const Vector2d t = dieline::tangentAt(curve, u);
    const Vector2d p = dieline::pointAt(curve, u);
    const double reach_mm = entity == 19 ? 1.1 : 0.0;  // The gap of a perforation.
    EXPECT_LT(distanceTo(paths, p + wanted_mm * Vector2d(-t.y(), t.x())), kText_mm + reach_mm)
        << "E" << entity;
    if (entity != 19) {
      EXPECT_NEAR(distanceTo(paths, p), std::abs(wanted_mm), kText_mm) << "E" << entity;
    }
  }
}

/// No place of the beam on a closed cut is nearer to any closed cut of the whole drawing than the radius, or
/// in a piece.
void expectClear(const Combination& c, const dieline::Dieline& dieline, const std::vector<Places>& polygons,
                 const std::vector<Places>& paths, int entity) {
  double nearest = INFINITY;
  double farthest = 0.0;
  for (const Places& path : paths) {
    for (const Vector2d& p : path) {
      double distance = INFINITY;
      for (const dieline::Entity& other : dieline.entities) {
        if (isClosedCut(other.id))
          distance = std::min(distance, dieline::nearestOn(other.curve, p).distance_mm);
      }
      nearest = std::min(nearest, distance);
      farthest = std::max(farthest, distance);
      if (c.radius_mm > 0.0) {
        EXPECT_FALSE(isKept(polygons, p)) << "E" << entity << " burns the piece at " << p.transpose();
      }
    }
  }
  EXPECT_GT(nearest, c.radius_mm - kText_mm) << "E" << entity;
  EXPECT_LT(farthest, std::numbers::sqrt2 * c.radius_mm + kText_mm)
      << "E" << entity;  // Right angles are extended.
}

TEST(Combinations, NoOrderSelectionRadiusOrSideBurnsAPiece) {
  const dieline::Dieline whole = drawing();
  const std::vector<Places> polygons = polygonsOf(whole);
  for (const Combination& c : combinations()) {
    SCOPED_TRACE(c.name());
    const dieline::Dieline part = c.part();
    const Decoded job = decoded(makeGcode(part, test::twoMirror(), c.job()));
    for (const dieline::Entity& entity : part.entities) {
      const bool wanted = !entity.left_out;
      ASSERT_EQ(job.marks.count(entity.id), wanted ? 1U : 0U) << "E" << entity.id;
      if (!wanted) continue;
      expectBesideItsMiddle(c, whole, polygons, job.marks.at(entity.id), entity.id);
      if (isClosedCut(entity.id)) expectClear(c, whole, polygons, job.marks.at(entity.id), entity.id);
    }
    if (c.order == Order::kDrawn) {
      EXPECT_TRUE(std::ranges::is_sorted(job.sequence));
    }
    if (HasFailure()) return;
  }
}

TEST(Combinations, TheJudgeExpectsTheKerfWhereThePlannerPutsIt) {
  const dieline::Dieline whole = drawing();
  const std::vector<Places> polygons = polygonsOf(whole);
  for (const Combination& c : combinations()) {
    if (c.order != Order::kShortest || c.radius_mm != 0.2) continue;
    SCOPED_TRACE(c.name());
    const dieline::Dieline part = c.part();
    using Judged = inspect::Tolerances;
    const auto open_cuts = c.open_cuts == OpenCuts::kLeft    ? Judged::OpenCuts::kLeft
                           : c.open_cuts == OpenCuts::kRight ? Judged::OpenCuts::kRight
                                                             : Judged::OpenCuts::kCentre;
    const auto sides = inspect::checks::kerfSides(part, Judged::Edge::kNesting, open_cuts);
    EXPECT_TRUE(sides.problems.empty());
    for (const dieline::Entity& entity : part.entities) {
      const double wanted_mm = entity.left_out ? 0.0 : wantedMm(c, whole, polygons, entity.id);
      EXPECT_EQ(sides.side[static_cast<std::size_t>(entity.id)], std::lround(wanted_mm / c.radius_mm))
          << entity.id;
    }
  }
}

/// Cells of 0.02 mm that the drawing's cuts lie in, by rows.
class Cells {
 public:
  static constexpr double kSide_mm = 0.02;

  void burn(const Vector2d& p, double radius_mm) {
    const Vector2d cell = (p - origin_) / kSide_mm;
    const int reach = static_cast<int>(radius_mm / kSide_mm) + 1;
    for (int y = static_cast<int>(cell.y()) - reach; y <= static_cast<int>(cell.y()) + reach; ++y) {
      for (int x = static_cast<int>(cell.x()) - reach; x <= static_cast<int>(cell.x()) + reach; ++x) {
        if (x < 0 || y < 0 || x >= kColumns || y >= kRows) continue;
        if ((centreOf(x, y) - p).squaredNorm() < radius_mm * radius_mm) burnt_[indexOf(x, y)] = true;
      }
    }
  }

  /// Area of the cells that are not burnt and belong to a piece: between every second crossing of a row.
  [[nodiscard]] double keptMm2(const std::vector<Places>& polygons) const {
    std::size_t kept = 0;
    for (int y = 0; y < kRows; ++y) {
      std::vector<double> crossings;
      const double at = centreOf(0, y).y();
      for (const Places& polygon : polygons) {
        for (std::size_t i = 0; i < polygon.size(); ++i) {
          const Vector2d& a = polygon[i];
          const Vector2d& b = polygon[(i + 1) % polygon.size()];
          if ((a.y() > at) != (b.y() > at))
            crossings.push_back(a.x() + (at - a.y()) * (b.x() - a.x()) / (b.y() - a.y()));
        }
      }
      std::sort(crossings.begin(), crossings.end());
      std::size_t passed = 0;
      for (int x = 0; x < kColumns; ++x) {
        while (passed < crossings.size() && crossings[passed] < centreOf(x, y).x()) ++passed;
        kept += passed % 2 == 1 && !burnt_[indexOf(x, y)] ? 1 : 0;
      }
    }
    return static_cast<double>(kept) * kSide_mm * kSide_mm;
  }

 private:
  static constexpr int kColumns = 750;
  static constexpr int kRows = 1070;
  static std::size_t indexOf(int x, int y) {
    return static_cast<std::size_t>(y) * kColumns + static_cast<std::size_t>(x);
  }
  [[nodiscard]] Vector2d centreOf(int x, int y) const {
    return origin_ + kSide_mm * Vector2d(x + 0.5, y + 0.5);
  }

  Vector2d origin_{-16.5, -6.5};
  std::vector<bool> burnt_ = std::vector<bool>(std::size_t{kColumns} * kRows);
};

/// Area that two holes leave of three labels and an island, and the length of all of their contours.
std::pair<double, double> drawnAreaAndLength(const std::vector<Places>& polygons) {
  double area_mm2 = 0.0;
  double length_mm = 0.0;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    double doubled = 0.0;
    const Places& polygon = polygons[i];
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Vector2d& a = polygon[k];
      const Vector2d& b = polygon[(k + 1) % polygon.size()];
      doubled += a.x() * b.y() - a.y() * b.x();
      length_mm += (b - a).norm();
    }
    area_mm2 += (i == 1 || i == 2 ? -0.5 : 0.5) * std::abs(doubled);
  }
  return {area_mm2, length_mm};
}

double keptMm2(const Combination& c, const PlannerFaults& faults) {
  Cells cells;
  const std::string gcode = makeGcode(c.part(), test::twoMirror(), c.job(), faults);
  for (const auto& [entity, paths] : decoded(gcode).marks) {
    for (const Places& path : paths) {
      for (std::size_t i = 0; i + 1 < path.size(); ++i) {
        const int parts = 1 + static_cast<int>((path[i + 1] - path[i]).norm() / 0.03);
        for (int k = 0; k < parts; ++k)
          cells.burn(path[i] + (path[i + 1] - path[i]) * k / parts, c.radius_mm);
      }
    }
  }
  return cells.keptMm2(polygonsOf(drawing()));
}

TEST(Combinations, ThePiecesKeepTheirArea) {
  const auto [drawn_mm2, length_mm] = drawnAreaAndLength(polygonsOf(drawing()));
  for (const Order order : {Order::kShortest, Order::kDrawn}) {
    const Combination c{.order = order, .processes = "cut", .radius_mm = 0.2};
    EXPECT_NEAR(keptMm2(c, {}), drawn_mm2, 0.05 * Cells::kSide_mm * length_mm);
    // A beam on the wrong side takes its whole width.
    PlannerFaults faults;
    faults.kerf_wrong_side = true;
    EXPECT_NEAR(keptMm2(c, faults), drawn_mm2 - 2.0 * c.radius_mm * length_mm,
                0.05 * length_mm * c.radius_mm);
  }
}

}  // namespace
}  // namespace kerfbench::planner
