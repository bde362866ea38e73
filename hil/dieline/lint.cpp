// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <unordered_map>
#include <unordered_set>

#include <fmt/format.h>

#include "hil/dieline/curve_math.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/lint_items.h"
#include "hil/dieline/read.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;
using Kind = LintFinding::Kind;

/// Pairs of neighbours that are looked at, of curves and of ends: so many, and more for each curve. A drawing
/// with more is no drawing but a heap of lines on each other.
constexpr std::size_t kMostPairs = 40'000'000;
constexpr std::size_t kMostPairsOfOne = 50;

class Checker {
 public:
  Checker(const Dieline& dieline, std::size_t most) : items_(lintItems(dieline)), store_(items_, most) {
    if (!items_.empty()) boxes_ = LintBoxes(items_);
  }

  LintReport run() && {
    if (items_.empty()) {
      store_.add(LintFinding{Kind::kEmpty, true, Vector2d::Zero(), "",
                             "The dieline holds nothing to cut or crease."});
      return std::move(store_).report();
    }
    for (std::uint32_t i = 0; i < items_.size(); ++i) {
      const LintItem& item = items_[i];
      if (item.is_zero)
        store_.add({Kind::kZeroLength, true, !item.isCut(), item.samples[0], i, i, item.length_mm});
    }
    checkPairs();
    checkEnds();
    checkSize();
    if (pairs_ > mostPairs()) {
      store_.add(LintFinding{
          Kind::kOverlap, true, items_[0].samples[0], "",
          fmt::format(
              "More than {} pairs of lines are near each other: not all were compared. Are there copies "
              "on each other?",
              mostPairs())});
    }
    return std::move(store_).report();
  }

 private:
  /// Counts one more pair; false when there were too many.
  bool mayLook() { return ++pairs_ <= mostPairs(); }
  [[nodiscard]] std::size_t mostPairs() const { return kMostPairs + kMostPairsOfOne * items_.size(); }

  /// All pairs whose boxes touch, in order along x. A curve that repeats another is compared with no third.
  void checkPairs() {
    std::vector<std::uint32_t> order(items_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return items_[a].box.min().x() < items_[b].box.min().x();
    });
    std::vector<std::uint32_t> rank(items_.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) rank[order[i]] = i;
    std::vector<bool> is_copy(items_.size(), false);
    std::vector<std::uint32_t> near;
    for (std::uint32_t i = 0; i < order.size(); ++i) {
      const LintItem& a = items_[order[i]];
      if (a.is_zero || is_copy[order[i]]) continue;
      const Eigen::AlignedBox2d touched(a.box.min().array() - kSame_mm, a.box.max().array() + kSame_mm);
      near.clear();
      boxes_.any(touched, [&](std::size_t item) {
        if (rank[item] > i && !items_[item].is_zero && touched.intersects(items_[item].box))
          near.push_back(rank[item]);
        return !mayLook();
      });
      for (const std::uint32_t k : near) {
        if (is_copy[order[k]]) continue;
        const auto [first, second] = std::minmax(order[i], order[k]);
        is_copy[order[k]] = checkPair(first, second);
      }
    }
  }

  /// True where the two are the same curve.
  bool checkPair(std::uint32_t first, std::uint32_t second) {
    const LintItem& a = items_[first];
    const LintItem& b = items_[second];
    const bool may_be_accepted = !a.isCut() || !b.isCut();
    if (lintSame(a, b)) {
      store_.add({Kind::kDuplicate, true, may_be_accepted, b.samples[2], second, first, b.length_mm});
      return true;
    }
    const double shared_mm = lintSharedLength(a, b);
    if (shared_mm <= kOverlap_mm) return false;
    const Eigen::AlignedBox2d both = a.box.intersection(b.box);
    const Vector2d p_mm = both.isEmpty() ? b.samples[2] : Vector2d(both.center());
    const Vector2d on_b = pointAt(b.entity->curve, nearestOn(b.entity->curve, p_mm).u);
    store_.add({Kind::kOverlap, true, may_be_accepted, on_b, second, first, shared_mm});
    return false;
  }

  /// What the end of a curve meets.
  struct Met {
    bool any{};
    bool cut{};
  };

  /// Other entities that a point lies on (a tee joint).
  Met metOnWay(std::size_t self, const Vector2d& p_mm, bool needs_cut) {
    Met met;
    const Eigen::AlignedBox2d around(p_mm.array() - kMet_mm, p_mm.array() + kMet_mm);
    boxes_.any(around, [&](std::size_t i) {
      if (!mayLook()) return true;
      const LintItem& item = items_[i];
      if (i == self || item.is_zero || item.box.squaredExteriorDistance(p_mm) > kMet_mm * kMet_mm)
        return false;
      if (met.any && !item.isCut()) return false;
      if (nearestOn(item.entity->curve, p_mm).distance_mm > kMet_mm) return false;
      met.any = true;
      met.cut = met.cut || item.isCut();
      return met.cut || !needs_cut;
    });
    return met;
  }

  /// Ends of other entities at a point; joins cuts that meet there.
  Met metAtEnds(const LintEndGrid& grid, std::uint32_t self, const Vector2d& p_mm) {
    Met met;
    const bool is_cut = items_[self].isCut();
    grid.near(p_mm, [&](const LintEnd& end) {
      if (!mayLook()) return true;
      const LintItem& other = items_[end.item];
      if (end.item == self || (other.samples.at(end.sample) - p_mm).norm() > kMet_mm) return false;
      met.any = true;
      if (is_cut && other.isCut()) {
        met.cut = true;
        chain_[root(self)] = root(end.item);
      }
      return true;  // Cuts come first in a cell: one that is met joins all others of the cell.
    });
    return met;
  }

  std::uint32_t root(std::uint32_t i) {
    while (chain_[i] != i) i = chain_[i] = chain_[chain_[i]];
    return i;
  }

  void checkEnds() {
    const LintEndGrid meetings(items_, kMet_mm);
    const LintEndGrid gaps(items_, kGap_mm);
    chain_.resize(items_.size());
    std::iota(chain_.begin(), chain_.end(), 0U);
    std::vector<LintEnd> loose_cuts;
    for (std::uint32_t i = 0; i < items_.size(); ++i) {
      const LintItem& item = items_[i];
      if (item.is_zero || item.is_closed) continue;
      for (const std::uint32_t s : {0U, 4U}) {
        const Vector2d& p_mm = item.samples.at(s);
        const Met ends = metAtEnds(meetings, i, p_mm);
        if (item.isCut() ? ends.cut : ends.any) continue;
        const Met way = metOnWay(i, p_mm, item.isCut());
        // Dashes drawn one by one are all gaps, and meant so.
        if (!ends.any && !way.any && item.entity->process != Process::kPerforation) checkGap(gaps, {i, s});
        if (item.isCut() && !way.cut) loose_cuts.push_back({i, s});
      }
    }
    reportOpen(loose_cuts);
  }

  /// The nearest end of the same process within a gap.
  void checkGap(const LintEndGrid& grid, const LintEnd& from) {
    const LintItem& a = items_[from.item];
    const Vector2d& p_mm = a.samples.at(from.sample);
    LintEnd nearest;
    double nearest_mm = kGap_mm;
    bool has_nearest = false;
    grid.near(p_mm, [&](const LintEnd& end) {
      if (!mayLook()) return true;
      const LintItem& other = items_[end.item];
      const double d_mm = (other.samples.at(end.sample) - p_mm).norm();
      if (end.item == from.item || d_mm > nearest_mm || other.entity->process != a.entity->process)
        return false;
      // Not where this very entity runs through the other's end: that is an overshoot, and joined.
      if (nearestOn(a.entity->curve, other.samples.at(end.sample)).distance_mm <= kMet_mm) return false;
      nearest = end;
      nearest_mm = d_mm;
      has_nearest = true;
      return false;
    });
    if (!has_nearest) return;
    // A pair of loose ends sees itself twice.
    const auto pair = std::minmax({from.item * 2 + from.sample / 4, nearest.item * 2 + nearest.sample / 4});
    if (!reported_gaps_.insert((static_cast<std::uint64_t>(pair.first) << 32U) | pair.second).second) return;
    store_.add({Kind::kGap, true, !a.isCut(), p_mm, from.item, nearest.item, nearest_mm});
  }

  void reportOpen(const std::vector<LintEnd>& loose) {
    std::unordered_map<std::uint32_t, std::uint32_t> loose_ends;
    for (const LintEnd& end : loose) ++loose_ends[root(end.item)];
    for (const LintEnd& end : loose) {
      const auto it = loose_ends.find(root(end.item));
      if (it == loose_ends.end()) continue;  // Said once per outline.
      const LintItem& item = items_[end.item];
      store_.add({Kind::kOpenOutline, false, false, item.samples.at(end.sample), end.item, it->second,
                  item.length_mm});
      loose_ends.erase(it);
    }
  }

  void checkSize() {
    Eigen::AlignedBox2d all;
    for (const LintItem& item : items_) all.extend(item.box);
    const Vector2d size = all.sizes();
    constexpr double kLargest_mm = 3000;
    constexpr double kSmallest_mm = 2;
    if (size.maxCoeff() <= kLargest_mm && size.maxCoeff() >= kSmallest_mm) return;
    store_.add(LintFinding{
        Kind::kSuspiciousSize, false, all.center(), items_.front().entity->layer,
        fmt::format("The dieline measures {:.3f} x {:.3f} mm: wrong units?", size.x(), size.y())});
  }

  std::vector<LintItem> items_;
  LintBoxes boxes_;
  LintStore store_;
  std::vector<std::uint32_t> chain_;
  std::unordered_set<std::uint64_t> reported_gaps_;
  std::size_t pairs_{};
};

}  // namespace

LintReport lintDieline(const Dieline& dieline, std::size_t most) { return Checker(dieline, most).run(); }

std::vector<LintFinding> lintDieline(const Dieline& dieline) {
  return lintDieline(dieline, kAllFindings).findings;
}

}  // namespace kerfbench::dieline
