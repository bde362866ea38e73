// SPDX-License-Identifier: Apache-2.0
// Which side of a cut is the wanted piece: joined outlines and their nesting.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/dieline/outlines.h"
#include "hil/inspect/edges/edges.h"
#include "hil/inspect/evidence/places.h"

namespace kerfbench::inspect::checks {
namespace {

using dieline::OutlineStep;

bool isLeftOut(const dieline::Dieline& dieline, int id) {
  return dieline.entities[static_cast<std::size_t>(id)].left_out.has_value();
}

/// Whether any of the contour is selected, so that it is cut and judged.
bool isJudged(const dieline::Dieline& dieline, const std::vector<OutlineStep>& steps) {
  return !std::ranges::all_of(steps,
                              [&](const OutlineStep& step) { return isLeftOut(dieline, step.entity); });
}

double doubleArea(const std::vector<Eigen::Vector2d>& polygon) {
  double sum = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return sum;
}

/// Gives what is selected and does not close its side.
void sideOpen(const dieline::Dieline& dieline, const dieline::Outlines& outlines,
              Tolerances::OpenCuts open_cuts, EdgeSides& sides) {
  for (const std::vector<OutlineStep>& steps : outlines.open) {
    for (const OutlineStep& step : steps) {
      if (isLeftOut(dieline, step.entity)) continue;
      const bool centred = open_cuts == Tolerances::OpenCuts::kCentre;
      ++(centred ? sides.open : sides.open_beside);
      const bool left = (open_cuts == Tolerances::OpenCuts::kLeft) == step.forward;
      sides.side[static_cast<std::size_t>(step.entity)] = centred ? 0 : (left ? 1 : -1);
    }
  }
  for (const dieline::Branching& branching : outlines.branchings) {
    sides.problems.push_back(fmt::format(
        "At {} the cut E{}{} meets {} others: which side of it is the wanted piece cannot be told.",
        placeOf(branching.p_mm), branching.entity,
        isLeftOut(dieline, branching.entity) ? ", which is not selected but counts for the nesting," : "",
        branching.others));
  }
}

}  // namespace

EdgeSides kerfSides(const dieline::Dieline& dieline, Tolerances::Edge edge, Tolerances::OpenCuts open_cuts) {
  EdgeSides sides;
  sides.side.assign(dieline.entities.size(), 0);
  if (edge == Tolerances::Edge::kCentre) return sides;
  const dieline::Outlines outlines = dieline::outlinesOf(dieline, dieline::Process::kCut);
  sideOpen(dieline, outlines, open_cuts, sides);
  const std::vector<int> nestings = dieline::nestingsOf(outlines);
  for (std::size_t i = 0; i < outlines.closed.size(); ++i) {
    const dieline::Outline& outline = outlines.closed[i];
    if (!isJudged(dieline, outline.steps)) continue;
    const bool hole =
        edge == Tolerances::Edge::kInside || (edge == Tolerances::Edge::kNesting && nestings[i] % 2 == 1);
    ++(hole ? sides.holes : sides.outlines);
    const bool left = (doubleArea(outline.polygon_mm) > 0.0) == hole;
    for (const OutlineStep& step : outline.steps) {
      if (!isLeftOut(dieline, step.entity))
        sides.side[static_cast<std::size_t>(step.entity)] = left == step.forward ? 1 : -1;
    }
  }
  return sides;
}

}  // namespace kerfbench::inspect::checks
