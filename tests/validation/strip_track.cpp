// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/strip_track.h"

#include <algorithm>
#include <cmath>

namespace kerfbench::validation {
namespace {

constexpr double kPulse_s = 5e-6;
constexpr double kDirHold_s = 20e-6;

}  // namespace

int Track::Piece::direction() const {
  const double sense = speed_mm_s != 0.0 ? speed_mm_s : acceleration_mm_s2;
  return sense > 0.0 ? 1 : sense < 0.0 ? -1 : 0;
}

double Track::Piece::distance_mm(double time_s) const {
  const double t = std::min(time_s, end_s) - begin_s;
  return std::abs(speed_mm_s * t + 0.5 * acceleration_mm_s2 * t * t);
}

double Track::Piece::timeOf_s(double distance_mm) const {
  if (distance_mm <= 0.0) return begin_s;
  const double speed = std::abs(speed_mm_s);
  const double square = speed * speed + 2.0 * acceleration_mm_s2 * direction() * distance_mm;
  return begin_s + 2.0 * distance_mm / (speed + std::sqrt(std::max(0.0, square)));
}

void Track::add(double duration_s, double acceleration_mm_s2) {
  if (!(duration_s > 0.0)) return;
  pieces_.push_back({time_s_, time_s_ + duration_s, place_mm_, speed_mm_s_, acceleration_mm_s2});
  time_s_ += duration_s;
  place_mm_ += speed_mm_s_ * duration_s + 0.5 * acceleration_mm_s2 * duration_s * duration_s;
  speed_mm_s_ += acceleration_mm_s2 * duration_s;
}

void Track::keepUntil(double time_s) { add(time_s - time_s_, 0.0); }

void Track::speedUpTo(double speed_mm_s, double acceleration_mm_s2) {
  if (speed_mm_s_ * speed_mm_s < 0.0) speedUpTo(0.0, acceleration_mm_s2);
  const double change = speed_mm_s - speed_mm_s_;
  add(std::abs(change) / acceleration_mm_s2, std::copysign(acceleration_mm_s2, change));
  speed_mm_s_ = speed_mm_s;
}

void Track::moveTo(double place_mm, double top_mm_s, double acceleration_mm_s2) {
  const double brake_mm = speed_mm_s_ * std::abs(speed_mm_s_) / (2.0 * acceleration_mm_s2);
  if ((place_mm - (place_mm_ + brake_mm)) * speed_mm_s_ <= 0.0) speedUpTo(0.0, acceleration_mm_s2);
  const double distance = place_mm - place_mm_;
  const double sense = distance < 0.0 ? -1.0 : 1.0;
  // The speed rises to `peak` and falls to rest: peak² / a - v² / 2a is the distance.
  const double peak = std::min(
      top_mm_s, std::sqrt(std::abs(distance) * acceleration_mm_s2 + 0.5 * speed_mm_s_ * speed_mm_s_));
  const double ramps_mm = (peak * peak - 0.5 * speed_mm_s_ * speed_mm_s_) / acceleration_mm_s2;
  speedUpTo(sense * peak, acceleration_mm_s2);
  keepUntil(time_s_ + (std::abs(distance) - ramps_mm) / std::max(peak, 1e-9));
  speedUpTo(0.0, acceleration_mm_s2);
  place_mm_ = place_mm;  // The place is free of rounding, however many moves follow.
}

void PulseTrain::appendUntil(double until_s, TickRate rate, std::vector<PinWrite>& writes) {
  while (const Track::Piece* piece = track_.front()) {
    const int direction = piece->direction();
    if (direction != 0 && (direction > 0) != dir_level_) {
      const double at_s = std::max(piece->begin_s, last_edge_s_ + kDirHold_s);
      if (at_s >= until_s) return;
      dir_level_ = direction > 0;
      writes.push_back({rate.ticksAt(at_s), dir_, dir_level_});
    }
    const double next_mm = (static_cast<double>(count_) + 0.5 * direction) * step_mm_;
    const double distance_mm = (next_mm - piece->place_mm) * direction;
    if (direction == 0 || distance_mm > piece->distance_mm(piece->end_s)) {
      if (piece->end_s > until_s) return;
      track_.dropFront();
      continue;
    }
    const double at_s = piece->timeOf_s(distance_mm);
    if (at_s >= until_s) return;
    writes.push_back({rate.ticksAt(at_s), pul_, true});
    writes.push_back({rate.ticksAt(at_s + kPulse_s), pul_, false});
    count_ += direction;
    last_edge_s_ = at_s;
  }
}

}  // namespace kerfbench::validation
