// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/order/chains.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Geometry>

#include "firmware_under_test/planner/geometry/flatten.h"
#include "firmware_under_test/planner/order/kerf.h"
#include "hil/dieline/geometry.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;

/// Tolerance of a flattened curve and of a polygon; leaves half of the 2 um for the four decimals of the
/// G-code.
constexpr double kFlattenMm = 0.001;

double zOf(dieline::Process process, const JobParameters& job) {
  return process == dieline::Process::kHalfCut || process == dieline::Process::kCrease ? job.half_z : 1.0;
}

/// Takes the unused chain that goes on from `last` with the smallest turn, in its right sense.
std::optional<Chain> takeNext(std::vector<Chain>& pool, const Chain& so_far) {
  const Segment& last = so_far.segments.back();
  double best_turn = std::numeric_limits<double>::infinity();
  std::size_t best = 0;
  bool best_reversed = false;
  for (std::size_t i = 0; i < pool.size(); ++i) {
    if (pool[i].process != so_far.process || pool[i].closed()) continue;
    for (const bool reverse : {false, true}) {
      const Vector2d& from = reverse ? pool[i].end() : pool[i].start();
      if ((from - last.end_mm).norm() >= kJoinMm) continue;
      const Segment first = reverse ? pool[i].segments.back().reversed() : pool[i].segments.front();
      const double turn = turnRad(last, first);
      if (turn < best_turn) {
        best_turn = turn;
        best = i;
        best_reversed = reverse;
      }
    }
  }
  if (!std::isfinite(best_turn)) return std::nullopt;
  Chain next = pool[best];
  if (best_reversed) next.segments = reversedPath(next.segments);
  pool.erase(pool.begin() + static_cast<std::ptrdiff_t>(best));
  return next;
}

void extend(Chain& chain, std::vector<Chain>& pool) {
  while (!chain.closed()) {
    const std::optional<Chain> next = takeNext(pool, chain);
    if (!next) return;
    chain.segments.insert(chain.segments.end(), next->segments.begin(), next->segments.end());
  }
}

void rotateToDownstreamCorner(Chain& chain) {
  auto& segments = chain.segments;
  if (segments.size() < 2) return;
  std::size_t best = 0;
  bool best_corner = false;
  double best_x = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Segment& before = segments[(i + segments.size() - 1) % segments.size()];
    const bool corner = turnRad(before, segments[i]) > kTangentRad;
    const double x = segments[i].start_mm.x();
    if ((corner && !best_corner) || (corner == best_corner && x > best_x + kJoinMm)) {
      best = i;
      best_corner = corner;
      best_x = x;
    }
  }
  std::rotate(segments.begin(), segments.begin() + static_cast<std::ptrdiff_t>(best), segments.end());
}

/// Chords of an arc that leave it by no more than the tolerance: a hole may lie close to a large outline.
int chordsOf(const Segment& arc) {
  const double widest_rad = 2.0 * std::acos(1.0 - std::min(1.0, kFlattenMm / arc.radiusMm()));
  return 4 + static_cast<int>(std::abs(arc.sweep_rad) / widest_rad);
}

std::vector<Vector2d> polygonOf(const Chain& chain) {
  std::vector<Vector2d> points;
  for (const Segment& segment : chain.segments) {
    const int parts = segment.isArc() ? chordsOf(segment) : 1;
    for (int i = 0; i < parts; ++i) points.push_back(segment.at(segment.lengthMm() * i / parts));
  }
  return points;
}

/// Whether p is inside, by the even-odd rule.
bool inside(const std::vector<Vector2d>& polygon, const Vector2d& p) {
  bool in = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vector2d& a = polygon[i];
    const Vector2d& b = polygon[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x()) {
      in = !in;
    }
  }
  return in;
}

void setNesting(std::vector<Chain>& chains) {
  for (std::size_t i = 0; i < chains.size(); ++i) {
    if (chains[i].process != dieline::Process::kCut || !chains[i].closed()) continue;
    const std::vector<Vector2d> polygon = polygonOf(chains[i]);
    Eigen::AlignedBox2d box;
    for (const Vector2d& p : polygon) box.extend(p);
    for (std::size_t j = 0; j < chains.size(); ++j) {
      if (j == i) continue;
      const Segment& probe = chains[j].segments[chains[j].segments.size() / 2];
      const Vector2d p = probe.at(0.5 * probe.lengthMm());
      if (box.contains(p) && inside(polygon, p)) ++chains[j].nesting;
    }
  }
}

/// The entity as it was drawn, whether it is selected or not.
Chain chainOf(const dieline::Entity& entity, const JobParameters& job) {
  Chain chain;
  chain.process = dieline::drawnFor(entity);
  for (Segment segment : flatten(entity.curve, kFlattenMm)) {
    segment.entity = entity.id;
    segment.z = zOf(chain.process, job);
    if (segment.lengthMm() > 0.0) chain.segments.push_back(segment);
  }
  return chain;
}

std::vector<Chain> joined(std::vector<Chain> pool) {
  std::vector<Chain> chains;
  while (!pool.empty()) {
    Chain chain = pool.front();
    pool.erase(pool.begin());
    extend(chain, pool);
    if (!chain.closed()) {
      chain.segments = reversedPath(chain.segments);
      extend(chain, pool);
      chain.segments = reversedPath(chain.segments);
    }
    chains.push_back(std::move(chain));
  }
  return chains;
}

/// Lays the pattern along a chain without a corner.
void addDashes(const Chain& chain, const JobParameters& job, std::vector<Segment>& dashes) {
  double length_mm = 0.0;
  for (const Segment& segment : chain.segments) length_mm += segment.lengthMm();
  const bool endless =
      chain.closed() && turnRad(chain.segments.back(), chain.segments.front()) <= kTangentRad;
  const double cut_mm = job.perforation_cut_mm;
  const double pattern_mm = cut_mm + job.perforation_gap_mm;
  const double wanted = (endless ? length_mm : length_mm + job.perforation_gap_mm) / pattern_mm;
  const int cuts = std::max(1, static_cast<int>(std::lround(wanted)));
  const double scale = length_mm / (endless ? cuts * pattern_mm : cuts * pattern_mm - job.perforation_gap_mm);
  double s0_mm = 0.0;
  for (const Segment& segment : chain.segments) {
    const double s1_mm = s0_mm + segment.lengthMm();
    for (int i = 0; i < cuts; ++i) {
      const double from_mm = std::max(s0_mm, i * pattern_mm * scale);
      const double to_mm = std::min(s1_mm, (i * pattern_mm + cut_mm) * scale);
      // A sliver of a dash beyond a joint is too short for a G-code line.
      if (to_mm - from_mm > 1e-3) dashes.push_back(segment.part(from_mm - s0_mm, to_mm - s0_mm));
    }
    s0_mm = s1_mm;
  }
}

}  // namespace

std::set<int> leftOut(const dieline::Dieline& dieline) {
  std::set<int> ids;
  for (const dieline::Entity& entity : dieline.entities) {
    if (entity.left_out) ids.insert(entity.id);
  }
  return ids;
}

std::vector<Chain> stretchesOf(const Chain& chain, const std::function<bool(int)>& wanted) {
  const auto isWanted = [&](const Segment& segment) { return wanted(segment.entity); };
  std::vector<Segment> segments = chain.segments;
  const auto gap = std::find_if_not(segments.begin(), segments.end(), isWanted);
  if (gap == segments.end()) return {chain};
  if (chain.closed()) std::rotate(segments.begin(), gap, segments.end());
  std::vector<Chain> stretches;
  bool goes_on = false;
  for (const Segment& segment : segments) {
    const bool is_wanted = isWanted(segment);
    if (is_wanted && !goes_on) stretches.push_back({chain.process, {}, chain.nesting});
    if (is_wanted) stretches.back().segments.push_back(segment);
    goes_on = is_wanted;
  }
  return stretches;
}

std::vector<Chain> joinChains(const dieline::Dieline& dieline, const JobParameters& job,
                              const PlannerFaults& faults) {
  std::vector<Chain> pool;
  std::vector<Chain> twice;
  for (const dieline::Entity& entity : dieline.entities) {
    if (dieline::drawnFor(entity) == dieline::Process::kIgnore || entity.id == faults.skip_entity) continue;
    Chain chain = chainOf(entity, job);
    if (chain.segments.empty()) continue;
    if (entity.id == faults.repeat_entity && !entity.left_out) twice.push_back(chain);
    pool.push_back(std::move(chain));
  }
  std::vector<Chain> chains = joined(std::move(pool));
  const std::set<int> left_out = leftOut(dieline);
  if (job.kerf_radius_mm > 0.0) {
    setNesting(chains);
    chains = compensate(chains, job, faults, left_out).chains;
  }
  for (Chain& chain : chains) {
    chain.nesting = 0;
    if (chain.closed()) rotateToDownstreamCorner(chain);
  }
  chains.insert(chains.end(), twice.begin(), twice.end());
  setNesting(chains);
  if (left_out.empty()) return chains;
  std::vector<Chain> selected;
  for (const Chain& chain : chains) {
    for (Chain& stretch : stretchesOf(chain, [&](int entity) { return !left_out.contains(entity); }))
      selected.push_back(std::move(stretch));
  }
  return selected;
}

std::vector<Chain> brokenAtCorners(const Chain& chain) {
  std::vector<Chain> pieces;
  for (const Segment& segment : chain.segments) {
    const bool corner = pieces.empty() || turnRad(pieces.back().segments.back(), segment) > kTangentRad;
    if (corner) pieces.push_back(Chain{chain.process, {}, chain.nesting});
    pieces.back().segments.push_back(segment);
  }
  return pieces;
}

std::vector<Segment> dashed(const Chain& chain, const JobParameters& job) {
  std::vector<Segment> dashes;
  for (const Chain& run : brokenAtCorners(chain)) addDashes(run, job, dashes);
  return dashes;
}

}  // namespace kerfbench::planner
