// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/run/program_follower.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/job/job.h"
#include "hil/trace/run/chord.h"

namespace kerfbench::trace {
namespace {

constexpr double kChord_mm = 0.5;
/// The head is on a line that is as near as this: more than rounded corners and the lead over the belt.
constexpr double kOnLine_mm = 0.4;
/// A head at 2 m/s makes a millimetre in a quantum.
constexpr double kReach_mm = 8.0;
/// Beyond the reach, after a jump on a way of its own, a line has to be as near as this.
constexpr double kFoundAgain_mm = 0.1;
/// A line that lies 1 mm ahead must be nearer by so much than the one that the head was on.
constexpr double kForwardCost = 0.01;

}  // namespace

ProgramFollower::ProgramFollower(const std::string& gcode, const UnitOrder& order) : order_(order) {
  std::vector<planner::Segment> path;
  try {
    path = planner::readGcode(gcode);
  } catch (const planner::PlanError&) {
    return;
  }
  for (const planner::Segment& segment : path) {
    const double length_mm = segment.lengthMm();
    const int parts = segment.isArc() ? std::max(1, static_cast<int>(std::ceil(length_mm / kChord_mm))) : 1;
    Eigen::Vector2d before = segment.start_mm;
    for (int i = 1; i <= parts; ++i) {
      const Eigen::Vector2d after = segment.at(length_mm * i / parts);
      forward_.push_back({before, after, (after - before).norm(), segment.line, segment.jump});
      before = after;
    }
  }
  backward_ = forward_;
  std::ranges::reverse(backward_);
  for (Chord& chord : backward_) std::swap(chord.from_mm, chord.to_mm);
}

const std::vector<ProgramFollower::Chord>& ProgramFollower::pathOf(int unit) const {
  return order_.alternate && unit % 2 == 1 ? backward_ : forward_;
}

Eigen::Vector2d ProgramFollower::inUnit(int unit, const Eigen::Vector2d& p_S_mm) const {
  return p_S_mm + Eigen::Vector2d(order_.pitch_mm * unit, 0.0);
}

ProgramFollower::Nearest ProgramFollower::nearestAhead(const std::vector<Chord>& path, std::size_t from,
                                                       double reach_mm, const Eigen::Vector2d& p_mm) {
  Nearest nearest{from, std::numeric_limits<double>::infinity()};
  double cost = std::numeric_limits<double>::infinity();
  double ahead_mm = 0.0;
  for (std::size_t i = from; i < path.size() && ahead_mm <= reach_mm; ++i) {
    const double away_mm = distanceToChord_mm(p_mm, path[i].from_mm, path[i].to_mm);
    if (away_mm + kForwardCost * ahead_mm < cost) {
      cost = away_mm + kForwardCost * ahead_mm;
      nearest = {i, away_mm};
    }
    ahead_mm += path[i].length_mm;
  }
  return nearest;
}

bool ProgramFollower::begins(int unit, const Eigen::Vector2d& p_S_mm) const {
  if (unit >= order_.units) return false;
  return nearestAhead(pathOf(unit), 0, 0.0, inUnit(unit, p_S_mm)).distance_mm <= kOnLine_mm;
}

ProgramFollower::Place ProgramFollower::follow(const Eigen::Vector2d& p_S_mm) {
  if (forward_.empty() || !p_S_mm.allFinite()) return {};
  if (unit_ >= 0) {
    const std::vector<Chord>& path = pathOf(unit_);
    const Eigen::Vector2d p_mm = inUnit(unit_, p_S_mm);
    Nearest nearest = nearestAhead(path, at_, kReach_mm, p_mm);
    bool is_found = nearest.distance_mm <= kOnLine_mm;
    if (!is_found && !begins(unit_ + 1, p_S_mm)) {
      nearest = nearestAhead(path, at_, std::numeric_limits<double>::infinity(), p_mm);
      is_found = nearest.distance_mm <= kFoundAgain_mm;
    }
    if (is_found) {
      at_ = nearest.index;
      return {path[at_].line, unit_};
    }
    // A jump has a way of its own where arcs lead into it.
    const bool jumps = path[at_].jump || (at_ + 1 < path.size() && path[at_ + 1].jump);
    if (jumps && !begins(unit_ + 1, p_S_mm))
      return {path[at_].jump ? path[at_].line : path[at_ + 1].line, unit_};
  }
  if (!begins(unit_ + 1, p_S_mm)) return {};
  ++unit_;
  at_ = 0;
  return {pathOf(unit_).front().line, unit_};
}

}  // namespace kerfbench::trace
