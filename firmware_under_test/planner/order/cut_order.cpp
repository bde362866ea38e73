// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/order/cut_order.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>

#include "firmware_under_test/planner/motion/solve.h"
#include "firmware_under_test/planner/order/chains.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

double downstreamMm(const std::vector<Segment>& path) {
  double x = -std::numeric_limits<double>::infinity();
  for (const Segment& segment : path) {
    const int parts = segment.isArc() ? 16 : 1;
    for (int i = 0; i <= parts; ++i) x = std::max(x, segment.at(segment.lengthMm() * i / parts).x());
  }
  return x;
}

/// Rank of a chain: a lower one comes first.
int rankOf(const Chain& chain, int deepest) {
  return chain.process == dieline::Process::kCut ? 1 + deepest - chain.nesting : 0;
}

/// Whether a path along a curve runs from its end to its start. Told by the longest segment, which is not one
/// of a corner's.
bool runsAgainst(const std::vector<Segment>& path, const dieline::Curve& curve) {
  const auto longest = std::ranges::max_element(path, {}, &Segment::lengthMm);
  const double middle_mm = 0.5 * longest->lengthMm();
  const Vector2d t = dieline::tangentAt(curve, dieline::nearestOn(curve, longest->at(middle_mm)).u);
  return longest->tangentAt(middle_mm).dot(t) < 0.0;
}

struct Choice {
  std::size_t index{};
  bool reverse{};
};

/// Chooses the next chain: on a moving sheet from those that leave the field first, then the nearest end. The
/// choice is among the lowest rank, in the whole unit or among those that leave first.
Choice nextOf(const std::vector<Chain>& pool, const std::vector<int>& ranks,
              const std::vector<double>& downstream, const Vector2d& p, bool moving,
              const OrderOptions& options) {
  const double band_mm = options.band_mm;
  const bool place_first = moving && options.place_before_process;
  std::vector<bool> allowed(pool.size(), true);
  const auto keepLowestRank = [&] {
    int lowest = std::numeric_limits<int>::max();
    for (std::size_t i = 0; i < pool.size(); ++i) lowest = allowed[i] ? std::min(lowest, ranks[i]) : lowest;
    for (std::size_t i = 0; i < pool.size(); ++i) allowed[i] = allowed[i] && ranks[i] == lowest;
  };
  if (!place_first) keepLowestRank();
  if (moving) {
    double first_x = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < pool.size(); ++i)
      first_x = allowed[i] ? std::max(first_x, downstream[i]) : first_x;
    for (std::size_t i = 0; i < pool.size(); ++i)
      allowed[i] = allowed[i] && downstream[i] >= first_x - band_mm;
  }
  if (place_first) keepLowestRank();
  Choice best;
  double best_mm = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < pool.size(); ++i) {
    if (!allowed[i]) continue;
    // A moving sheet lets an open chain be entered at its downstream end, unless both ends lie within the
    // band.
    const double lead_mm = pool[i].start().x() - pool[i].end().x();
    for (const bool reverse : {false, true}) {
      if (reverse && pool[i].closed()) continue;
      if (moving && (reverse ? lead_mm > band_mm : lead_mm < -band_mm)) continue;
      const double distance_mm = ((reverse ? pool[i].end() : pool[i].start()) - p).norm();
      if (distance_mm < best_mm - 1e-9) {
        best_mm = distance_mm;
        best = {i, reverse};
      }
    }
  }
  return best;
}

}  // namespace

std::vector<Stop> nearestOrder(const dieline::Dieline& dieline, const JobParameters& job,
                               const PlannerFaults& faults, const OrderOptions& options) {
  std::vector<Chain> pool;
  for (const Chain& chain : joinChains(dieline, job, faults)) {
    if (!options.break_at_corners) {
      pool.push_back(chain);
      continue;
    }
    for (Chain& piece : brokenAtCorners(chain)) pool.push_back(std::move(piece));
  }
  int deepest = 0;
  for (const Chain& chain : pool) deepest = std::max(deepest, chain.nesting);
  std::vector<int> ranks;
  std::vector<double> downstream;
  for (const Chain& chain : pool) {
    ranks.push_back(rankOf(chain, deepest));
    downstream.push_back(downstreamMm(chain.segments));
  }
  std::vector<Stop> order;
  Vector2d p = Vector2d::Zero();
  while (!pool.empty()) {
    const Choice choice = nextOf(pool, ranks, downstream, p, speedWhileCutting(job) > 0.0, options);
    const auto at = static_cast<std::ptrdiff_t>(choice.index);
    Stop stop{std::move(pool[choice.index]), ranks[choice.index]};
    pool.erase(pool.begin() + at);
    ranks.erase(ranks.begin() + at);
    downstream.erase(downstream.begin() + at);
    if (choice.reverse) stop.chain.segments = reversedPath(stop.chain.segments);
    p = stop.chain.end();
    order.push_back(std::move(stop));
  }
  return order;
}

std::map<int, std::vector<Stop>> stopsByEntity(const dieline::Dieline& dieline, const JobParameters& job,
                                               const PlannerFaults& faults) {
  // Perforations and the beam's way beside a cut follow from more than one entity.
  std::vector<Chain> whole = joinChains(dieline, job, faults);
  for (Chain& chain : whole)
    if (chain.process == dieline::Process::kPerforation) chain.segments = dashed(chain, job);
  std::map<int, std::vector<Stop>> stops;
  dieline::Dieline one;
  for (const dieline::Entity& entity : dieline.entities) {
    std::vector<Stop>& of_entity = stops[entity.id];
    const bool has_bridges = entity.process == dieline::Process::kPerforation;
    if (!has_bridges && job.kerf_radius_mm == 0.0) {
      one.entities = {entity};
      for (Chain& chain : joinChains(one, job, faults)) of_entity.push_back({std::move(chain), 0});
      continue;
    }
    for (const Chain& chain : whole) {
      for (Chain& stretch : stretchesOf(chain, [&](int id) { return id == entity.id; })) {
        if (runsAgainst(stretch.segments, entity.curve)) stretch.segments = reversedPath(stretch.segments);
        of_entity.push_back({std::move(stretch), 0, has_bridges});
      }
    }
  }
  return stops;
}

std::vector<Stop> drawnOrder(const dieline::Dieline& dieline, const JobParameters& job,
                             const PlannerFaults& faults) {
  std::map<int, std::vector<Stop>> stops = stopsByEntity(dieline, job, faults);
  std::vector<Stop> order;
  for (const dieline::Entity& entity : dieline.entities) {
    std::ranges::move(stops[entity.id], std::back_inserter(order));
    stops[entity.id].clear();
  }
  return order;
}

std::vector<std::vector<Segment>> piecesOf(const std::vector<Stop>& order, const JobParameters& job) {
  std::vector<std::vector<Segment>> pieces;
  for (const Stop& stop : order) {
    const bool lay = stop.chain.process == dieline::Process::kPerforation && !stop.has_bridges;
    pieces.push_back(lay ? dashed(stop.chain, job) : stop.chain.segments);
  }
  return pieces;
}

std::vector<std::vector<Segment>> cutOrder(const dieline::Dieline& dieline, const JobParameters& job,
                                           const PlannerFaults& faults, const OrderOptions& options) {
  return piecesOf(nearestOrder(dieline, job, faults, options), job);
}

}  // namespace kerfbench::planner
