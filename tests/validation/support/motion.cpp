// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/support/motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace kerfbench::validation {

void Motion::add(Piece piece) {
  Speeds& s = piece.speeds;
  piece.begin_s = duration_s_;
  if (std::isinf(s.acceleration_mm_s2)) {
    s.begin_mm_s = s.end_mm_s = s.top_mm_s;
    piece.flat_s = piece.length_mm / s.top_mm_s;
    piece.time_s = piece.flat_s;
  } else {
    const double a = s.acceleration_mm_s2;
    const double reachable_mm_s =
        std::sqrt(a * piece.length_mm + 0.5 * (s.begin_mm_s * s.begin_mm_s + s.end_mm_s * s.end_mm_s));
    s.top_mm_s = std::min(s.top_mm_s, reachable_mm_s);
    if (s.top_mm_s < std::max(s.begin_mm_s, s.end_mm_s)) {
      throw std::invalid_argument("Motion: the piece is too short for its change of speed");
    }
    piece.up_s = (s.top_mm_s - s.begin_mm_s) / a;
    const double down_s = (s.top_mm_s - s.end_mm_s) / a;
    const double ramps_mm =
        0.5 * (s.top_mm_s + s.begin_mm_s) * piece.up_s + 0.5 * (s.top_mm_s + s.end_mm_s) * down_s;
    piece.flat_s = std::max(0.0, (piece.length_mm - ramps_mm) / s.top_mm_s);
    piece.time_s = piece.up_s + piece.flat_s + down_s;
  }
  duration_s_ += piece.time_s;
  pen_mm_ = piece.to_mm;
  pieces_.push_back(piece);
}

void Motion::line(const Eigen::Vector2d& to_mm, const Speeds& speeds, bool lit) {
  Piece piece;
  piece.from_mm = pen_mm_;
  piece.to_mm = to_mm;
  piece.length_mm = (to_mm - pen_mm_).norm();
  piece.speeds = speeds;
  piece.lit = lit;
  add(piece);
}

void Motion::arc(const Eigen::Vector2d& centre_mm, double turn_rad, const Speeds& speeds, bool lit) {
  Piece piece;
  piece.from_mm = pen_mm_;
  piece.centre_mm = centre_mm;
  piece.turn_rad = turn_rad;
  piece.length_mm = std::abs(turn_rad) * (pen_mm_ - centre_mm).norm();
  piece.to_mm = place_mm(piece, piece.length_mm);
  piece.speeds = speeds;
  piece.lit = lit;
  add(piece);
}

void Motion::rest(double time_s) {
  Piece piece;
  piece.begin_s = duration_s_;
  piece.time_s = time_s;
  piece.from_mm = piece.to_mm = pen_mm_;
  duration_s_ += time_s;
  pieces_.push_back(piece);
}

double Motion::travel_mm(const Piece& piece, double time_s) {
  const Speeds& s = piece.speeds;
  if (piece.length_mm == 0.0) return 0.0;
  if (time_s >= piece.time_s) return piece.length_mm;
  if (std::isinf(s.acceleration_mm_s2)) return s.top_mm_s * time_s;
  const double a = s.acceleration_mm_s2;
  if (time_s < piece.up_s) return s.begin_mm_s * time_s + 0.5 * a * time_s * time_s;
  const double up_mm = 0.5 * (s.begin_mm_s + s.top_mm_s) * piece.up_s;
  if (time_s < piece.up_s + piece.flat_s) return up_mm + s.top_mm_s * (time_s - piece.up_s);
  const double left_s = piece.time_s - time_s;
  return piece.length_mm - (s.end_mm_s * left_s + 0.5 * a * left_s * left_s);
}

Eigen::Vector2d Motion::place_mm(const Piece& piece, double travel_mm) {
  if (piece.length_mm == 0.0) return piece.from_mm;
  const double share = travel_mm / piece.length_mm;
  if (piece.turn_rad == 0.0) return piece.from_mm + share * (piece.to_mm - piece.from_mm);
  const Eigen::Vector2d r = piece.from_mm - piece.centre_mm;
  const double c = std::cos(share * piece.turn_rad);
  const double s = std::sin(share * piece.turn_rad);
  return piece.centre_mm + Eigen::Vector2d(c * r.x() - s * r.y(), s * r.x() + c * r.y());
}

Eigen::Vector2d Motion::at_mm(double time_s) const {
  if (pieces_.empty()) return pen_mm_;
  const double clamped_s = std::clamp(time_s, 0.0, duration_s_);
  auto next = std::ranges::upper_bound(pieces_, clamped_s, {}, &Piece::begin_s);
  const Piece& piece = *std::prev(next);
  return place_mm(piece, travel_mm(piece, clamped_s - piece.begin_s));
}

std::vector<std::pair<double, double>> Motion::lit_s() const {
  std::vector<std::pair<double, double>> result;
  for (const Piece& piece : pieces_) {
    if (piece.lit) result.emplace_back(piece.begin_s, piece.begin_s + piece.time_s);
  }
  return result;
}

double Motion::distanceFrom_mm(const Piece& piece, const Eigen::Vector2d& p_mm) {
  const double ends_mm = std::min((p_mm - piece.from_mm).norm(), (p_mm - piece.to_mm).norm());
  if (piece.turn_rad == 0.0) {
    const Eigen::Vector2d along = piece.to_mm - piece.from_mm;
    const double share = (p_mm - piece.from_mm).dot(along) / along.squaredNorm();
    return share > 0.0 && share < 1.0 ? (p_mm - piece.from_mm - share * along).norm() : ends_mm;
  }
  const Eigen::Vector2d from = piece.from_mm - piece.centre_mm;
  const Eigen::Vector2d here = p_mm - piece.centre_mm;
  double turned = std::atan2(from.x() * here.y() - from.y() * here.x(), from.dot(here));
  if (piece.turn_rad < 0.0) turned = -turned;
  if (turned < 0.0) turned += 2.0 * std::numbers::pi;
  return turned <= std::abs(piece.turn_rad) ? std::abs(here.norm() - from.norm()) : ends_mm;
}

double Motion::distance_mm(const Eigen::Vector2d& p_mm, std::size_t lit_piece) const {
  for (const Piece& piece : pieces_) {
    if (piece.lit && lit_piece-- == 0) return distanceFrom_mm(piece, p_mm);
  }
  throw std::out_of_range("Motion: no such lit piece");
}

double Motion::distance_mm(const Eigen::Vector2d& p_mm) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Piece& piece : pieces_) {
    if (piece.lit) nearest = std::min(nearest, distanceFrom_mm(piece, p_mm));
  }
  return nearest;
}

Eigen::Vector2d PaperHead::angles_rad(const Eigen::Vector2d& p_mm) const {
  const double reach = std::sqrt(throw_mm * throw_mm + p_mm.y() * p_mm.y()) + spacing_mm;
  return {0.5 * std::atan(p_mm.x() / reach), 0.5 * std::atan(p_mm.y() / throw_mm)};
}

Eigen::Vector2d PaperHead::spot_mm(const Eigen::Vector2d& angles_rad) const {
  const double y = throw_mm * std::tan(2.0 * angles_rad.y());
  return {(std::sqrt(throw_mm * throw_mm + y * y) + spacing_mm) * std::tan(2.0 * angles_rad.x()), y};
}

std::vector<twin::StepEdge> pulsesFor(const std::function<double(double time_s)>& target, double step,
                                      double end_s) {
  constexpr double kLook_s = 5e-6;
  std::vector<twin::StepEdge> pulses;
  long long count = 0;
  long long last_slot = -1;
  const auto looks = static_cast<long long>(std::ceil(end_s / kLook_s));
  for (long long i = 0; i < looks; ++i) {
    const double from_s = static_cast<double>(i) * kLook_s;
    const double until_s = from_s + kLook_s;
    const long long wanted = std::llround(target(until_s) / step);
    while (count != wanted) {
      const int direction = wanted > count ? 1 : -1;
      const double edge = (static_cast<double>(count) + 0.5 * direction) * step;
      double low = from_s;
      double high = until_s;
      for (int k = 0; k < 20; ++k) {
        const double middle = 0.5 * (low + high);
        (direction * (target(middle) - edge) >= 0.0 ? high : low) = middle;
      }
      const long long slot = std::llround(high / kPulseGrid_s);
      if (slot <= last_slot) throw std::invalid_argument("pulsesFor: pulses closer than the grid");
      pulses.push_back({static_cast<double>(slot) * kPulseGrid_s, direction});
      last_slot = slot;
      count += direction;
    }
  }
  return pulses;
}

}  // namespace kerfbench::validation
