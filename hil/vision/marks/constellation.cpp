// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/marks/constellation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/LU>

namespace kerfbench::vision {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

struct WebMark {
  Eigen::Vector2d p_mm;
  int unit;
};

struct Score {
  Constellation best;
  double value{-std::numeric_limits<double>::infinity()};
};

/// Pairs each seen mark with the nearest mark of the layout.
std::vector<MarkPair> pairUp(std::span<const Eigen::Vector2d> seen, const std::vector<WebMark>& web,
                             const PlaneMotion& motion,
                             const std::function<double(const Eigen::Vector2d&)>& reach) {
  std::vector<MarkPair> pairs;
  for (const Eigen::Vector2d& q : seen) {
    const WebMark* nearest = nullptr;
    double distance = std::numeric_limits<double>::infinity();
    for (const WebMark& mark : web) {
      const double d = (motion * mark.p_mm - q).norm();
      if (d < distance) {
        distance = d;
        nearest = &mark;
      }
    }
    if (nearest != nullptr && distance <= reach(q)) pairs.push_back({nearest->p_mm, q});
  }
  return pairs;
}

}  // namespace

Eigen::Matrix2d PlaneMotion::rotation() const {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  return (Eigen::Matrix2d() << c, -s, s, c).finished();
}

Eigen::Vector2d PlaneMotion::operator*(const Eigen::Vector2d& p_mm) const {
  return rotation() * p_mm + shift_mm;
}

Eigen::Vector2d PlaneMotion::inverse(const Eigen::Vector2d& q_mm) const {
  return rotation().transpose() * (q_mm - shift_mm);
}

Eigen::Vector2d markOnWeb(const PrintLayout& print, int unit, std::size_t index) {
  return print.marks[index].p_SM_mm - Eigen::Vector2d(unit * print.pitch_mm, 0.0);
}

PlaneMotion fitMotion(std::span<const MarkPair> pairs, double angle_guess_rad) {
  if (pairs.empty()) throw std::invalid_argument("a motion needs at least one mark");
  Eigen::Vector2d p0 = Eigen::Vector2d::Zero();
  Eigen::Vector2d q0 = Eigen::Vector2d::Zero();
  for (const MarkPair& pair : pairs) {
    p0 += pair.p_mm / static_cast<double>(pairs.size());
    q0 += pair.q_mm / static_cast<double>(pairs.size());
  }
  double sine = 0.0;
  double cosine = 0.0;
  for (const MarkPair& pair : pairs) {
    sine += cross(pair.p_mm - p0, pair.q_mm - q0);
    cosine += (pair.p_mm - p0).dot(pair.q_mm - q0);
  }
  PlaneMotion motion;
  motion.angle_rad =
      pairs.size() > 1 && std::hypot(sine, cosine) > 1e-6 ? std::atan2(sine, cosine) : angle_guess_rad;
  motion.shift_mm = q0 - motion.rotation() * p0;
  return motion;
}

Eigen::Matrix3d motionCovariance(std::span<const MarkPair> pairs, const PlaneMotion& motion) {
  constexpr double kBelief = 6.0;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  if (pairs.empty()) return covariance;
  if (pairs.size() == 1) {
    covariance.topLeftCorner<2, 2>() = pairs[0].sigma_mm * pairs[0].sigma_mm * Eigen::Matrix2d::Identity();
    return covariance;
  }
  const bool known =
      std::all_of(pairs.begin(), pairs.end(), [](const MarkPair& p) { return p.sigma_mm > 0.0; });
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d noise = Eigen::Matrix3d::Zero();
  double chi2 = 0.0;
  for (const MarkPair& pair : pairs) {
    const Eigen::Vector2d arm = motion.rotation() * pair.p_mm;
    Eigen::Matrix<double, 2, 3> j;
    j << 1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x();
    const double variance = known ? pair.sigma_mm * pair.sigma_mm : 1.0;
    normal += j.transpose() * j;
    noise += variance * j.transpose() * j;
    chi2 += (motion * pair.p_mm - pair.q_mm).squaredNorm() / variance;
  }
  const double freedom = 2.0 * static_cast<double>(pairs.size()) - 3.0;
  const double scale = known ? (kBelief + chi2) / (kBelief + freedom) : chi2 / freedom;
  if (!(normal.determinant() > 1e-9)) return covariance;
  const Eigen::Matrix3d inverse = normal.inverse();
  covariance = scale * inverse * noise * inverse;
  return covariance;
}

MotionFit fitMotionRobust(std::vector<MarkPair> pairs, const PlaneMotion& expected, double limit_mm) {
  for (;;) {
    MotionFit fit;
    fit.motion = fitMotion(pairs, expected.angle_rad);
    fit.pairs = static_cast<int>(pairs.size());
    double sum = 0.0;
    double worst = 0.0;
    for (const MarkPair& pair : pairs) {
      const double d = (fit.motion * pair.p_mm - pair.q_mm).norm();
      sum += d * d;
      worst = std::max(worst, d);
    }
    fit.rms_mm = pairs.size() > 1 ? std::sqrt(sum / static_cast<double>(pairs.size()))
                                  : std::numeric_limits<double>::quiet_NaN();
    if (pairs.size() < 2 || worst <= limit_mm) {
      fit.covariance = motionCovariance(pairs, fit.motion);
      return fit;
    }

    // Leave out the pair without which the others agree best; two pairs cannot accuse each other.
    std::size_t out = 0;
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      double rest = 0.0;
      if (pairs.size() == 2) {
        rest = -(expected * pairs[i].p_mm - pairs[i].q_mm).norm();
      } else {
        std::vector<MarkPair> others = pairs;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
        const PlaneMotion motion = fitMotion(others, expected.angle_rad);
        for (const MarkPair& pair : others) rest += (motion * pair.p_mm - pair.q_mm).squaredNorm();
      }
      if (rest < best) {
        best = rest;
        out = i;
      }
    }
    pairs.erase(pairs.begin() + static_cast<std::ptrdiff_t>(out));
  }
}

std::optional<Constellation> matchConstellation(std::span<const Eigen::Vector2d> seen_mm,
                                                const ConstellationQuery& query) {
  const PrintLayout& print = *query.print;
  std::vector<WebMark> web;
  for (int unit = query.first_unit; unit <= query.last_unit; ++unit) {
    for (std::size_t i = 0; i < print.marks.size(); ++i) web.push_back({markOnWeb(print, unit, i), unit});
  }
  Score score;
  const auto consider = [&](const Eigen::Vector2d& anchor_q, const WebMark& anchor) {
    PlaneMotion motion{Eigen::Vector2d::Zero(), query.expected.angle_rad};
    motion.shift_mm = anchor_q - motion.rotation() * anchor.p_mm;
    if (!((anchor_q - query.expected * anchor.p_mm).norm() <= query.max_shift_mm)) return;
    // The angle is unknown at first, so marks far from the anchor may lie farther off. Each pair of a far
    // mark with the anchor is one guess of the angle.
    std::vector<PlaneMotion> guesses{motion};
    for (const Eigen::Vector2d& q : seen_mm) {
      for (const WebMark& mark : web) {
        const double distance = (mark.p_mm - anchor.p_mm).norm();
        if (distance < 1.0 || std::abs((q - anchor_q).norm() - distance) > query.tolerance_mm) continue;
        const std::array<MarkPair, 2> two{MarkPair{anchor.p_mm, anchor_q}, MarkPair{mark.p_mm, q}};
        const PlaneMotion guess = fitMotion(two, motion.angle_rad);
        if (std::abs(guess.angle_rad - query.expected.angle_rad) <= query.max_angle_rad)
          guesses.push_back(guess);
      }
    }
    for (PlaneMotion guess : guesses) {
      const auto reach = [&](const Eigen::Vector2d&) { return query.tolerance_mm; };
      std::vector<MarkPair> pairs = pairUp(seen_mm, web, guess, reach);
      if (pairs.empty()) continue;
      guess = fitMotion(pairs, guess.angle_rad);
      if (std::abs(guess.angle_rad - query.expected.angle_rad) > query.max_angle_rad) continue;
      pairs = pairUp(seen_mm, web, guess, reach);
      if (pairs.empty()) continue;
      Constellation found;
      found.motion = guess;
      found.matched = static_cast<int>(pairs.size());
      for (const WebMark& mark : web) found.expected += query.in_view(guess * mark.p_mm) ? 1 : 0;
      const int missing = std::max(0, found.expected - found.matched);
      const double off = query.prefer_least_advanced ? guess.shift_mm.x()
                                                     : (guess.shift_mm - query.expected.shift_mm).norm();
      const double value = found.matched - 0.75 * missing - 1e-5 * off;
      if (value > score.value) score = {found, value};
    }
  };
  for (const Eigen::Vector2d& q : seen_mm) {
    for (const WebMark& mark : web) {
      if (mark.unit <= query.anchor_last_unit) consider(q, mark);
    }
  }
  if (score.best.matched == 0) return std::nullopt;
  return score.best;
}

}  // namespace kerfbench::vision
