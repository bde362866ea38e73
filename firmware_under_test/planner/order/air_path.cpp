// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/order/air_path.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

/// Gain below which a change is rounding.
constexpr double kGainMm = 1e-6;
constexpr int kCircleStarts = 24;
/// Largest number of pieces that Or-opt moves as one.
constexpr std::size_t kLongestMoved = 3;
/// Pairs of pieces that a pass examines; with many pieces, only pairs that are close in the order.
constexpr std::size_t kMostStopPairs = 1'500'000;
constexpr int kDisturbances = 150;
/// Largest order that is disturbed: each new start costs a whole search.
constexpr std::size_t kMostDisturbed = 80;

/// A variant of running a chain.
struct Variant {
  Vector2d in_mm, out_mm;
  std::size_t first{};  ///< Segment that a closed chain begins with.
  double turned_rad{};  ///< Turn of a full circle's start.
  bool backwards{};     ///< True if an open chain is run backwards.
};

struct Visit {
  std::size_t piece{};
  std::size_t variant{};
};

using Tour = std::vector<Visit>;

std::vector<Variant> variantsOf(const Chain& chain) {
  if (!chain.closed())
    return {{chain.start(), chain.end(), 0, 0.0, false}, {chain.end(), chain.start(), 0, 0.0, true}};
  const std::vector<Segment>& segments = chain.segments;
  std::vector<Variant> variants{{chain.start(), chain.end(), 0, 0.0, false}};
  if (segments.size() == 1) {
    const Vector2d radius = segments[0].start_mm - segments[0].centre_mm;
    for (int i = 1; segments[0].isCircle() && i < kCircleStarts; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kCircleStarts;
      const Vector2d p = segments[0].centre_mm + Eigen::Rotation2Dd(angle) * radius;
      variants.push_back({p, p, 0, angle, false});
    }
    return variants;
  }
  const auto isCorner = [&](std::size_t i) {
    return turnRad(segments[(i + segments.size() - 1) % segments.size()], segments[i]) > kTangentRad;
  };
  const bool at_corner = isCorner(0);
  for (std::size_t i = 1; i < segments.size(); ++i) {
    if (!at_corner || isCorner(i))
      variants.push_back({segments[i].start_mm, segments[i].start_mm, i, 0.0, false});
  }
  return variants;
}

Chain run(Chain chain, const Variant& variant) {
  if (variant.backwards) chain.segments = reversedPath(chain.segments);
  std::rotate(chain.segments.begin(), chain.segments.begin() + static_cast<std::ptrdiff_t>(variant.first),
              chain.segments.end());
  if (variant.turned_rad != 0.0) chain.segments[0].start_mm = chain.segments[0].end_mm = variant.in_mm;
  return chain;
}

class Search {
 public:
  Search(std::vector<Stop> stops, const std::function<bool(const std::vector<Stop>&)>& fits,
         int most_questions)
      : stops_(std::move(stops)),
        fits_(fits),
        questions_(most_questions),
        window_(std::max<std::size_t>(50, kMostStopPairs / stops_.size())) {
    for (const Stop& stop : stops_) variants_.push_back(variantsOf(stop.chain));
  }

  std::vector<Stop> inGivenOrder() {
    Tour tour = asGiven();
    programStarts(tour);
    return stopsOf(tour);
  }

  std::vector<Stop> best() {
    Tour tour = asGiven();
    descend(tour);
    Tour best = tour;
    double best_mm = lengthOf(best);
    if (stops_.size() > 3 && stops_.size() <= kMostDisturbed) {
      for (int i = 0; i < kDisturbances && (!fits_ || questions_ > 0); ++i) {
        Tour other = best;
        if (!disturb(other)) continue;
        const double limit_mm = best_mm - kGainMm;
        // Intermediate orders may not fit; the last one must.
        const auto asked = fits_;
        fits_ = {};
        descend(other);
        fits_ = asked;
        if (lengthOf(other) >= limit_mm || !allowed(other)) continue;
        best = other;
        best_mm = lengthOf(best);
      }
    }
    return stopsOf(best);
  }

 private:
  [[nodiscard]] const Variant& at(const Visit& visit) const { return variants_[visit.piece][visit.variant]; }
  [[nodiscard]] int rank(const Visit& visit) const { return stops_[visit.piece].rank; }
  [[nodiscard]] Visit turned(Visit visit) const {
    if (!stops_[visit.piece].chain.closed()) visit.variant = 1 - visit.variant;
    return visit;
  }
  [[nodiscard]] double gap(const Visit& a, const Visit& b) const {
    return (at(b).in_mm - at(a).out_mm).norm();
  }
  /// Air before place i; zero before the first and after the last.
  [[nodiscard]] double gapBefore(const Tour& tour, std::size_t i) const {
    return i == 0 || i >= tour.size() ? 0.0 : gap(tour[i - 1], tour[i]);
  }
  [[nodiscard]] double lengthOf(const Tour& tour) const {
    double sum = 0.0;
    for (std::size_t i = 1; i < tour.size(); ++i) sum += gap(tour[i - 1], tour[i]);
    return sum;
  }

  [[nodiscard]] Tour asGiven() const {
    Tour tour;
    for (std::size_t i = 0; i < stops_.size(); ++i) tour.push_back({i, 0});
    return tour;
  }
  [[nodiscard]] std::vector<Stop> stopsOf(const Tour& tour) const {
    std::vector<Stop> out;
    for (const Visit& visit : tour) {
      const Stop& stop = stops_[visit.piece];
      out.push_back({run(stop.chain, at(visit)), stop.rank, stop.has_bridges});
    }
    return out;
  }

  bool allowed(const Tour& tour) {
    if (!fits_) return true;
    if (questions_ <= 0) return false;
    --questions_;
    return fits_(stopsOf(tour));
  }

  /// Changes the tour if the changed one is allowed.
  template <typename Change>
  bool take(Tour& tour, const Change& change) {
    if (!fits_) {
      change(tour);
      return true;
    }
    Tour other = tour;
    change(other);
    if (!allowed(other)) return false;
    tour = std::move(other);
    return true;
  }

  void descend(Tour& tour) {
    bool better = true;
    while (better && (!fits_ || questions_ > 0)) {
      better = chooseStarts(tour);
      better = twoOpt(tour) || better;
      better = orOpt(tour) || better;
    }
  }

  /// Chooses the best variants for this order: exactly, by dynamic programming, where any order fits; else
  /// one by one.
  bool chooseStarts(Tour& tour) { return fits_ ? changeStarts(tour) : programStarts(tour); }

  bool programStarts(Tour& tour) {
    const double before_mm = lengthOf(tour);
    std::vector<std::vector<double>> cost(tour.size());
    std::vector<std::vector<std::size_t>> from(tour.size());
    for (std::size_t i = 0; i < tour.size(); ++i) {
      const auto& here = variants_[tour[i].piece];
      cost[i].assign(here.size(), 0.0);
      from[i].assign(here.size(), 0);
      for (std::size_t v = 0; i > 0 && v < here.size(); ++v) {
        const auto& earlier = variants_[tour[i - 1].piece];
        cost[i][v] = std::numeric_limits<double>::infinity();
        for (std::size_t u = 0; u < earlier.size(); ++u) {
          const double sum = cost[i - 1][u] + (here[v].in_mm - earlier[u].out_mm).norm();
          if (sum >= cost[i][v] - kGainMm * 1e-3) continue;
          cost[i][v] = sum;
          from[i][v] = u;
        }
      }
    }
    Tour other = tour;
    const auto last = std::min_element(cost.back().begin(), cost.back().end());
    if (*last >= before_mm - kGainMm) return false;
    std::size_t variant = static_cast<std::size_t>(last - cost.back().begin());
    for (std::size_t i = tour.size(); i-- > 0;) {
      other[i].variant = variant;
      variant = from[i][variant];
    }
    tour = other;
    return true;
  }

  bool changeStarts(Tour& tour) {
    bool better = false;
    for (std::size_t i = 0; i < tour.size(); ++i) {
      for (std::size_t v = 0; v < variants_[tour[i].piece].size(); ++v) {
        Tour other = tour;
        other[i].variant = v;
        const double gain =
            gapBefore(tour, i) + gapBefore(tour, i + 1) - gapBefore(other, i) - gapBefore(other, i + 1);
        if (gain > kGainMm) better = take(tour, [&](Tour& changed) { changed[i].variant = v; }) || better;
      }
    }
    return better;
  }

  void turnRound(Tour& tour, std::size_t i, std::size_t j) const {
    std::reverse(tour.begin() + std::ptrdiff_t(i), tour.begin() + std::ptrdiff_t(j) + 1);
    for (std::size_t k = i; k <= j; ++k) tour[k] = turned(tour[k]);
  }

  /// Reverses stretches [i, j]. A reversal keeps the ranks' sequence if they do not rise in the stretch.
  bool twoOpt(Tour& tour) {
    bool better = false;
    for (std::size_t i = 0; i < tour.size(); ++i) {
      for (std::size_t j = i; j < std::min(tour.size(), i + window_); ++j) {
        if (j > i && rank(tour[j]) > rank(tour[j - 1])) break;
        const Visit first = turned(tour[j]);
        const Visit last = turned(tour[i]);
        const double now = gapBefore(tour, i) + gapBefore(tour, j + 1);
        const double then =
            (i > 0 ? gap(tour[i - 1], first) : 0.0) + (j + 1 < tour.size() ? gap(last, tour[j + 1]) : 0.0);
        if (now - then <= kGainMm) continue;
        better = take(tour, [&](Tour& changed) { turnRound(changed, i, j); }) || better;
      }
    }
    return better;
  }

  /// Moves [i, j] to before place k, as it is or reversed.
  bool orOpt(Tour& tour) {
    bool better = false;
    for (std::size_t i = 0; i < tour.size(); ++i) {
      for (std::size_t j = i; j < std::min(tour.size(), i + kLongestMoved); ++j) {
        better = moveForward(tour, i, j) || moveBackward(tour, i, j) || better;
      }
    }
    return better;
  }

  bool moveForward(Tour& tour, std::size_t i, std::size_t j) {
    int least = rank(tour[i]);
    for (std::size_t k = i; k <= j; ++k) least = std::min(least, rank(tour[k]));
    for (std::size_t k = j + 2; k <= std::min(tour.size(), j + window_); ++k) {
      if (rank(tour[k - 1]) > least) return false;
      if (tryMove(tour, i, j, k)) return true;
    }
    return false;
  }

  bool moveBackward(Tour& tour, std::size_t i, std::size_t j) {
    int most = rank(tour[i]);
    for (std::size_t k = i; k <= j; ++k) most = std::max(most, rank(tour[k]));
    for (std::size_t k = i; k-- > (i > window_ ? i - window_ : 0);) {
      if (rank(tour[k]) < most) return false;
      if (tryMove(tour, i, j, k)) return true;
    }
    return false;
  }

  bool tryMove(Tour& tour, std::size_t i, std::size_t j, std::size_t k) {
    const double closed_mm = i > 0 && j + 1 < tour.size() ? gap(tour[i - 1], tour[j + 1]) : 0.0;
    const double saved = gapBefore(tour, i) + gapBefore(tour, j + 1) - closed_mm + gapBefore(tour, k);
    for (const bool turn : {false, true}) {
      if (turn && j > i && !flat(tour, i, j)) continue;
      const Visit first = turn ? turned(tour[j]) : tour[i];
      const Visit last = turn ? turned(tour[i]) : tour[j];
      const double added =
          (k > 0 ? gap(tour[k - 1], first) : 0.0) + (k < tour.size() ? gap(last, tour[k]) : 0.0);
      if (saved - added <= kGainMm) continue;
      const auto move = [&](Tour& changed) {
        if (turn) turnRound(changed, i, j);
        const auto from = changed.begin() + std::ptrdiff_t(i);
        const auto end = changed.begin() + std::ptrdiff_t(j) + 1;
        const auto to = changed.begin() + std::ptrdiff_t(k);
        if (k > j) {
          std::rotate(from, end, to);
        } else {
          std::rotate(to, from, end);
        }
      };
      if (take(tour, move)) return true;
    }
    return false;
  }

  [[nodiscard]] bool flat(const Tour& tour, std::size_t i, std::size_t j) const {
    for (std::size_t k = i + 1; k <= j; ++k) {
      if (rank(tour[k]) > rank(tour[k - 1])) return false;
    }
    return true;
  }

  /// Exchanges three pieces with others of their rank's stretch, and begins them elsewhere; false if nothing
  /// moved.
  bool disturb(Tour& tour) {
    bool moved = false;
    for (int i = 0; i < 3; ++i) {
      const std::size_t a = next() % tour.size();
      std::size_t low = a;
      std::size_t high = a;
      while (low > 0 && rank(tour[low - 1]) == rank(tour[a])) --low;
      while (high + 1 < tour.size() && rank(tour[high + 1]) == rank(tour[a])) ++high;
      const std::size_t b = low + next() % (high - low + 1);
      moved = moved || a != b;
      std::swap(tour[a], tour[b]);
      tour[a].variant = next() % variants_[tour[a].piece].size();
    }
    return moved;
  }

  /// Random number by Numerical Recipes' generator: any will do, but it must be the same everywhere.
  std::size_t next() {
    random_ = random_ * 1664525U + 1013904223U;
    return random_ >> 8;
  }

  std::vector<Stop> stops_;
  std::vector<std::vector<Variant>> variants_;
  std::function<bool(const std::vector<Stop>&)> fits_;
  int questions_;
  std::size_t window_;
  std::uint32_t random_{20140917};
};

}  // namespace

double airPathMm(const std::vector<Stop>& order) {
  double sum = 0.0;
  for (std::size_t i = 1; i < order.size(); ++i) {
    sum += (order[i].chain.start() - order[i - 1].chain.end()).norm();
  }
  return sum;
}

std::vector<Stop> shortened(std::vector<Stop> order,
                            const std::function<bool(const std::vector<Stop>&)>& fits, int most_questions) {
  if (order.size() < 2) return order;
  return Search(std::move(order), fits, most_questions).best();
}

std::vector<Stop> withNearestStarts(std::vector<Stop> order) {
  if (order.size() < 2) return order;
  return Search(std::move(order), {}, 0).inGivenOrder();
}

}  // namespace kerfbench::planner
