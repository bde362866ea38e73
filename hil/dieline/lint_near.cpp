// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/lint_near.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;

constexpr double kTouch_mm = kSame_mm + 1e-6;       // Rounding of what is exactly kSame_mm away.
constexpr double kApart_mm = kOverlap_mm * 0.9999;  // Both ends of a shared length are farther apart.

constexpr std::size_t kMostEndsAtOne = 16;

/// One end of the lines of a node.
struct EndSpan {
  Vector2d low;
  Vector2d high;
};
EndSpan firstEnds(const LintSpan& span) { return {{span.low[0], span.low[1]}, {span.high[0], span.high[1]}}; }
EndSpan lastEnds(const LintSpan& span) { return {{span.low[2], span.low[3]}, {span.high[2], span.high[3]}}; }

/// True if some of the box is at least kApart_mm from p.
bool isApart(const EndSpan& box, const Vector2d& p_mm) {
  const double dx = std::max(p_mm.x() - box.low.x(), box.high.x() - p_mm.x());
  const double dy = std::max(p_mm.y() - box.low.y(), box.high.y() - p_mm.y());
  return dx * dx + dy * dy >= kApart_mm * kApart_mm;
}

/// Twice the length by which a box reaches to either side of its centre along a normal.
double reachAlong(const Vector2d& normal, const EndSpan& box) {
  return std::abs(normal.x()) * (box.high.x() - box.low.x()) +
         std::abs(normal.y()) * (box.high.y() - box.low.y());
}

/// A line in the order of x.
LintPlace endsOf(const LintItem& item) {
  const Vector2d& a = item.samples.front();
  const Vector2d& b = item.samples.back();
  const bool is_forward = a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  const Vector2d& first = is_forward ? a : b;
  const Vector2d& last = is_forward ? b : a;
  return {first.x(), first.y(), last.x(), last.y()};
}

LintPlace cornersOf(const LintItem& item) {
  return {item.box.min().x(), item.box.min().y(), item.box.max().x(), item.box.max().y()};
}

LintPlace arcPlace(const ArcCurve& arc) { return {arc.centre_mm.x(), arc.centre_mm.y(), arc.radius_mm, 0.0}; }

}  // namespace

/// Lines that share a length with a given one. Either end of what two lines share is an end of one of them
/// that lies on the other. So both ends of the one are on the other, or one of each, apart from each other.
struct LintNear::Search {
  explicit Search(const LintItem& item)
      : p(item.samples.front()),
        q(item.samples.back()),
        low(item.box.min().array() - kTouch_mm),
        high(item.box.max().array() + kTouch_mm),
        normal(p.y() - q.y(), q.x() - p.x()),
        margin(2 * kTouch_mm * normal.lpNorm<1>()) {}

  /// True if the line may pass within kTouch_mm of some of the box.
  [[nodiscard]] bool passes(const EndSpan& box) const {
    if (box.high.x() < low.x() || box.low.x() > high.x() || box.high.y() < low.y() || box.low.y() > high.y())
      return false;
    return std::abs(normal.dot(box.low + box.high - 2 * p)) <= reachAlong(normal, box) + margin;
  }

  [[nodiscard]] bool mayShare(const LintSpan& span) const {
    if (span.high[2] < low.x() || span.low[0] > high.x() || std::max(span.high[1], span.high[3]) < low.y() ||
        std::min(span.low[1], span.low[3]) > high.y())
      return false;
    const EndSpan first = firstEnds(span);
    const EndSpan last = lastEnds(span);
    const bool first_on_this = passes(first);
    const bool last_on_this = passes(last);
    if (first_on_this && last_on_this) return true;
    const bool p_on_it = LintNear::passes(span, p, kTouch_mm);
    const bool q_on_it = LintNear::passes(span, q, kTouch_mm);
    if (p_on_it && q_on_it) return true;
    return (first_on_this && ((p_on_it && isApart(first, p)) || (q_on_it && isApart(first, q)))) ||
           (last_on_this && ((p_on_it && isApart(last, p)) || (q_on_it && isApart(last, q))));
  }

  Vector2d p;
  Vector2d q;
  Vector2d low;
  Vector2d high;
  Vector2d normal;
  double margin;  ///< Twice kTouch_mm in the measure of the normal.
};

LintNear::LintNear(const std::vector<LintItem>& items, LintBudget& budget) : items_(items), budget_(budget) {
  std::vector<LintTree::Leaf> curves;
  std::vector<LintTree::Leaf> arcs;
  std::vector<LintTree::Leaf> ends_of_cuts;
  std::vector<LintTree::Leaf> other_ends;
  for (std::uint32_t i = 0; i < items.size(); ++i) {
    const LintItem& item = items[i];
    if (item.is_zero) continue;
    if (!isLintLine(item)) curves.push_back({cornersOf(item), i});
    if (const auto* arc = std::get_if<ArcCurve>(&item.entity->curve)) arcs.push_back({arcPlace(*arc), i});
    if (item.is_closed) continue;
    for (const std::uint32_t last : {0U, 1U}) {
      const Vector2d& p_mm = last == 0 ? item.samples.front() : item.samples.back();
      (item.isCut() ? ends_of_cuts : other_ends).push_back({{p_mm.x(), p_mm.y(), 0.0, 0.0}, 2 * i + last});
    }
  }
  curves_ = LintTree(std::move(curves));
  arcs_ = LintTree(std::move(arcs));
  ends_of_cuts_ = LintTree(std::move(ends_of_cuts));
  other_ends_ = LintTree(std::move(other_ends));
}

const LintTree& LintNear::lines() {
  if (!lines_.empty()) return lines_;
  std::vector<LintTree::Leaf> lines;
  for (std::uint32_t i = 0; i < items_.size(); ++i) {
    if (!items_[i].is_zero && isLintLine(items_[i])) lines.push_back({endsOf(items_[i]), i});
  }
  lines_ = LintTree(std::move(lines));
  return lines_;
}

bool LintNear::passes(const LintSpan& span, const Vector2d& p_mm, double r_mm) {
  if (p_mm.x() < span.low[0] - r_mm || p_mm.x() > span.high[2] + r_mm ||
      p_mm.y() < std::min(span.low[1], span.low[3]) - r_mm ||
      p_mm.y() > std::max(span.high[1], span.high[3]) + r_mm)
    return false;
  const EndSpan first = firstEnds(span);
  const EndSpan last = lastEnds(span);
  const Vector2d middle = first.low + first.high;
  const Vector2d along = last.low + last.high - middle;
  const Vector2d normal(-along.y(), along.x());
  const double reach = std::max(reachAlong(normal, first), reachAlong(normal, last));
  return std::abs(normal.dot(2 * p_mm - middle)) <= reach + 2 * r_mm * normal.lpNorm<1>();
}

bool LintNear::at(const LintTree& tree, const LintPlace& place, double r_mm, std::size_t most,
                  std::vector<std::uint32_t>& found) {
  const auto isNear = [&](const LintPlace& low, const LintPlace& high) {
    for (std::size_t k = 0; k < place.size(); ++k) {
      if (place[k] < low[k] - r_mm || place[k] > high[k] + r_mm) return false;
    }
    return true;
  };
  return !tree.any([&](const LintSpan& span) { return budget_.take() && isNear(span.low, span.high); },
                   [&](const LintTree::Leaf& leaf) {
                     if (budget_.take() && isNear(leaf.place, leaf.place)) found.push_back(leaf.item);
                     return found.size() > most;
                   });
}

bool LintNear::likeCurve(const LintItem& self, std::size_t most, std::vector<std::uint32_t>& found) {
  // A straight curve can be a copy of a line, drawn in either sense: one of its ends is at a given end of the
  // curve.
  const Vector2d& p = self.samples.front();
  std::size_t ends_at_p = 0;
  for (const bool of_cuts : {true, false}) {
    ends(of_cuts, p, kTouch_mm, [&](const LintEnd& end, double) {
      if (isLintLine(items_[end.item])) found.push_back(end.item);
      return ++ends_at_p > kMostEndsAtOne;
    });
  }
  if (ends_at_p > kMostEndsAtOne) {
    found.clear();
    const Vector2d& q = self.samples.back();
    if (!at(lines(), {p.x(), p.y(), q.x(), q.y()}, kTouch_mm, most, found) ||
        !at(lines(), {q.x(), q.y(), p.x(), p.y()}, kTouch_mm, most, found))
      return false;
  }
  const auto* arc = std::get_if<ArcCurve>(&self.entity->curve);
  return arc == nullptr || at(arcs_, arcPlace(*arc), kTouch_mm, most, found);
}

bool LintNear::onLine(std::uint32_t item, std::size_t most, std::vector<LintEnd>& found) {
  found.clear();
  const Search search(items_[item]);
  for (const LintTree* tree : {&ends_of_cuts_, &other_ends_}) {
    const bool is_crowded =
        tree->any([&](const LintSpan& span) { return budget_.take() && search.passes(firstEnds(span)); },
                  [&](const LintTree::Leaf& leaf) {
                    const Vector2d p_mm(leaf.place[0], leaf.place[1]);
                    if (leaf.item / 2 != item && budget_.take() && search.passes({p_mm, p_mm}))
                      found.push_back(endOf(leaf));
                    return found.size() > most;
                  });
    if (is_crowded) return false;
  }
  return true;
}

bool LintNear::mayShare(std::uint32_t a, std::uint32_t b) const {
  const LintPlace ends = endsOf(items_[b]);
  return Search(items_[a]).mayShare({ends, ends});
}

bool LintNear::like(std::uint32_t item, std::size_t most, std::vector<std::uint32_t>& found) {
  found.clear();
  const LintItem& self = items_[item];
  bool is_whole = true;
  if (isLintLine(self)) {
    const Search search(self);
    is_whole = !lines().any([&](const LintSpan& span) { return budget_.take() && search.mayShare(span); },
                            [&](const LintTree::Leaf& leaf) {
                              if (budget_.take() && search.mayShare({leaf.place, leaf.place}))
                                found.push_back(leaf.item);
                              return found.size() > most;
                            });
  } else {
    is_whole = likeCurve(self, most, found);
  }
  if (!is_whole || !at(curves_, cornersOf(self), 2 * kTouch_mm, most, found)) return false;
  std::sort(found.begin(), found.end(),
            [&](std::uint32_t a, std::uint32_t b) { return items_[a].number < items_[b].number; });
  found.erase(std::unique(found.begin(), found.end()), found.end());
  std::erase(found, item);
  return true;
}

}  // namespace kerfbench::dieline
