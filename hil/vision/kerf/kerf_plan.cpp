// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_plan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hil/dieline/geometry.h"
#include "hil/vision/kerf/kerf_grid.h"

namespace kerfbench::vision {
namespace {

constexpr double kSamplePitchMm = 0.1;
constexpr double kWindowMm = 0.1;       // Half the length of curve that a caliper looks at.
constexpr double kParallelSine = 0.14;  // Sine of 8 degrees.
constexpr double kSameLineMm = 0.03;
constexpr double kOwnApartMm = 0.65;  // Distance along a curve from which on it is a neighbour of itself.
constexpr double kMeetMm = 0.02;      // Largest distance of ends that are drawn to touch.
constexpr double kAloneMm = 0.7;      // Distance around a corner or a free end without other curves.
/// On a bend tighter than this a caliper's straight window holds more turn than line, as at a corner.
constexpr double kTightestMm = 0.15;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Arc length between two near parameters, by Simpson's rule.
double stretch(const dieline::Curve& curve, double u0, double u1) {
  return (u1 - u0) / 6.0 *
         (dieline::derivativeAt(curve, u0).norm() +
          4.0 * dieline::derivativeAt(curve, 0.5 * (u0 + u1)).norm() +
          dieline::derivativeAt(curve, u1).norm());
}

std::vector<Station> stationsOf(const dieline::Curve& curve, double pitch_mm, double length_mm) {
  std::vector<Station> out;
  double s = 0.0;
  double before = 0.0;
  for (const double u : dieline::stations(curve, pitch_mm)) {
    if (!out.empty()) s += stretch(curve, before, u);
    before = u;
    out.push_back({.u = u,
                   .station_mm = s,
                   .p_S_mm = dieline::pointAt(curve, u),
                   .tangent = dieline::tangentAt(curve, u),
                   .curvature_per_mm = dieline::curvatureAt(curve, u)});
  }
  // What Simpson's rule leaves is spread along the curve.
  if (s > 0.0) {
    for (Station& station : out) station.station_mm *= length_mm / s;
  }
  return out;
}

/// Whether a sample of another entity only goes on where this one ends, or lies on top of it.
bool isSameLine(const Station& at, const CurveSample& other) {
  const Eigen::Vector2d d = other.p_S_mm - at.p_S_mm;
  const double along = std::abs(d.dot(at.tangent));
  const double across = std::abs(cross(at.tangent, d));
  const double bend = std::max(std::abs(at.curvature_per_mm), std::abs(other.curvature_per_mm));
  const bool parallel = std::abs(cross(at.tangent, other.tangent)) < kParallelSine + bend * d.norm();
  return parallel && across <= kSameLineMm + 0.75 * bend * along * along;
}

void hideOthers(Station& at, std::size_t index, EntityPlan& own, const SampleGrid& grid, double reach_mm) {
  at.hidden_begin = own.hidden_S_mm.size();
  grid.around(at.p_S_mm, [&](const CurveSample& other) {
    const Eigen::Vector2d d = other.p_S_mm - at.p_S_mm;
    if (std::abs(d.dot(at.tangent)) > kWindowMm + kHiddenMm) return;
    if (std::abs(cross(at.tangent, d)) > reach_mm + kHiddenMm) return;
    if (other.plan == index) {
      double apart_mm = std::abs(other.station_mm - at.station_mm);
      if (own.closed) apart_mm = std::min(apart_mm, own.length_mm - apart_mm);
      if (apart_mm <= kOwnApartMm) return;
      // Places straight on along the curve do not count as neighbours.
      if (std::abs(d.dot(at.tangent)) > std::abs(cross(at.tangent, d))) return;
    } else if (isSameLine(at, other)) {
      return;
    }
    own.hidden_S_mm.push_back(other.p_S_mm);
  });
  at.hidden_count = own.hidden_S_mm.size() - at.hidden_begin;
}

/// Whether a point has no other curve within the distance than those of `own`, whose far parts count too.
bool isAlone(const Eigen::Vector2d& p_S_mm, const std::vector<std::pair<std::size_t, double>>& own,
             const std::vector<EntityPlan>& plans, const SampleGrid& grid) {
  bool alone = true;
  grid.around(p_S_mm, [&](const CurveSample& other) {
    if ((other.p_S_mm - p_S_mm).norm() > kAloneMm) return;
    for (const auto& [plan, station_mm] : own) {
      double apart_mm = std::abs(other.station_mm - station_mm);
      if (plans[plan].closed) apart_mm = std::min(apart_mm, plans[plan].length_mm - apart_mm);
      if (other.plan == plan && apart_mm <= 2.0 * kAloneMm) return;
    }
    alone = false;
  });
  return alone;
}

std::vector<EntityEnd> endsOf(const std::vector<EntityPlan>& plans) {
  std::vector<EntityEnd> ends;
  for (std::size_t i = 0; i < plans.size(); ++i) {
    const Station& first = plans[i].stations.front();
    const Station& last = plans[i].stations.back();
    ends.push_back({i, true, first.p_S_mm, -first.tangent});
    ends.push_back({i, false, last.p_S_mm, last.tangent});
  }
  return ends;
}

PlannedCorner cornerOf(const EntityEnd& a, const EntityEnd& b) {
  // The path runs through the corner in the sense of the entity that ends there, if one does.
  const bool turned = a.at_start && !b.at_start;
  PlannedCorner corner{.in = turned ? b : a, .out = turned ? a : b};
  corner.tangent_in = corner.in.outward;
  corner.tangent_out = -corner.out.outward;
  corner.turn_rad =
      std::atan2(cross(corner.tangent_in, corner.tangent_out), corner.tangent_in.dot(corner.tangent_out));
  return corner;
}

double stationOf(const EntityEnd& end, const std::vector<EntityPlan>& plans) {
  return end.at_start ? 0.0 : plans[end.plan].length_mm;
}

void markNearCorner(const EntityEnd& end, double clearance_mm, std::vector<EntityPlan>& plans) {
  for (Station& station : plans[end.plan].stations) {
    if (std::abs(station.station_mm - stationOf(end, plans)) <= 2.0 * clearance_mm &&
        (station.p_S_mm - end.p_S_mm).norm() <= clearance_mm) {
      station.near_corner = true;
    }
  }
}

void findJoints(const SampleGrid& grid, const SampleGrid& end_grid, const std::vector<EntityEnd>& ends,
                double clearance_mm, KerfPlan& plan) {
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const EntityEnd& end = ends[i];
    std::vector<std::size_t> meeting;
    end_grid.around(end.p_S_mm, [&](const CurveSample& other) {
      if (other.plan != i && (other.p_S_mm - end.p_S_mm).norm() <= kMeetMm) meeting.push_back(other.plan);
    });
    const auto turns = [&](std::size_t other) {
      return end.outward.dot(-ends[other].outward) < std::sqrt(1.0 - kParallelSine * kParallelSine);
    };
    if (std::any_of(meeting.begin(), meeting.end(), turns)) markNearCorner(end, clearance_mm, plan.entities);
    if (meeting.empty()) {
      if (isAlone(end.p_S_mm, {{end.plan, stationOf(end, plan.entities)}}, plan.entities, grid)) {
        plan.free_ends.push_back(end);
      }
      continue;
    }
    const std::size_t other = meeting.front();
    if (meeting.size() > 1 || other < i) continue;
    const EntityEnd& second = ends[other];
    const std::vector<std::pair<std::size_t, double>> own{{end.plan, stationOf(end, plan.entities)},
                                                          {second.plan, stationOf(second, plan.entities)}};
    if (!isAlone(end.p_S_mm, own, plan.entities, grid)) continue;
    if (turns(other)) {
      plan.corners.push_back(cornerOf(end, second));
    } else if (end.plan == second.plan) {
      plan.closures.push_back(end);
    }
  }
}

/// Fillets of next to no radius join lines without a corner, and are one to a caliper. A closed curve as
/// small is a hole, which its own calipers measure.
void markTightBends(double clearance_mm, std::vector<EntityPlan>& plans) {
  SampleGrid bends(clearance_mm);
  bool any = false;
  for (const EntityPlan& plan : plans) {
    if (plan.closed) continue;
    for (const Station& s : plan.stations) {
      if (std::abs(s.curvature_per_mm) * kTightestMm <= 1.0) continue;
      bends.add({s.p_S_mm, s.tangent, s.curvature_per_mm, s.station_mm, 0});
      any = true;
    }
  }
  if (!any) return;
  for (EntityPlan& plan : plans) {
    for (Station& station : plan.stations) {
      bends.around(station.p_S_mm, [&](const CurveSample& bend) {
        if ((bend.p_S_mm - station.p_S_mm).norm() <= clearance_mm) station.near_corner = true;
      });
    }
  }
}

/// Where a cut lies on a crease, a half-cut or a perforation, its kerf is what a caliper sees there.
void markUnderCuts(const SampleGrid& grid, std::vector<EntityPlan>& plans) {
  for (EntityPlan& own : plans) {
    if (own.process == dieline::Process::kCut) continue;
    for (Station& station : own.stations) {
      grid.around(station.p_S_mm, [&](const CurveSample& other) {
        if (plans[other.plan].process != dieline::Process::kCut || !isSameLine(station, other)) return;
        if ((other.p_S_mm - station.p_S_mm).norm() <= kSamplePitchMm) station.near_corner = true;
      });
    }
  }
}

const Station& nearestTo(const Station& at, const std::vector<Station>& stations) {
  return *std::ranges::min_element(stations, {},
                                   [&](const Station& s) { return std::abs(s.station_mm - at.station_mm); });
}

}  // namespace

KerfPlan planKerf(const dieline::Dieline& dieline, const KerfScanOptions& options) {
  KerfPlan plan;
  const double reach_mm = std::hypot(options.reach_mm + kHiddenMm, kWindowMm + kHiddenMm);
  const double cell_mm = std::max({kAloneMm, reach_mm, options.joint_clearance_mm});
  SampleGrid grid(cell_mm);
  SampleGrid end_grid(cell_mm);
  for (const dieline::Entity& entity : dieline.entities) {
    if (entity.process == dieline::Process::kIgnore) continue;
    EntityPlan own;
    own.entity = entity.id;
    own.process = entity.process;
    own.length_mm = dieline::lengthOf(entity.curve);
    own.closed = dieline::isClosed(entity.curve);
    own.stations = stationsOf(entity.curve, options.station_pitch_mm, own.length_mm);
    if (own.process == dieline::Process::kPerforation)
      own.light_stations = stationsOf(entity.curve, kLightPitchMm, own.length_mm);
    for (const Station& s : stationsOf(entity.curve, kSamplePitchMm, own.length_mm)) {
      grid.add({s.p_S_mm, s.tangent, s.curvature_per_mm, s.station_mm, plan.entities.size()});
    }
    plan.entities.push_back(std::move(own));
  }
  const std::vector<EntityEnd> ends = endsOf(plan.entities);
  for (std::size_t i = 0; i < ends.size(); ++i) end_grid.add({ends[i].p_S_mm, ends[i].outward, 0.0, 0.0, i});
  findJoints(grid, end_grid, ends, options.joint_clearance_mm, plan);
  markTightBends(options.joint_clearance_mm, plan.entities);
  markUnderCuts(grid, plan.entities);
  for (std::size_t i = 0; i < plan.entities.size(); ++i) {
    EntityPlan& own = plan.entities[i];
    for (Station& station : own.stations) hideOthers(station, i, own, grid, options.reach_mm);
    for (Station& station : own.light_stations) {
      station.near_corner = nearestTo(station, own.stations).near_corner;
      hideOthers(station, i, own, grid, options.reach_mm);
    }
  }
  return plan;
}

}  // namespace kerfbench::vision
