// SPDX-License-Identifier: Apache-2.0
// Which side of a cut is the wanted piece: joined outlines and their nesting.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/edges/edges.h"
#include "hil/inspect/evidence/places.h"

namespace kerfbench::inspect::checks {
namespace {

constexpr double kMeet_mm = 0.02;  // Distance of ends that count as touching, as the kerf scan has it.
constexpr double kPolygonPitch_mm = 0.5;
constexpr double kLeastSides = 24.0;
constexpr std::size_t kNone = static_cast<std::size_t>(-1);

using Polygon = std::vector<Eigen::Vector2d>;

/// One end of an open curve. Ends 2 i and 2 i + 1 are start and end of the i-th curve.
struct End {
  Eigen::Vector2d p_mm{Eigen::Vector2d::Zero()};
  std::size_t partner{kNone};
  int partners{};
};

struct Step {
  int entity{};
  bool forward{};
};

struct Contour {
  std::vector<Step> steps;
  Polygon polygon;
  int nesting{};
};

bool isLeftOut(const dieline::Dieline& dieline, int id) {
  return dieline.entities[static_cast<std::size_t>(id)].left_out.has_value();
}

/// Whether any of the contour is selected, so that it is cut and judged.
bool isJudged(const dieline::Dieline& dieline, const std::vector<Step>& steps) {
  return !std::ranges::all_of(steps, [&](const Step& step) { return isLeftOut(dieline, step.entity); });
}

void meet(std::vector<End>& ends) {
  std::vector<std::size_t> order(ends.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return ends[a].p_mm.x() < ends[b].p_mm.x(); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      End& a = ends[order[i]];
      End& b = ends[order[j]];
      if (b.p_mm.x() - a.p_mm.x() > kMeet_mm) break;
      if ((b.p_mm - a.p_mm).norm() > kMeet_mm) continue;
      a.partner = order[j];
      b.partner = order[i];
      ++a.partners;
      ++b.partners;
    }
  }
}

void append(const dieline::Curve& curve, bool forward, Polygon& polygon) {
  const dieline::Curve way = forward ? curve : dieline::reversed(curve);
  for (const double u :
       dieline::stations(way, std::min(kPolygonPitch_mm, dieline::lengthOf(way) / kLeastSides)))
    polygon.push_back(dieline::pointAt(way, u));
}

double doubleArea(const Polygon& polygon) {
  double sum = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return sum;
}

bool contains(const Polygon& polygon, const Eigen::Vector2d& p_mm) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    if ((a.y() > p_mm.y()) == (b.y() > p_mm.y())) continue;
    if (p_mm.x() < a.x() + (p_mm.y() - a.y()) * (b.x() - a.x()) / (b.y() - a.y())) inside = !inside;
  }
  return inside;
}

/// Walks on from an end, `out`, over ends that meet one other. Adds the steps in their order on this way,
/// each with whether it is walked forwards. True if the way leads back to the end `home`.
bool walk(const std::vector<int>& ids, const std::vector<End>& ends, std::size_t out, std::size_t home,
          std::vector<bool>& used, std::vector<Step>& steps) {
  while (ends[out].partners == 1) {
    const std::size_t in = ends[out].partner;
    if (in == home) return true;
    if (used[in / 2]) return false;
    used[in / 2] = true;
    steps.push_back({ids[in / 2], in % 2 == 0});
    out = in ^ 1U;
  }
  return false;
}

/// Contours that the curves of `ids` make, open or closed. An open one has the sense of its first curve.
struct Joined {
  std::vector<Contour> closed;
  std::vector<std::vector<Step>> open;
};

Joined joined(const std::vector<int>& ids, const std::vector<End>& ends) {
  Joined all;
  std::vector<bool> used(ids.size());
  for (std::size_t first = 0; first < ids.size(); ++first) {
    if (used[first]) continue;
    used[first] = true;
    std::vector<Step> steps{{ids[first], true}};
    if (walk(ids, ends, 2 * first + 1, 2 * first, used, steps)) {
      all.closed.push_back({std::move(steps), {}, 0});
      continue;
    }
    std::vector<Step> before;
    walk(ids, ends, 2 * first, 2 * first, used, before);
    for (const Step& step : before) steps.push_back({step.entity, !step.forward});
    all.open.push_back(std::move(steps));
  }
  return all;
}

/// Joins the open curves of `ids` to closed contours; gives what is selected and does not close its side.
void joinContours(const dieline::Dieline& dieline, const std::vector<int>& ids,
                  Tolerances::OpenCuts open_cuts, std::vector<Contour>& contours, EdgeSides& sides) {
  const auto curveOf = [&](int id) -> const dieline::Curve& {
    return dieline.entities[static_cast<std::size_t>(id)].curve;
  };
  std::vector<End> ends(2 * ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    ends[2 * i].p_mm = dieline::pointAt(curveOf(ids[i]), 0.0);
    ends[2 * i + 1].p_mm = dieline::pointAt(curveOf(ids[i]), 1.0);
  }
  meet(ends);
  Joined all = joined(ids, ends);
  for (Contour& contour : all.closed) {
    for (const Step& step : contour.steps) append(curveOf(step.entity), step.forward, contour.polygon);
    contours.push_back(std::move(contour));
  }
  for (const std::vector<Step>& steps : all.open) {
    for (const Step& step : steps) {
      if (isLeftOut(dieline, step.entity)) continue;
      const bool centred = open_cuts == Tolerances::OpenCuts::kCentre;
      ++(centred ? sides.open : sides.open_beside);
      const bool left = (open_cuts == Tolerances::OpenCuts::kLeft) == step.forward;
      sides.side[static_cast<std::size_t>(step.entity)] = centred ? 0 : (left ? 1 : -1);
    }
  }
  for (std::size_t e = 0; e < ends.size(); ++e) {
    if (ends[e].partners < 2) continue;
    sides.problems.push_back(fmt::format(
        "At {} the cut E{}{} meets {} others: which side of it is the wanted piece cannot be told.",
        placeOf(ends[e].p_mm), ids[e / 2],
        isLeftOut(dieline, ids[e / 2]) ? ", which is not selected but counts for the nesting," : "",
        ends[e].partners));
  }
}

}  // namespace

EdgeSides kerfSides(const dieline::Dieline& dieline, Tolerances::Edge edge, Tolerances::OpenCuts open_cuts) {
  EdgeSides sides;
  sides.side.assign(dieline.entities.size(), 0);
  if (edge == Tolerances::Edge::kCentre) return sides;
  std::vector<Contour> contours;
  std::vector<int> open;
  for (const dieline::Entity& entity : dieline.entities) {
    if (dieline::drawnFor(entity) != dieline::Process::kCut) continue;
    if (!dieline::isClosed(entity.curve)) {
      open.push_back(entity.id);
      continue;
    }
    Contour& contour = contours.emplace_back();
    contour.steps.push_back({entity.id, true});
    append(entity.curve, true, contour.polygon);
  }
  joinContours(dieline, open, open_cuts, contours, sides);
  for (Contour& contour : contours) {
    if (!isJudged(dieline, contour.steps)) continue;
    const Eigen::Vector2d p_mm = contour.polygon[contour.polygon.size() / 3];
    for (const Contour& other : contours) {
      if (&other != &contour && contains(other.polygon, p_mm)) ++contour.nesting;
    }
    const bool hole =
        edge == Tolerances::Edge::kInside || (edge == Tolerances::Edge::kNesting && contour.nesting % 2 == 1);
    ++(hole ? sides.holes : sides.outlines);
    const bool left = (doubleArea(contour.polygon) > 0.0) == hole;
    for (const Step& step : contour.steps) {
      if (!isLeftOut(dieline, step.entity))
        sides.side[static_cast<std::size_t>(step.entity)] = left == step.forward ? 1 : -1;
    }
  }
  return sides;
}

}  // namespace kerfbench::inspect::checks
