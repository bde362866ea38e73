// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/asked_path.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace kerfbench::judge {
namespace {

constexpr double kNearFrames_s = 0.02;
constexpr std::size_t kMostFrames = 40;
constexpr double kLongBack_s = 0.02;

Eigen::Vector2d nowhere() { return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN()); }

}  // namespace

AskedPath::AskedPath(const SharedSteps& steps, const PlaceOfSteps& place, double end_s, double delay_s)
    : end_s_(end_s), delay_s_(delay_s) {
  const auto count = static_cast<std::size_t>(std::max(0.0, end_s / kRaster_s)) + 1;
  std::vector<Eigen::Vector2d> whole;
  whole.reserve(count);
  evidence::CountedSteps::Steps before{};
  for (std::size_t i = 0; i < count; ++i) {
    const auto now = steps.at(static_cast<double>(i) * kRaster_s);
    if (i > 0 && now == before) {
      whole.push_back(whole.back());
      continue;
    }
    before = now;
    whole.push_back(place(Eigen::Vector2d(now[0], now[1])).value_or(nowhere()));
  }
  // Steps are those at the end of a raster period: the mean of 2 n + 1 that begin with the one before -n has
  // its middle at 0.
  constexpr auto kHalf = static_cast<std::ptrdiff_t>(0.5 * kSmooth_s / kRaster_s);
  p_mm_.reserve(count);
  const auto size = static_cast<std::ptrdiff_t>(whole.size());
  for (std::ptrdiff_t i = 0; i < size; ++i) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (std::ptrdiff_t k = i - kHalf - 1; k < i + kHalf; ++k)
      sum += whole[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, size - 1))];
    p_mm_.push_back(sum / static_cast<double>(2 * kHalf + 1));
  }
  follow();
}

void AskedPath::follow() {
  // Wider than the steps of an axis that rests.
  constexpr double kHalfPlay_mm = 0.02;
  Eigen::Vector2d middle = p_mm_.empty() ? Eigen::Vector2d(0, 0) : p_mm_.front();
  Eigen::Vector2d forward = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : p_mm_) {
    Eigen::Vector2d flank = Eigen::Vector2d::Zero();
    for (int axis = 0; axis < 2; ++axis) {
      if (std::isnan(p[axis]) || std::isnan(middle[axis])) {
        middle[axis] = p[axis];
        continue;
      }
      const double before = middle[axis];
      middle[axis] = std::clamp(before, p[axis] - kHalfPlay_mm, p[axis] + kHalfPlay_mm);
      forward[axis] += std::max(0.0, middle[axis] - before);
      flank[axis] = (p[axis] - middle[axis]) / kHalfPlay_mm;
    }
    flank_.push_back(flank);
    forward_mm_.push_back(forward);
  }
}

Eigen::Vector2d AskedPath::placeAt(double time_s) const {
  const double at = time_s / kRaster_s;
  if (!(at >= 0.0) || at + 1.0 >= static_cast<double>(p_mm_.size())) return nowhere();
  const auto i = static_cast<std::size_t>(at);
  const double share = at - static_cast<double>(i);
  return (1.0 - share) * p_mm_[i] + share * p_mm_[i + 1];
}

diagnose::HeadState AskedPath::at(double time_s) const {
  constexpr double kSpeed_s = 1e-3;
  constexpr double kForce_s = 3e-3;
  diagnose::HeadState state;
  const double asked_s = time_s - delay_s_;
  const Eigen::Vector2d p_mm = placeAt(asked_s);
  if (!p_mm.allFinite()) return state;
  state.time_s = time_s;
  state.p_mm = p_mm;
  const auto raster = static_cast<std::size_t>(asked_s / kRaster_s);
  state.flank = flank_[raster];
  state.forward_mm = forward_mm_[raster];
  const Eigen::Vector2d v = (placeAt(asked_s + kSpeed_s) - placeAt(asked_s - kSpeed_s)) / (2.0 * kSpeed_s);
  if (v.allFinite()) state.v_mm_s = v;
  const Eigen::Vector2d a =
      (placeAt(asked_s + kForce_s) - 2.0 * p_mm + placeAt(asked_s - kForce_s)) / (kForce_s * kForce_s);
  if (a.allFinite()) state.a_mm_s2 = a;
  return state;
}

SheetPath::SheetPath(const vision::SpotTrack& track, const std::vector<inspect::BeltEdge>& belt,
                     double start_x_mm, const PrintLayout& print)
    : units_(static_cast<std::size_t>(std::max(1, print.units))),
      belt_(belt),
      start_x_mm_(start_x_mm),
      pitch_mm_(print.pitch_mm) {
  for (const vision::FrameMeasurement& frame : track.frames) {
    for (const vision::SheetPose& pose : frame.sheet) {
      if (pose.unit < 0 || static_cast<std::size_t>(pose.unit) >= units_.size() || pose.marks < 2) continue;
      const double variance = pose.covariance(0, 0) + pose.covariance(1, 1);
      units_[static_cast<std::size_t>(pose.unit)].push_back(
          {frame.mid_s, belt_mm(frame.mid_s), pose.p_WS_mm, pose.angle_rad, 1.0 / std::max(variance, 1e-8)});
    }
  }
}

double SheetPath::belt_mm(double time_s) const {
  const auto next = std::ranges::upper_bound(belt_, time_s, {}, &inspect::BeltEdge::time_s);
  if (next == belt_.begin()) return belt_.empty() ? 0.0 : belt_.front().x_mm;
  if (next == belt_.end()) return belt_.back().x_mm;
  const inspect::BeltEdge& before = *(next - 1);
  const double span_s = next->time_s - before.time_s;
  const double share = span_s > 0.0 && span_s < kLongBack_s ? (time_s - before.time_s) / span_s : 0.0;
  return before.x_mm + share * (next->x_mm - before.x_mm);
}

SheetPath::Pose SheetPath::at(int unit, double time_s) const {
  const double belt = belt_mm(time_s);
  const auto index = static_cast<std::size_t>(std::clamp(unit, 0, static_cast<int>(units_.size()) - 1));
  const std::vector<Seen>& seen = units_[index];
  if (seen.empty()) return {{start_x_mm_ + belt - static_cast<double>(index) * pitch_mm_, 0.0}, 0.0};
  // The nearest frames, at least a few of them.
  auto first = std::ranges::lower_bound(seen, time_s - kNearFrames_s, {}, &Seen::time_s);
  auto last = std::ranges::upper_bound(seen, time_s + kNearFrames_s, {}, &Seen::time_s);
  while (last - first < 4 && (first != seen.begin() || last != seen.end())) {
    const bool back =
        first != seen.begin() && (last == seen.end() || time_s - (first - 1)->time_s < last->time_s - time_s);
    if (back)
      --first;
    else
      ++last;
  }
  const auto stride = static_cast<std::ptrdiff_t>(static_cast<std::size_t>(last - first) / kMostFrames + 1);
  Pose pose;
  double weights = 0.0;
  double angle = 0.0;
  for (auto frame = first; frame < last; frame += std::min(stride, last - frame)) {
    weights += frame->weight;
    pose.p_mm += frame->weight * (frame->p_mm + Eigen::Vector2d(belt - frame->belt_mm, 0.0));
    angle += frame->weight * frame->angle_rad;
  }
  pose.p_mm /= weights;
  pose.angle_rad = angle / weights;
  return pose;
}

double SheetPath::speedAt_mm_s(double time_s) const {
  constexpr double kOver_s = 0.01;
  return (belt_mm(time_s + kOver_s) - belt_mm(time_s - kOver_s)) / (2.0 * kOver_s);
}

Eigen::Vector2d SheetPath::inSheet(int unit, double time_s, const Eigen::Vector2d& p_W_mm) const {
  const Pose pose = at(unit, time_s);
  return Eigen::Rotation2Dd(-pose.angle_rad) * (p_W_mm - pose.p_mm);
}

std::optional<diagnose::BeltReading> SheetPath::scale() const {
  // Each unit by itself: where its marks were printed is not the belt's matter.
  double xx = 0.0, xy = 0.0, yy = 0.0, least = 0.0, most = 0.0;
  std::size_t count = 0;
  for (const std::vector<Seen>& seen : units_) {
    if (seen.size() < 8) continue;
    double mean_belt = 0.0, mean_x = 0.0;
    for (const Seen& s : seen) {
      mean_belt += s.belt_mm / static_cast<double>(seen.size());
      mean_x += s.p_mm.x() / static_cast<double>(seen.size());
    }
    for (const Seen& s : seen) {
      const double b = s.belt_mm - mean_belt, x = s.p_mm.x() - mean_x;
      xx += b * b;
      xy += b * x;
      yy += x * x;
      least = std::min(least, x);
      most = std::max(most, x);
      ++count;
    }
  }
  if (count < 16 || !(xx > 1.0)) return std::nullopt;
  diagnose::BeltReading reading;
  reading.ratio = xy / xx;
  const double left = std::max(0.0, yy - xy * xy / xx);
  // Frames near each other share the errors of belt and encoder.
  constexpr double kAlike = 20.0;
  reading.ratio_sigma = std::sqrt(kAlike * left / static_cast<double>(count) / xx);
  reading.travel_mm = most - least;
  return reading;
}

}  // namespace kerfbench::judge
