// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/evidence/spot_association.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <span>

#include "hil/dieline/geometry.h"
#include "hil/inspect/evidence/entity_index.h"
#include "twin/base/statistics.h"

namespace kerfbench::inspect {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kMaxPoseGap_s = 0.25;

// Costs of the association. Distance and angle in units of what a good release shows at most.
constexpr double kDistanceScale_mm = 0.1;
constexpr double kAngleScale_rad = 0.15;
constexpr double kTermCap = 9.0;
constexpr double kNoEntityCost = 9.5;
constexpr double kChangeCost = 1.0;
constexpr double kMinChord_mm = 0.05;  // Shorter steps tell no direction.
constexpr double kOtherWay_rad = 0.17;
constexpr double kTurn_rad = 0.35;  // Less is no corner.

/// All poses of one unit over time. They must outlive it.
class PoseTrack {
 public:
  void add(double time_s, const vision::SheetPose& pose) { poses_.emplace_back(time_s, &pose); }

  [[nodiscard]] std::optional<vision::SheetPose> at(double time_s) const {
    const auto after = std::lower_bound(poses_.begin(), poses_.end(), time_s,
                                        [](const auto& entry, double t) { return entry.first < t; });
    if (after == poses_.end()) return std::nullopt;
    if (after->first == time_s) return *after->second;
    if (after == poses_.begin()) return std::nullopt;
    const auto before = after - 1;
    if (after->first - before->first > kMaxPoseGap_s) return std::nullopt;
    const double share = (time_s - before->first) / (after->first - before->first);
    const vision::SheetPose& earlier = *before->second;
    const vision::SheetPose& later = *after->second;
    vision::SheetPose pose = earlier;
    pose.p_WS_mm += share * (later.p_WS_mm - earlier.p_WS_mm);
    pose.angle_rad += share * (later.angle_rad - earlier.angle_rad);
    pose.covariance = (1.0 - share) * (1.0 - share) * earlier.covariance + share * share * later.covariance;
    return pose;
  }

 private:
  std::vector<std::pair<double, const vision::SheetPose*>> poses_;
};

/// Standard uncertainty, per axis, of where the sheet is under a point, by one frame's marks.
double sheetSigma(const vision::SheetPose& pose, const Eigen::Vector2d& p_S_mm) {
  if (!(pose.covariance.trace() > 0.0)) {
    // Nothing stated: the marks' own scatter tells.
    return std::isfinite(pose.residual_mm) && pose.marks > 1 ? pose.residual_mm / std::sqrt(pose.marks - 1.0)
                                                             : 0.0;
  }
  const Eigen::Vector2d arm = Eigen::Rotation2Dd(pose.angle_rad) * p_S_mm;
  Eigen::Matrix<double, 2, 3> J;
  J << 1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x();
  return std::sqrt(0.5 * (J * pose.covariance * J.transpose()).trace());
}

Eigen::Vector2d sheetFromWork(const vision::SheetPose& pose, const Eigen::Vector2d& p_W_mm) {
  return Eigen::Rotation2Dd(-pose.angle_rad) * (p_W_mm - pose.p_WS_mm);
}

double angleBetweenLines(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const double cross = a.x() * b.y() - a.y() * b.x();
  return std::atan2(std::abs(cross), std::abs(a.dot(b)));
}

struct Candidate {
  int entity{};
  dieline::Nearest nearest;
  Eigen::Vector2d tangent{Eigen::Vector2d::UnitX()};
};

/// Cost of a spot belonging to a candidate: distance, and direction against the step before or after,
/// whichever fits better, so that the frames around a corner keep their line.
double costOf(const Candidate& c, const Eigen::Vector2d& step_before, const Eigen::Vector2d& step_after) {
  const double distance = c.nearest.distance_mm / kDistanceScale_mm;
  std::optional<double> angle_rad;
  for (const Eigen::Vector2d& step : {step_before, step_after}) {
    if (step.norm() < kMinChord_mm) continue;
    const double a = angleBetweenLines(step, c.tangent);
    angle_rad = angle_rad ? std::min(*angle_rad, a) : a;
  }
  const double angle = angle_rad.value_or(0.0) / kAngleScale_rad;
  return std::min(distance * distance, kTermCap) + std::min(angle * angle, kTermCap);
}

class RunFollower {
 public:
  RunFollower(const dieline::Dieline& dieline, const EntityIndex& index) : dieline_(dieline), index_(index) {}

  void follow(std::span<LitFrame> run, std::span<const double> angles_rad) const {
    const std::vector<std::vector<Candidate>> candidates = findCandidates(run);
    const std::vector<std::size_t> chosen = cheapestPath(run, candidates);
    for (std::size_t i = 0; i < run.size(); ++i) {
      if (chosen[i] < candidates[i].size()) assign(run[i], candidates[i], chosen[i], angles_rad[i]);
    }
    measureThoseThatLeft(run, angles_rad);
  }

 private:
  [[nodiscard]] std::vector<std::vector<Candidate>> findCandidates(std::span<LitFrame> run) const {
    std::vector<std::vector<Candidate>> candidates(run.size());
    for (std::size_t i = 0; i < run.size(); ++i) {
      run[i].distance_mm = kSearch_mm;
      for (const int id : index_.near(run[i].p_S_mm)) {
        const dieline::Curve& curve = dieline_.entities[static_cast<std::size_t>(id)].curve;
        const dieline::Nearest nearest = dieline::nearestOn(curve, run[i].p_S_mm);
        run[i].distance_mm = std::min(run[i].distance_mm, nearest.distance_mm);
        if (nearest.distance_mm <= kReach_mm) {
          candidates[i].push_back({id, nearest, dieline::tangentAt(curve, nearest.u)});
        }
      }
    }
    return candidates;
  }

  /// Index of the chosen candidate of each frame; one past the last for "none of them".
  static std::vector<std::size_t> cheapestPath(std::span<const LitFrame> run,
                                               const std::vector<std::vector<Candidate>>& candidates) {
    const auto entityAt = [&](std::size_t frame, std::size_t state) {
      return state < candidates[frame].size() ? candidates[frame][state].entity : -1;
    };
    std::vector<std::vector<std::size_t>> from(run.size());
    std::vector<double> cost;
    for (std::size_t i = 0; i < run.size(); ++i) {
      const Eigen::Vector2d before =
          i > 0 ? Eigen::Vector2d(run[i].p_S_mm - run[i - 1].p_S_mm) : Eigen::Vector2d::Zero();
      const Eigen::Vector2d after =
          i + 1 < run.size() ? Eigen::Vector2d(run[i + 1].p_S_mm - run[i].p_S_mm) : Eigen::Vector2d::Zero();
      const std::size_t states = candidates[i].size() + 1;
      std::vector<double> next(states);
      from[i].assign(states, 0);
      for (std::size_t s = 0; s < states; ++s) {
        double best = i == 0 ? 0.0 : std::numeric_limits<double>::infinity();
        for (std::size_t p = 0; p < cost.size(); ++p) {
          const double c = cost[p] + (entityAt(i - 1, p) == entityAt(i, s) ? 0.0 : kChangeCost);
          if (c < best) {
            best = c;
            from[i][s] = p;
          }
        }
        next[s] = best + (s < candidates[i].size() ? costOf(candidates[i][s], before, after) : kNoEntityCost);
      }
      cost = std::move(next);
    }
    std::vector<std::size_t> chosen(run.size());
    auto state = static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
    for (std::size_t i = run.size(); i-- > 0;) {
      chosen[i] = state;
      state = from[i][state];
    }
    return chosen;
  }

  void assign(LitFrame& frame, const std::vector<Candidate>& candidates, std::size_t chosen,
              double angle_rad) const {
    const Candidate& c = candidates[chosen];
    frame.entity = c.entity;
    measure(frame, c, angle_rad);
    frame.ambiguous = std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& other) {
      return other.entity != c.entity && angleBetweenLines(other.tangent, c.tangent) > kOtherWay_rad;
    });
  }

  void measure(LitFrame& frame, const Candidate& c, double angle_rad) const {
    const Eigen::Vector2d normal_S(-c.tangent.y(), c.tangent.x());
    const dieline::Curve& curve = dieline_.entities[static_cast<std::size_t>(c.entity)].curve;
    frame.deviation_mm = (frame.p_S_mm - dieline::pointAt(curve, c.nearest.u)).dot(normal_S);
    frame.n_x = (Eigen::Rotation2Dd(angle_rad) * normal_S).x();
  }

  void measureThoseThatLeft(std::span<LitFrame> run, std::span<const double> angles_rad) const {
    std::vector<int> next(run.size() + 1, -1);
    for (std::size_t i = run.size(); i-- > 0;) next[i] = run[i].entity >= 0 ? run[i].entity : next[i + 1];
    int last = -1;
    for (std::size_t i = 0; i < run.size(); ++i) {
      if (run[i].entity >= 0) last = run[i].entity;
      if (!isOffLine(run[i]) || (last >= 0 && next[i] >= 0 && last != next[i])) continue;
      const int entity = std::max(last, next[i]);
      if (entity < 0) continue;
      const dieline::Curve& curve = dieline_.entities[static_cast<std::size_t>(entity)].curve;
      const dieline::Nearest nearest = dieline::nearestOn(curve, run[i].p_S_mm);
      if (!dieline::isClosed(curve) && !(nearest.u > 0.0 && nearest.u < 1.0)) continue;
      run[i].left_entity = entity;
      measure(run[i], {entity, nearest, dieline::tangentAt(curve, nearest.u)}, angles_rad[i]);
    }
    markThoseBeside(run);
  }

  /// Stretches off every line between two frames on one and the same entity.
  void markThoseBeside(std::span<LitFrame> run) const {
    for (std::size_t begin = 1; begin < run.size(); ++begin) {
      const int entity = run[begin - 1].entity;
      if (entity < 0 || run[begin].left_entity != entity) continue;
      std::size_t end = begin;
      while (end < run.size() && run[end].left_entity == entity) ++end;
      if (end < run.size() && run[end].entity == entity && goesAlong(run, begin - 1, end, entity))
        for (std::size_t i = begin; i < end; ++i) run[i].beside = true;
      begin = end;
    }
  }

  /// Whether the way from one frame to another leads along an entity, but for a tenth.
  [[nodiscard]] bool goesAlong(std::span<const LitFrame> run, std::size_t from, std::size_t to,
                               int entity) const {
    constexpr double kAlong = 0.9;
    const dieline::Curve& curve = dieline_.entities[static_cast<std::size_t>(entity)].curve;
    double along_mm = 0.0;
    double way_mm = 0.0;
    for (std::size_t i = from + 1; i <= to; ++i) {
      const Eigen::Vector2d step_mm = run[i].p_S_mm - run[i - 1].p_S_mm;
      along_mm += step_mm.dot(dieline::tangentAt(curve, dieline::nearestOn(curve, run[i].p_S_mm).u));
      way_mm += step_mm.norm();
    }
    return std::abs(along_mm) >= kAlong * way_mm;
  }

  const dieline::Dieline& dieline_;
  const EntityIndex& index_;
};

/// A spot on the unit that lies nearest to it, and how that unit is turned.
struct PlacedSpot {
  LitFrame frame;
  double angle_rad;
};

std::optional<PlacedSpot> placeOnUnit(const vision::FrameMeasurement& frame, std::size_t index,
                                      const std::map<int, PoseTrack>& poses, const Eigen::AlignedBox2d& box) {
  std::optional<PlacedSpot> best;
  double best_distance_mm = 0.0;
  for (const auto& [unit, pose_track] : poses) {
    const auto pose = pose_track.at(frame.mid_s);
    if (!pose) continue;
    const Eigen::Vector2d p_S_mm = sheetFromWork(*pose, *frame.spot_W_mm);
    const double distance_mm = box.exteriorDistance(p_S_mm);
    if (best && distance_mm >= best_distance_mm) continue;
    best = PlacedSpot{LitFrame{.frame = index,
                               .time_s = frame.mid_s,
                               .sigma_mm = std::hypot(frame.spot_sigma_mm, sheetSigma(*pose, p_S_mm)),
                               .unit = unit,
                               .p_S_mm = p_S_mm,
                               .marks = pose->seen,
                               .sheet_x_mm = pose->p_WS_mm.x(),
                               .entity = -1,
                               .left_entity = -1,
                               .beside = false,
                               .deviation_mm = kNan,
                               .n_x = 0.0,
                               .distance_mm = kSearch_mm,
                               .ambiguous = false},
                      pose->angle_rad};
    best_distance_mm = distance_mm;
  }
  return best;
}

/// Whether the gate stays open from one time to another.
bool isOpenBetween(const std::vector<GateInterval>& by_time, double from_s, double to_s) {
  const auto after = std::ranges::upper_bound(by_time, from_s, {}, &GateInterval::on_s);
  return after != by_time.begin() && to_s <= (after - 1)->off_s;
}

/// Whether the way from the last frame of a run to a place goes on in the direction in which the spot came,
/// over its last frames. Not where it hardly moved.
bool goesStraightOn(std::span<const LitFrame> run, const Eigen::Vector2d& to_mm) {
  constexpr std::size_t kBack = 4;
  const LitFrame& last = run.back();
  const Eigen::Vector2d came = last.p_S_mm - run[run.size() - std::min(run.size(), kBack)].p_S_mm;
  const Eigen::Vector2d goes = to_mm - last.p_S_mm;
  if (came.norm() < kMinChord_mm || goes.norm() < kMinChord_mm) return false;
  return came.dot(goes) > std::cos(kTurn_rad) * came.norm() * goes.norm();
}

}  // namespace

LitFrames followDieline(const vision::SpotTrack& track, const dieline::Dieline& dieline,
                        std::vector<GateInterval> gates) {
  std::ranges::sort(gates, {}, &GateInterval::on_s);
  LitFrames result;
  std::map<int, PoseTrack> poses;
  std::vector<double> periods;
  for (std::size_t i = 0; i < track.frames.size(); ++i) {
    for (const vision::SheetPose& pose : track.frames[i].sheet)
      poses[pose.unit].add(track.frames[i].mid_s, pose);
    if (i > 0) periods.push_back(track.frames[i].mid_s - track.frames[i - 1].mid_s);
  }
  result.period_s = medianOf(std::move(periods));

  const double dark_s = std::max(kDark_s, kDarkFrames * result.period_s);
  const Eigen::AlignedBox2d box = dieline.bounds();
  std::vector<double> angles_rad;
  for (std::size_t i = 0; i < track.frames.size(); ++i) {
    const vision::FrameMeasurement& frame = track.frames[i];
    if (!frame.spot_W_mm) continue;
    ++result.lit;
    const std::optional<PlacedSpot> placed = placeOnUnit(frame, i, poses, box);
    if (!placed) {
      ++result.unplaced;
      continue;
    }
    const auto continues = [&](const LitFrame& last) {
      if (last.unit != placed->frame.unit) return false;
      if (track.frames[last.frame].sequence + 1 == frame.sequence) return true;
      return frame.mid_s - last.time_s <= dark_s && isOpenBetween(gates, last.time_s, frame.mid_s) &&
             goesStraightOn(std::span(result.frames).subspan(result.runs.back().begin), placed->frame.p_S_mm);
    };
    if (result.frames.empty() || !continues(result.frames.back()))
      result.runs.push_back({result.frames.size(), result.frames.size()});
    result.frames.push_back(placed->frame);
    angles_rad.push_back(placed->angle_rad);
    result.runs.back().end = result.frames.size();
  }

  const EntityIndex index(dieline);
  const RunFollower follower(dieline, index);
  for (const LitRun& run : result.runs) {
    const std::size_t count = run.end - run.begin;
    follower.follow(std::span(result.frames).subspan(run.begin, count),
                    std::span<const double>(angles_rad).subspan(run.begin, count));
  }
  return result;
}

}  // namespace kerfbench::inspect
