// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "hil/dieline/curve_math.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/lint_items.h"
#include "hil/dieline/lint_near.h"
#include "hil/dieline/read.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;
using Kind = LintFinding::Kind;

/// Looks at neighbours and at nodes of the search for them: so many, and more for each curve. A drawing that
/// needs more is no drawing but a heap of lines on each other.
constexpr std::size_t kMostLooks = 300'000'000;
constexpr std::size_t kMostLooksOfOne = 500;
constexpr std::size_t kMostAlike = 32;
constexpr std::uint64_t kItemsToldOf = 50'000;  // Checked in an instant.

class Checker {
 public:
  Checker(const Dieline& dieline, std::size_t most, const base::ProgressFn& progress)
      : items_(lintItems(dieline)),
        budget_{kMostLooks + kMostLooksOfOne * items_.size()},
        near_(items_, budget_),
        store_(items_, most),
        progress_(progress, "checking " + std::filesystem::path(dieline.path).filename().string(),
                  2 * items_.size(), kItemsToldOf) {}

  LintReport run() && {
    if (items_.empty()) {
      store_.add(LintFinding{Kind::kEmpty, true, Vector2d::Zero(), "",
                             "The dieline holds nothing to cut or crease."});
      return std::move(store_).report();
    }
    std::vector<std::uint32_t> zeros;
    for (std::uint32_t i = 0; i < items_.size(); ++i) {
      if (items_[i].is_zero) zeros.push_back(i);
    }
    std::sort(zeros.begin(), zeros.end(),
              [&](auto a, auto b) { return items_[a].number < items_[b].number; });
    for (const std::uint32_t i : zeros) {
      const LintItem& item = items_[i];
      store_.add({Kind::kZeroLength, true, !item.isCut(), item.samples[0], i, i, item.length_mm});
    }
    met_.resize(2 * items_.size());
    chain_.resize(items_.size());
    std::iota(chain_.begin(), chain_.end(), 0U);
    checkPairs();
    checkEnds();
    checkSize();
    if (budget_.isSpent()) {
      store_.add(LintFinding{
          Kind::kOverlap, true, firstDrawn().samples[0], "",
          fmt::format(
              "More than {} looks at lines near each other: not all were compared. Are there copies on "
              "each other?",
              budget_.most)});
    }
    return std::move(store_).report();
  }

 private:
  [[nodiscard]] const LintItem& firstDrawn() const {
    return *std::min_element(items_.begin(), items_.end(),
                             [](const LintItem& a, const LintItem& b) { return a.number < b.number; });
  }

  /// Two items that may share a length, the one that comes first along x first.
  struct Pair {
    std::uint32_t rank{};  ///< Place of the first along x.
    std::uint32_t first{};
    std::uint32_t second{};
  };

  /// All pairs that may share a length. They are looked for from neighbour to neighbour, and compared in
  /// order along x: a curve that repeats another is compared with no third. Where many are alike, they are
  /// looked for then, as most of them are such copies.
  void checkPairs() {
    const std::vector<std::uint32_t> rank = ranksAlongX();
    std::vector<Pair> pairs;
    const auto add = [&](std::uint32_t a, std::uint32_t b) {
      pairs.push_back(rank[a] < rank[b] ? Pair{rank[a], a, b} : Pair{rank[b], b, a});
    };
    std::vector<std::uint32_t> like;
    for (std::uint32_t i = 0; i < items_.size(); ++i) {
      progress_.done(i);
      if (items_[i].is_zero || (isLintLine(items_[i]) && lookAlong(i, add))) continue;
      if (near_.like(i, kMostAlike, like)) {
        for (const std::uint32_t other : like) add(i, other);
      } else {
        pairs.push_back({rank[i], i, i});
      }
    }
    std::sort(pairs.begin(), pairs.end(), [&](const Pair& a, const Pair& b) {
      return a.rank != b.rank ? a.rank < b.rank : items_[a.second].number < items_[b.second].number;
    });
    const auto last = std::unique(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
      return a.first == b.first && a.second == b.second;
    });
    pairs.erase(last, pairs.end());
    comparePairs(pairs, rank);
  }

  void comparePairs(const std::vector<Pair>& pairs, const std::vector<std::uint32_t>& rank) {
    std::vector<std::uint32_t> like;
    std::vector<bool> is_copy(items_.size(), false);
    const auto compare = [&](std::uint32_t a, std::uint32_t b) {
      if (is_copy[a] || is_copy[b]) return;
      is_copy[b] = items_[a].number < items_[b].number ? checkPair(a, b) : checkPair(b, a);
    };
    for (const Pair& pair : pairs) {
      if (pair.first != pair.second) {
        compare(pair.first, pair.second);
      } else if (!is_copy[pair.first]) {
        near_.like(pair.first, kAllFindings, like);
        for (const std::uint32_t other : like) {
          if (rank[other] > pair.rank && budget_.take()) compare(pair.first, other);
        }
      }
    }
  }

  /// Notes what ends on a line, and adds those with which it may share a length. False where too much ends
  /// there.
  template <class Add>
  bool lookAlong(std::uint32_t i, const Add& add) {
    if (!near_.onLine(i, kMostAlike, on_line_)) {
      has_crowded_ = true;
      return false;
    }
    const LintItem& item = items_[i];
    for (const LintEnd& end : on_line_) {
      const LintItem& other = items_[end.item];
      const Vector2d& p_mm = other.samples.at(end.sample);
      if (isLintLine(other) && near_.mayShare(i, end.item)) add(i, end.item);
      if (nearestOn(item.entity->curve, p_mm).distance_mm > kMet_mm) continue;
      met_[slotOf(end)].lines_any = true;
      if (item.isCut()) met_[slotOf(end)].lines_cut = true;
      for (const std::uint32_t s : {0U, 4U}) {
        if ((item.samples.at(s) - p_mm).norm() <= kMet_mm) meet({i, s}, end.item);
      }
    }
    met_[slotOf({i, 0})].is_known = met_[slotOf({i, 4})].is_known = true;
    return true;
  }

  /// Notes that an end of an item is where another item ends; joins cuts.
  void meet(const LintEnd& end, std::uint32_t other) {
    met_[slotOf(end)].ends_any = true;
    if (!items_[end.item].isCut() || !items_[other].isCut()) return;
    met_[slotOf(end)].ends_cut = true;
    chain_[root(end.item)] = root(other);
  }

  static std::size_t slotOf(const LintEnd& end) {
    return 2 * static_cast<std::size_t>(end.item) + (end.sample == 0 ? 0 : 1);
  }

  [[nodiscard]] std::vector<std::uint32_t> ranksAlongX() const {
    struct Place {
      double x_mm;
      std::uint32_t number;
      std::uint32_t item;
    };
    std::vector<Place> order;
    order.reserve(items_.size());
    for (std::uint32_t i = 0; i < items_.size(); ++i)
      order.push_back({items_[i].box.min().x(), items_[i].number, i});
    std::sort(order.begin(), order.end(), [](const Place& a, const Place& b) {
      return a.x_mm != b.x_mm ? a.x_mm < b.x_mm : a.number < b.number;
    });
    std::vector<std::uint32_t> rank(items_.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) rank[order[i].item] = i;
    return rank;
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

  /// Looks for what else an end lies on (a tee joint): curves, and lines on which too much ends.
  void meetOnWay(const LintEnd& end) {
    EndMet& met = met_[slotOf(end)];
    const Vector2d& p_mm = items_[end.item].samples.at(end.sample);
    const bool needs_cut = items_[end.item].isCut();
    if (needs_cut ? met.lines_cut : met.lines_any) return;
    near_.through(p_mm, has_crowded_, [&](std::size_t i) {
      const LintItem& item = items_[i];
      if (i == end.item || (met.lines_any && !item.isCut())) return false;
      if (nearestOn(item.entity->curve, p_mm).distance_mm > kMet_mm) return false;
      met.lines_any = true;
      met.lines_cut = met.lines_cut || item.isCut();
      return met.lines_cut || !needs_cut;
    });
  }

  /// Looks for ends of others at an end.
  void meetAtEnd(const LintEnd& end) {
    const LintItem& item = items_[end.item];
    const Vector2d& p_mm = item.samples.at(end.sample);
    // All that meet at one point find the same ones first, and so are joined with each other.
    constexpr int kMostJoined = 16;
    for (const bool of_cuts : {true, false}) {
      int joined = 0;
      near_.ends(of_cuts, p_mm, kMet_mm, [&](const LintEnd& other, double) {
        if (other.item != end.item) meet(end, other.item);
        return ++joined > kMostJoined;
      });
    }
  }

  std::uint32_t root(std::uint32_t i) {
    while (chain_[i] != i) i = chain_[i] = chain_[chain_[i]];
    return i;
  }

  void checkEnds() {
    for (std::uint32_t i = 0; i < items_.size(); ++i) {
      progress_.done(items_.size() + i);
      const LintItem& item = items_[i];
      if (item.is_zero || item.is_closed) continue;
      for (const std::uint32_t s : {0U, 4U}) {
        const LintEnd end{i, s};
        const EndMet& met = met_[slotOf(end)];
        if (!met.is_known) meetAtEnd(end);
        if (item.isCut() ? met.ends_cut : met.ends_any) continue;
        meetOnWay(end);
        // Dashes drawn one by one are all gaps, and meant so.
        if (!met.ends_any && !met.lines_any && item.entity->process != Process::kPerforation) findGap(end);
        if (item.isCut() && !met.lines_cut) loose_.push_back({numberOf(end), end});
      }
    }
    reportGaps();
    reportOpen();
  }

  /// Place of an end in the drawing.
  [[nodiscard]] std::uint32_t numberOf(const LintEnd& end) const {
    return 2 * items_[end.item].number + (end.sample == 0 ? 0U : 1U);
  }

  struct Gap {
    std::uint32_t number{};  ///< Place of the first end in the drawing.
    LintEnd from;
    LintEnd to;
    double length_mm{};
    std::pair<std::uint32_t, std::uint32_t> ends;  ///< Places of both in the drawing, the lesser first.
  };

  /// The nearest end of the same process within a gap; the last drawn of several.
  void findGap(const LintEnd& from) {
    const LintItem& a = items_[from.item];
    const Vector2d& p_mm = a.samples.at(from.sample);
    LintEnd nearest;
    double nearest_mm = kGap_mm;
    bool has_nearest = false;
    near_.ends(a.isCut(), p_mm, nearest_mm, [&](const LintEnd& end, double d_mm) {
      const LintItem& other = items_[end.item];
      if (end.item == from.item || other.entity->process != a.entity->process) return false;
      if (has_nearest && d_mm == nearest_mm && numberOf(end) < numberOf(nearest)) return false;
      // Not where this very entity runs through the other's end: that is an overshoot, and joined.
      if (nearestOn(a.entity->curve, other.samples.at(end.sample)).distance_mm <= kMet_mm) return false;
      nearest = end;
      nearest_mm = d_mm;
      has_nearest = true;
      return false;
    });
    if (has_nearest)
      gaps_.push_back(
          {numberOf(from), from, nearest, nearest_mm, std::minmax({numberOf(from), numberOf(nearest)})});
  }

  void reportGaps() {
    // A pair of loose ends sees itself twice.
    std::sort(gaps_.begin(), gaps_.end(), [](const Gap& a, const Gap& b) {
      return a.ends != b.ends ? a.ends < b.ends : a.number < b.number;
    });
    const auto last =
        std::unique(gaps_.begin(), gaps_.end(), [](const Gap& a, const Gap& b) { return a.ends == b.ends; });
    gaps_.erase(last, gaps_.end());
    std::sort(gaps_.begin(), gaps_.end(), [](const Gap& a, const Gap& b) { return a.number < b.number; });
    for (const Gap& gap : gaps_) {
      const LintItem& item = items_[gap.from.item];
      store_.add({Kind::kGap, true, !item.isCut(), item.samples.at(gap.from.sample), gap.from.item,
                  gap.to.item, gap.length_mm});
    }
  }

  void reportOpen() {
    std::vector<std::uint32_t> loose_ends(items_.size());
    for (const LooseEnd& loose : loose_) ++loose_ends[root(loose.end.item)];
    std::sort(loose_.begin(), loose_.end(),
              [](const LooseEnd& a, const LooseEnd& b) { return a.number < b.number; });
    for (const LooseEnd& loose : loose_) {
      std::uint32_t& count = loose_ends[root(loose.end.item)];
      if (count == 0) continue;  // Said once per outline.
      const LintItem& item = items_[loose.end.item];
      store_.add({Kind::kOpenOutline, false, false, item.samples.at(loose.end.sample), loose.end.item, count,
                  item.length_mm});
      count = 0;
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
        Kind::kSuspiciousSize, false, all.center(), firstDrawn().entity->layer,
        fmt::format("The dieline measures {:.3f} x {:.3f} mm: wrong units?", size.x(), size.y())});
  }

  std::vector<LintItem> items_;
  LintBudget budget_;
  LintNear near_;
  LintStore store_;
  base::ShareProgress progress_;
  /// What an end meets: ends of others, and others on their way.
  struct EndMet {
    bool is_known{};  ///< True if the ends that it meets are.
    bool ends_any{};
    bool ends_cut{};
    bool lines_any{};
    bool lines_cut{};
  };
  std::vector<EndMet> met_;           ///< Two for each item.
  std::vector<std::uint32_t> chain_;  ///< Cuts that meet, as a forest.
  std::vector<LintEnd> on_line_;      ///< Kept from line to line.
  bool has_crowded_{};
  std::vector<Gap> gaps_;
  struct LooseEnd {
    std::uint32_t number{};  ///< Place in the drawing.
    LintEnd end;
  };
  std::vector<LooseEnd> loose_;  ///< Ends of cuts alone.
};

}  // namespace

LintReport lintDieline(const Dieline& dieline, std::size_t most, const base::ProgressFn& progress) {
  return Checker(dieline, most, progress).run();
}

std::vector<LintFinding> lintDieline(const Dieline& dieline) {
  return lintDieline(dieline, kAllFindings).findings;
}

}  // namespace kerfbench::dieline
