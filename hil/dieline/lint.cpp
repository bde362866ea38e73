// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <unordered_map>

#include <fmt/format.h>
#include <unsupported/Eigen/BVH>

#include "hil/dieline/curve_math.h"
#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;
using Kind = LintFinding::Kind;

constexpr double kZero_mm = 1e-3;     // Shorter is a dot.
constexpr double kMet_mm = 1e-3;      // Ends closer than this meet.
constexpr double kGap_mm = 0.5;       // Ends farther apart than this do not belong together.
constexpr double kOverlap_mm = 0.01;  // Shared length from which a line is cut twice.
constexpr double kSame_mm = 0.005;    // Curves closer than this lie on each other.

/// An entity with what the checks ask again and again.
struct Item {
  const Entity* entity{};
  Eigen::AlignedBox2d box;
  double length_mm{};
  std::array<Vector2d, 5> samples;  ///< At equal arc lengths, both ends included.
  bool is_zero{};
  bool is_closed{};
};

std::string label(const Item& item) {
  return fmt::format("E{} ({}, {})", item.entity->id, item.entity->origin, processName(item.entity->process));
}

/// Boxes of items in a tree: whoever looks for those near a place asks few of them.
class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(const std::vector<Item>& items) {
    std::vector<std::size_t> indices(items.size());
    std::iota(indices.begin(), indices.end(), std::size_t{0});
    std::vector<Eigen::AlignedBox2d> boxes;
    boxes.reserve(items.size());
    for (const Item& item : items) boxes.push_back(item.box);
    tree_.init(indices.begin(), indices.end(), boxes.begin(), boxes.end());
  }
  /// Visits items whose boxes touch `box`, and maybe others beside them, in no order, until a visit says
  /// true; true if one does.
  template <class Visit>
  bool any(const Eigen::AlignedBox2d& box, Visit visit) const {
    struct Near {
      const Eigen::AlignedBox2d& box;
      Visit& visit;
      bool found{false};
      bool intersectVolume(const Eigen::AlignedBox2d& volume) const { return box.intersects(volume); }
      bool intersectObject(std::size_t item) { return found = visit(item); }
    };
    Near near{box, visit};
    Eigen::BVIntersect(tree_, near);
    return near.found;
  }

 private:
  Eigen::KdBVH<double, 2, std::size_t> tree_;
};

Eigen::AlignedBox2d grown(const Eigen::AlignedBox2d& box, double by_mm) {
  return {box.min() - Vector2d::Constant(by_mm), box.max() + Vector2d::Constant(by_mm)};
}

/// End points in cells of the gap's size, so that all ends near a point are in 9 cells.
class EndGrid {
 public:
  explicit EndGrid(const std::vector<Item>& items) {
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (items[i].is_zero || items[i].is_closed) continue;
      for (const std::size_t s : {std::size_t{0}, std::size_t{4}})
        cells_[key(items[i].samples[s], 0, 0)].push_back({i, s});
    }
  }
  struct End {
    std::size_t item{};
    std::size_t sample{};
  };
  template <class Visit>
  void near(const Vector2d& p_mm, Visit visit) const {
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const auto cell = cells_.find(key(p_mm, dx, dy));
        if (cell == cells_.end()) continue;
        for (const End& end : cell->second) visit(end);
      }
    }
  }

 private:
  static std::uint64_t key(const Vector2d& p_mm, int dx, int dy) {
    const auto x = static_cast<std::int64_t>(std::floor(p_mm.x() / kGap_mm)) + dx;
    const auto y = static_cast<std::int64_t>(std::floor(p_mm.y() / kGap_mm)) + dy;
    return (static_cast<std::uint64_t>(x) << 32U) ^ (static_cast<std::uint64_t>(y) & 0xffffffffU);
  }
  std::unordered_map<std::uint64_t, std::vector<End>> cells_;
};

/// Length on which two lines lie on each other.
double sharedLength(const LineCurve& a, const LineCurve& b) {
  const double length = (a.end_mm - a.start_mm).norm();
  const Vector2d along = (a.end_mm - a.start_mm) / length;
  const Vector2d across(-along.y(), along.x());
  double s0 = along.dot(b.start_mm - a.start_mm);
  double s1 = along.dot(b.end_mm - a.start_mm);
  double d0 = across.dot(b.start_mm - a.start_mm);
  double d1 = across.dot(b.end_mm - a.start_mm);
  if (s0 > s1) {
    std::swap(s0, s1);
    std::swap(d0, d1);
  }
  const double lo = std::max(s0, 0.0);
  const double hi = std::min(s1, length);
  if (!(hi - lo > 0)) return 0.0;
  const auto offset = [&](double s) { return std::abs(d0 + (d1 - d0) * (s - s0) / (s1 - s0)); };
  return std::max(offset(lo), offset(hi)) < kSame_mm ? hi - lo : 0.0;
}

double sharedLength(const ArcCurve& a, const ArcCurve& b) {
  if ((a.centre_mm - b.centre_mm).norm() + std::abs(a.radius_mm - b.radius_mm) > kSame_mm) return 0.0;
  const double turn = 2 * std::numbers::pi;
  const auto first = [](const ArcCurve& c) {
    return c.sweep_rad > 0 ? c.start_angle_rad : c.start_angle_rad + c.sweep_rad;
  };
  double from = std::fmod(first(b) - first(a), turn);
  if (from < 0) from += turn;
  double shared = 0;
  for (const double begin : {from - turn, from}) {
    shared +=
        std::max(0.0, std::min(begin + std::abs(b.sweep_rad), std::abs(a.sweep_rad)) - std::max(begin, 0.0));
  }
  return shared * a.radius_mm;
}

class Checker {
 public:
  explicit Checker(const Dieline& dieline) {
    for (const Entity& entity : dieline.entities) {
      if (entity.process == Process::kIgnore) continue;
      Item item{&entity, boundsOf(entity.curve), lengthOf(entity.curve), {}, false, isClosed(entity.curve)};
      item.is_zero = item.length_mm < kZero_mm;
      const std::vector<double> u =
          item.is_zero ? std::vector<double>(5, 0.0) : stations(entity.curve, item.length_mm / 4);
      for (std::size_t i = 0; i < 5; ++i) item.samples[i] = pointAt(entity.curve, u[i]);
      items_.push_back(std::move(item));
    }
    if (!items_.empty()) boxes_ = BoxTree(items_);
  }

  std::vector<LintFinding> run() {
    if (items_.empty()) {
      findings_.push_back(
          {Kind::kEmpty, true, Vector2d::Zero(), "", "The dieline holds nothing to cut or crease."});
      return std::move(findings_);
    }
    for (const Item& item : items_) {
      if (item.is_zero) {
        add(Kind::kZeroLength, true, item.samples[0], item,
            fmt::format("{} is only {:.6f} mm long.", label(item), item.length_mm));
      }
    }
    checkPairs();
    checkEnds();
    checkSize();
    return std::move(findings_);
  }

 private:
  void add(Kind kind, bool is_error, const Vector2d& p_mm, const Item& item, std::string message) {
    findings_.push_back({kind, is_error, p_mm, item.entity->layer, std::move(message)});
  }

  /// All pairs whose boxes touch, in order along x.
  void checkPairs() {
    std::vector<std::size_t> order(items_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return items_[a].box.min().x() < items_[b].box.min().x();
    });
    std::vector<std::size_t> rank(items_.size());
    for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = i;
    std::vector<std::size_t> near;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Item& a = items_[order[i]];
      if (a.is_zero) continue;
      const Eigen::AlignedBox2d touched = grown(a.box, kSame_mm);
      near.clear();
      boxes_.any(touched, [&](std::size_t item) {
        if (rank[item] > i && !items_[item].is_zero && touched.intersects(items_[item].box))
          near.push_back(rank[item]);
        return false;
      });
      std::sort(near.begin(), near.end());
      for (const std::size_t k : near) {
        const auto [first, second] = std::minmax(order[i], order[k]);
        checkPair(items_[first], items_[second]);
      }
    }
  }

  static bool isSame(const Item& a, const Item& b) {
    if (std::abs(a.length_mm - b.length_mm) > 2 * kSame_mm) return false;
    if ((a.box.min() - b.box.min()).norm() > 2 * kSame_mm ||
        (a.box.max() - b.box.max()).norm() > 2 * kSame_mm)
      return false;
    double same = 0;
    double opposite = 0;
    for (std::size_t i = 0; i < 5; ++i) {
      same = std::max(same, (a.samples[i] - b.samples[i]).norm());
      opposite = std::max(opposite, (a.samples[i] - b.samples[4 - i]).norm());
    }
    if (std::min(same, opposite) <= kSame_mm) return true;
    // Closed curves may start anywhere.
    if (!a.is_closed || !b.is_closed) return false;
    return std::all_of(a.samples.begin(), a.samples.end(), [&](const Vector2d& p) {
      return nearestOn(b.entity->curve, p).distance_mm <= kSame_mm;
    });
  }

  void checkPair(const Item& a, const Item& b) {
    if (isSame(a, b)) {
      add(Kind::kDuplicate, true, b.samples[2], b,
          fmt::format("{} repeats {}, {:.3f} mm.", label(b), label(a), b.length_mm));
      return;
    }
    double shared_mm = 0;
    const auto* line_a = std::get_if<LineCurve>(&a.entity->curve);
    const auto* line_b = std::get_if<LineCurve>(&b.entity->curve);
    const auto* arc_a = std::get_if<ArcCurve>(&a.entity->curve);
    const auto* arc_b = std::get_if<ArcCurve>(&b.entity->curve);
    if (line_a != nullptr && line_b != nullptr) {
      // On the longer one: its direction is the better known.
      shared_mm =
          a.length_mm >= b.length_mm ? sharedLength(*line_a, *line_b) : sharedLength(*line_b, *line_a);
    } else if (arc_a != nullptr && arc_b != nullptr) {
      shared_mm = sharedLength(*arc_a, *arc_b);
    }
    if (shared_mm <= kOverlap_mm) return;
    const Eigen::AlignedBox2d both = a.box.intersection(b.box);
    const Vector2d p_mm = nearestPoint(b, both.isEmpty() ? b.samples[2] : Vector2d(both.center()));
    add(Kind::kOverlap, true, p_mm, b,
        fmt::format("{} lies on {} for {:.3f} mm.", label(b), label(a), shared_mm));
  }

  static Vector2d nearestPoint(const Item& item, const Vector2d& p_mm) {
    return pointAt(item.entity->curve, nearestOn(item.entity->curve, p_mm).u);
  }

  /// True when the point lies on another entity (a tee joint).
  [[nodiscard]] bool isOnAnother(std::size_t self, const Vector2d& p_mm, bool cuts_only) const {
    return boxes_.any(grown({p_mm, p_mm}, kMet_mm), [&](std::size_t i) {
      const Item& item = items_[i];
      if (i == self || item.is_zero || (cuts_only && item.entity->process != Process::kCut)) return false;
      return item.box.squaredExteriorDistance(p_mm) <= kMet_mm * kMet_mm &&
             nearestOn(item.entity->curve, p_mm).distance_mm <= kMet_mm;
    });
  }

  void checkEnds() {
    const EndGrid grid(items_);
    std::vector<std::size_t> chain(items_.size());
    std::iota(chain.begin(), chain.end(), std::size_t{0});
    const auto root = [&](std::size_t i) {
      while (chain[i] != i) i = chain[i] = chain[chain[i]];
      return i;
    };
    std::vector<EndGrid::End> loose_cuts;
    for (std::size_t i = 0; i < items_.size(); ++i) {
      const Item& item = items_[i];
      if (item.is_zero || item.is_closed) continue;
      for (const std::size_t s : {std::size_t{0}, std::size_t{4}}) {
        const Vector2d& p_mm = item.samples[s];
        bool is_met = false;
        bool cut_meets = false;
        EndGrid::End nearest;
        double nearest_mm = kGap_mm;
        bool has_nearest = false;
        grid.near(p_mm, [&](const EndGrid::End& end) {
          if (end.item == i) return;
          const Item& other = items_[end.item];
          const double d_mm = (other.samples[end.sample] - p_mm).norm();
          const bool both_cut =
              item.entity->process == Process::kCut && other.entity->process == Process::kCut;
          if (d_mm <= kMet_mm) {
            is_met = true;
            if (both_cut) {
              cut_meets = true;
              chain[root(i)] = root(end.item);
            }
          } else if (d_mm <= nearest_mm && other.entity->process == item.entity->process &&
                     nearestOn(item.entity->curve, other.samples[end.sample]).distance_mm > kMet_mm) {
            // Not where this very entity runs through the other's end: that is an overshoot, and joined.
            nearest = end;
            nearest_mm = d_mm;
            has_nearest = true;
          }
        });
        // Dashes drawn one by one are all gaps, and meant so.
        const bool may_gap = item.entity->process != Process::kPerforation;
        if (!is_met && has_nearest && may_gap && !isOnAnother(i, p_mm, false))
          reportGap({i, s}, nearest, nearest_mm);
        if (item.entity->process == Process::kCut && !cut_meets && !isOnAnother(i, p_mm, true))
          loose_cuts.push_back({i, s});
      }
    }
    reportOpen(loose_cuts, root);
  }

  void reportGap(const EndGrid::End& from, const EndGrid::End& to, double gap_mm) {
    const Item& a = items_[from.item];
    const Item& b = items_[to.item];
    // A pair of loose ends sees itself twice.
    const auto pair = std::minmax({from.item * 2 + from.sample / 4, to.item * 2 + to.sample / 4});
    if (!reported_gaps_.insert({(static_cast<std::uint64_t>(pair.first) << 32U) | pair.second, true}).second)
      return;
    add(Kind::kGap, true, a.samples[from.sample], a,
        fmt::format("{} ends {:.4f} mm short of an end of {}.", label(a), gap_mm, label(b)));
  }

  template <class Root>
  void reportOpen(const std::vector<EndGrid::End>& loose, Root root) {
    std::unordered_map<std::size_t, std::size_t> loose_ends;
    for (const EndGrid::End& end : loose) ++loose_ends[root(end.item)];
    for (const EndGrid::End& end : loose) {
      const auto it = loose_ends.find(root(end.item));
      if (it == loose_ends.end()) continue;  // Said once per outline.
      const Item& item = items_[end.item];
      add(Kind::kOpenOutline, false, item.samples[end.sample], item,
          fmt::format("The cut outline with {} is open: {} loose end(s), one at ({:.3f}, {:.3f}) mm.",
                      label(item), it->second, item.samples[end.sample].x(), item.samples[end.sample].y()));
      loose_ends.erase(it);
    }
  }

  void checkSize() {
    Eigen::AlignedBox2d all;
    for (const Item& item : items_) all.extend(item.box);
    const Vector2d size = all.sizes();
    constexpr double kLargest_mm = 3000;
    constexpr double kSmallest_mm = 2;
    if (size.maxCoeff() <= kLargest_mm && size.maxCoeff() >= kSmallest_mm) return;
    add(Kind::kSuspiciousSize, false, all.center(), items_.front(),
        fmt::format("The dieline measures {:.3f} x {:.3f} mm: wrong units?", size.x(), size.y()));
  }

  std::vector<Item> items_;
  BoxTree boxes_;
  std::unordered_map<std::uint64_t, bool> reported_gaps_;
  std::vector<LintFinding> findings_;
};

}  // namespace

std::vector<LintFinding> lintDieline(const Dieline& dieline) { return Checker(dieline).run(); }

LintReport lintDieline(const Dieline& dieline, std::size_t) { return {lintDieline(dieline), {}}; }

}  // namespace kerfbench::dieline
