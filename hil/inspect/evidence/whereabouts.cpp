// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/evidence/whereabouts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "hil/dieline/geometry.h"

namespace kerfbench::inspect {
namespace {

/// A time of the pins is that of a frame if one was taken within so many periods of the camera.
constexpr double kNearPeriods = 2.0;

struct PassedAt {
  double distance_mm{std::numeric_limits<double>::infinity()};
  double time_s{};
  double within_s{};
};

bool follows(const LitFrame& frame, int entity) {
  return frame.entity == entity || (frame.entity < 0 && frame.left_entity == entity);
}

/// Where the spot was nearest to a place on its way from one frame to the next.
PassedAt between(const LitFrame& from, const LitFrame& to, const Eigen::Vector2d& p_mm) {
  const Eigen::Vector2d way = to.p_S_mm - from.p_S_mm;
  const double square = way.squaredNorm();
  const double share = square > 0.0 ? std::clamp((p_mm - from.p_S_mm).dot(way) / square, 0.0, 1.0) : 0.0;
  return {(from.p_S_mm + share * way - p_mm).norm(), std::lerp(from.time_s, to.time_s, share),
          0.5 * (to.time_s - from.time_s)};
}

/// The nearest passing of one unit's place; of the line `entity` alone unless that is absent.
PassedAt nearestPassing(const LitFrames& lit, int unit, std::optional<int> entity,
                        const Eigen::Vector2d& p_mm) {
  PassedAt nearest;
  for (const LitRun& run : lit.runs) {
    for (std::size_t i = run.begin; i < run.end; ++i) {
      const LitFrame& from = lit.frames[i];
      const LitFrame& to = lit.frames[std::min(i + 1, run.end - 1)];
      if (from.unit != unit || (entity && !follows(from, *entity) && !follows(to, *entity))) continue;
      PassedAt here = between(from, to, p_mm);
      if (&from == &to) here.within_s = 0.5 * lit.period_s;
      if (here.distance_mm < nearest.distance_mm) nearest = here;
    }
  }
  return nearest;
}

void addTime(Whereabouts& where, const LitFrames& lit, Whereabouts::Time kind) {
  const Eigen::Vector2d p_mm(where.x_mm, where.y_mm);
  PassedAt passed;
  double reach_mm = kReach_mm;
  if (where.entity >= 0) passed = nearestPassing(lit, where.unit, where.entity, p_mm);
  if (!(passed.distance_mm <= reach_mm)) {
    passed = nearestPassing(lit, where.unit, std::nullopt, p_mm);
    reach_mm = kSearch_mm;
  }
  if (!(passed.distance_mm <= reach_mm)) return;
  where.time = kind;
  where.time_s = passed.time_s;
  where.within_s = passed.within_s;
}

void addPlace(Whereabouts& where, const LitFrames& lit) {
  const auto after = std::ranges::lower_bound(lit.frames, where.time_s, {}, &LitFrame::time_s);
  const LitFrame* nearest = nullptr;
  const auto consider = [&](const LitFrame& frame) {
    const double away_s = std::abs(frame.time_s - where.time_s);
    if (!(away_s <= kNearPeriods * lit.period_s)) return;
    if (nearest == nullptr || away_s < std::abs(nearest->time_s - where.time_s)) nearest = &frame;
  };
  if (after != lit.frames.end()) consider(*after);
  if (after != lit.frames.begin()) consider(*(after - 1));
  if (nearest == nullptr || (where.unit >= 0 && nearest->unit != where.unit)) return;
  where.unit = nearest->unit;
  if (where.entity < 0) where.entity = std::max(nearest->entity, nearest->left_entity);
  where.x_mm = nearest->p_S_mm.x();
  where.y_mm = nearest->p_S_mm.y();
}

}  // namespace

Whereabouts onLine(int unit, int entity) {
  Whereabouts where;
  where.unit = unit;
  where.entity = entity;
  return where;
}

Whereabouts atPlace(int unit, int entity, const Eigen::Vector2d& p_S_mm) {
  Whereabouts where = onLine(unit, entity);
  where.x_mm = p_S_mm.x();
  where.y_mm = p_S_mm.y();
  return where;
}

Whereabouts inFrame(const LitFrame& frame) {
  Whereabouts where = atPlace(frame.unit, std::max(frame.entity, frame.left_entity), frame.p_S_mm);
  where.time = Whereabouts::Time::kFrame;
  where.time_s = frame.time_s;
  return where;
}

Whereabouts atTime(double time_s) {
  Whereabouts where;
  if (std::isnan(time_s)) return where;
  where.time = Whereabouts::Time::kPins;
  where.time_s = time_s;
  return where;
}

void complete(Whereabouts& where, const LitFrames& lit, const dieline::Dieline& dieline) {
  if (where.hasTime()) {
    if (!where.hasPlace()) addPlace(where, lit);
    return;
  }
  if (where.unit < 0) return;
  if (where.hasPlace()) {
    addTime(where, lit, Whereabouts::Time::kPassing);
    return;
  }
  if (where.entity < 0 || where.entity >= static_cast<int>(dieline.entities.size())) return;
  const dieline::Curve& curve = dieline.entities[static_cast<std::size_t>(where.entity)].curve;
  const Eigen::Vector2d middle_mm = dieline::pointAt(curve, 0.5);
  where.x_mm = middle_mm.x();
  where.y_mm = middle_mm.y();
  addTime(where, lit, Whereabouts::Time::kMidway);
}

}  // namespace kerfbench::inspect
