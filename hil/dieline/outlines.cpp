// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/outlines.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "hil/dieline/lint_tree.h"

namespace kerfbench::dieline {
namespace {

constexpr double kPolygonPitch_mm = 0.5;
constexpr double kLeastSides = 24.0;
constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// One end of an open curve. Ends 2 i and 2 i + 1 are start and end of the i-th curve.
struct CurveEnd {
  Eigen::Vector2d p_mm{Eigen::Vector2d::Zero()};
  std::size_t partner{kNone};
  int partners{};
};

const Curve& curveOf(const Dieline& dieline, int id) {
  return dieline.entities[static_cast<std::size_t>(id)].curve;
}

/// Column of an end: ends that meet lie in one, or in neighbours.
double columnOf(const CurveEnd& end) { return std::floor(end.p_mm.x() / kEndsMeet_mm); }

void meet(std::vector<CurveEnd>& ends) {
  std::vector<std::size_t> order(ends.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(columnOf(ends[a]), ends[a].p_mm.y()) < std::pair(columnOf(ends[b]), ends[b].p_mm.y());
  });
  const auto tryPair = [&](std::size_t i, std::size_t j) {
    CurveEnd& a = ends[order[i]];
    CurveEnd& b = ends[order[j]];
    if ((b.p_mm - a.p_mm).norm() > kEndsMeet_mm) return;
    a.partner = order[j];
    b.partner = order[i];
    ++a.partners;
    ++b.partners;
  };
  std::size_t next = 0;  // The first end of the next column, or behind, that is not too low for this one.
  for (std::size_t i = 0; i < order.size(); ++i) {
    const CurveEnd& self = ends[order[i]];
    const double column = columnOf(self);
    const auto isIn = [&](std::size_t j, double wanted) {
      return j < order.size() && columnOf(ends[order[j]]) == wanted;
    };
    const auto dy_mm = [&](std::size_t j) { return ends[order[j]].p_mm.y() - self.p_mm.y(); };
    for (std::size_t j = i + 1; isIn(j, column) && dy_mm(j) <= kEndsMeet_mm; ++j) tryPair(i, j);
    while (next < order.size() && (columnOf(ends[order[next]]) <= column ||
                                   (isIn(next, column + 1.0) && dy_mm(next) < -kEndsMeet_mm)))
      ++next;
    for (std::size_t j = next; isIn(j, column + 1.0) && dy_mm(j) <= kEndsMeet_mm; ++j) tryPair(i, j);
  }
}

void append(const Curve& curve, bool forward, Outline& outline) {
  const Curve way = forward ? curve : reversed(curve);
  for (const double u : stations(way, std::min(kPolygonPitch_mm, lengthOf(way) / kLeastSides))) {
    outline.polygon_mm.push_back(pointAt(way, u));
    outline.box_mm.extend(outline.polygon_mm.back());
  }
}

/// Walks on from an end, `out`, over ends that meet one other. Adds the steps in their order on this way,
/// each with whether it is walked forwards. True if the way leads back to the end `home`.
bool walk(const std::vector<int>& ids, const std::vector<CurveEnd>& ends, std::size_t out, std::size_t home,
          std::vector<bool>& used, std::vector<OutlineStep>& steps) {
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

void join(const Dieline& dieline, const std::vector<int>& ids, const std::vector<CurveEnd>& ends,
          Outlines& outlines) {
  std::vector<bool> used(ids.size());
  for (std::size_t first = 0; first < ids.size(); ++first) {
    if (used[first]) continue;
    used[first] = true;
    std::vector<OutlineStep> steps{{ids[first], true}};
    if (walk(ids, ends, 2 * first + 1, 2 * first, used, steps)) {
      Outline& outline = outlines.closed.emplace_back();
      for (const OutlineStep& step : steps) append(curveOf(dieline, step.entity), step.forward, outline);
      outline.steps = std::move(steps);
      continue;
    }
    std::vector<OutlineStep> before;
    walk(ids, ends, 2 * first, 2 * first, used, before);
    for (const OutlineStep& step : before) steps.push_back({step.entity, !step.forward});
    outlines.open.push_back(std::move(steps));
  }
}

}  // namespace

Outlines outlinesOf(const Dieline& dieline, Process process) {
  Outlines outlines;
  std::vector<int> open;
  for (const Entity& entity : dieline.entities) {
    // A line without length has no inside and leads nowhere.
    if (drawnFor(entity) != process || !(lengthOf(entity.curve) > 0.0)) continue;
    if (!isClosed(entity.curve)) {
      open.push_back(entity.id);
      continue;
    }
    Outline& outline = outlines.closed.emplace_back();
    outline.steps.push_back({entity.id, true});
    append(entity.curve, true, outline);
  }
  std::vector<CurveEnd> ends;
  ends.reserve(2 * open.size());
  for (const int id : open) {
    ends.push_back({pointAt(curveOf(dieline, id), 0.0)});
    ends.push_back({pointAt(curveOf(dieline, id), 1.0)});
  }
  meet(ends);
  join(dieline, open, ends, outlines);
  for (std::size_t e = 0; e < ends.size(); ++e) {
    if (ends[e].partners > 1) outlines.branchings.push_back({open[e / 2], ends[e].partners, ends[e].p_mm});
  }
  return outlines;
}

bool contains(const std::vector<Eigen::Vector2d>& polygon_mm, const Eigen::Vector2d& p_mm) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon_mm.size(); ++i) {
    const Eigen::Vector2d& a = polygon_mm[i];
    const Eigen::Vector2d& b = polygon_mm[(i + 1) % polygon_mm.size()];
    if ((a.y() > p_mm.y()) == (b.y() > p_mm.y())) continue;
    if (p_mm.x() < a.x() + (p_mm.y() - a.y()) * (b.x() - a.x()) / (b.y() - a.y())) inside = !inside;
  }
  return inside;
}

std::vector<int> nestingsOf(const Outlines& outlines) {
  std::vector<LintTree::Leaf> boxes;
  for (std::uint32_t i = 0; i < outlines.closed.size(); ++i) {
    const Eigen::AlignedBox2d& box = outlines.closed[i].box_mm;
    boxes.push_back({{box.min().x(), box.min().y(), box.max().x(), box.max().y()}, i});
  }
  const LintTree tree(std::move(boxes));
  std::vector<int> nestings(outlines.closed.size());
  for (std::size_t i = 0; i < nestings.size(); ++i) {
    const std::vector<Eigen::Vector2d>& polygon_mm = outlines.closed[i].polygon_mm;
    const Eigen::Vector2d p_mm = polygon_mm[polygon_mm.size() / 3];
    const auto mayContain = [&](const LintSpan& span) {
      return p_mm.x() >= span.low[0] && p_mm.y() >= span.low[1] && p_mm.x() <= span.high[2] &&
             p_mm.y() <= span.high[3];
    };
    tree.any(mayContain, [&](const LintTree::Leaf& leaf) {
      if (leaf.item != i && mayContain({leaf.place, leaf.place}) &&
          contains(outlines.closed[leaf.item].polygon_mm, p_mm))
        ++nestings[i];
      return false;
    });
  }
  return nestings;
}

}  // namespace kerfbench::dieline
