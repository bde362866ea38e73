// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/marks/mark_look.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "twin/base/constants.h"

namespace kerfbench::vision {
namespace {

constexpr double kInnerRim = 0.75;  // of the radius: all ink inside
constexpr double kEdgeSigmaPx = 0.7;
constexpr int kSectors = 12;

/// Noise of the centroid per axis but for the light's slope, from what the sectors of the edge hold beside a
/// shift and a growth of the disc: a sector that has s more ink (in pixels) moves it by s * radius / area.
double centroidNoise(const std::array<double, kSectors>& sector, double radius_px, double area_px) {
  double mean = 0.0;
  double cosine = 0.0;
  double sine = 0.0;
  const auto angleOf = [](std::size_t k) { return 2.0 * kPi * (static_cast<double>(k) + 0.5) / kSectors; };
  for (std::size_t k = 0; k < kSectors; ++k) {
    mean += sector[k] / kSectors;
    cosine += sector[k] * std::cos(angleOf(k)) * 2.0 / kSectors;
    sine += sector[k] * std::sin(angleOf(k)) * 2.0 / kSectors;
  }
  double squares = 0.0;
  for (std::size_t k = 0; k < kSectors; ++k) {
    const double rest = sector[k] - mean - cosine * std::cos(angleOf(k)) - sine * std::sin(angleOf(k));
    squares += rest * rest;
  }
  return radius_px / area_px * std::sqrt(0.5 * kSectors * squares / (kSectors - 3));
}

}  // namespace

std::optional<PixelBox> boxAround(const GrayImage& image, const Eigen::Vector2d& centre, double half_px) {
  const PixelBox box{
      static_cast<int>(std::floor(centre.x() - half_px)), static_cast<int>(std::floor(centre.y() - half_px)),
      static_cast<int>(std::ceil(centre.x() + half_px)), static_cast<int>(std::ceil(centre.y() + half_px))};
  const PixelBox cut{std::max(0, box.left), std::max(0, box.top), std::min(image.width - 1, box.right),
                     std::min(image.height - 1, box.bottom)};
  if (cut.left >= cut.right || cut.top >= cut.bottom) return std::nullopt;
  return cut;
}

MarkLevels roughLevels(const GrayImage& image, const PixelBox& box, double disc_share) {
  std::array<int, 256> histogram{};
  int total = 0;
  const int stride = std::max(1, (box.right - box.left) / 48);
  for (int r = box.top; r <= box.bottom; r += stride) {
    for (int c = box.left; c <= box.right; c += stride) {
      ++histogram[image.at(c, r)];
      ++total;
    }
  }
  const auto quantile = [&](double share) {
    int seen = 0;
    for (int i = 0; i < 256; ++i) {
      seen += histogram[static_cast<std::size_t>(i)];
      if (seen > share * total) return static_cast<double>(i);
    }
    return 255.0;
  };
  // Middle of the dark share and middle of the bright share.
  return {quantile(0.5 + 0.5 * disc_share), quantile(0.45 * disc_share)};
}

MarkLook lookAtMark(const GrayImage& image, const PixelBox& box, const Eigen::Vector2d& centre,
                    const Eigen::Matrix2d& mm_per_pixel, double radius_mm, double edge_half_px,
                    const MarkLevels& levels, bool check_edge) {
  const double pitch_mm = std::sqrt(std::abs(mm_per_pixel.determinant()));
  const double radius_px = radius_mm / pitch_mm;
  const double contrast = levels.board - levels.ink;
  MarkLook look{};
  double weight = 0.0;
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  std::array<double, kSectors> sector{};
  int inner = 0;
  int stained = 0;
  int outer = 0;
  int darkened = 0;
  double ink_sum = 0.0;
  double board_sum = 0.0;
  int board_count = 0;
  double board_squares = 0.0;
  double edge_spread = 0.0;        // Sum of squares of an axis over the edge …
  double edge_spread_light = 0.0;  // … and weighted by grey.
  Eigen::Vector2d board_moment = Eigen::Vector2d::Zero();
  Eigen::Vector2d board_place = Eigen::Vector2d::Zero();
  Eigen::Matrix2d board_spread = Eigen::Matrix2d::Zero();
  const Eigen::Matrix2d circle = mm_per_pixel / pitch_mm;  // turns the ellipse in the picture into a circle
  const auto squared = [](double x) { return x * x; };
  const double inner2 = squared(kInnerRim * radius_px);
  const double outer2 = squared(kOuterRim * radius_px);
  const double edge_begin2 = squared(std::max(0.0, radius_px - edge_half_px));
  const double edge_end2 = squared(radius_px + edge_half_px);
  for (int r = box.top; r <= box.bottom; ++r) {
    for (int c = box.left; c <= box.right; ++c) {
      const Eigen::Vector2d from(c - centre.x(), r - centre.y());
      const Eigen::Vector2d d = circle * from;
      const double distance2 = d.squaredNorm();
      if (distance2 > outer2) continue;
      const double value = image.gray(c, r) / (1.0 + levels.slope.dot(from));
      const double darkness = (levels.board - value) / contrast;
      if (distance2 < inner2) {
        ++inner;
        ink_sum += value;
        if (darkness < 0.65) ++stained;
      }
      if (distance2 > edge_end2) {
        ++outer;
        if (darkness > 0.35) ++darkened;
        if (std::abs(darkness) < 0.35) {
          board_sum += value;
          board_squares += (value - levels.board) * (value - levels.board);
          ++board_count;
          board_moment += value * from;
          board_place += from;
          board_spread += from * from.transpose();
        }
        continue;
      }
      double w = 1.0;
      if (distance2 > edge_begin2) {
        w = std::clamp(darkness, -0.15, 1.15);
        if (check_edge) {
          edge_spread += 0.5 * from.squaredNorm();
          edge_spread_light += 0.5 * from.squaredNorm() * value;
          const double outside_px = std::sqrt(distance2) - radius_px;
          const double expected = 0.5 * std::erfc(outside_px / (std::sqrt(2.0) * kEdgeSigmaPx));
          const double turn = (std::atan2(d.y(), d.x()) + kPi) / (2.0 * kPi);
          sector[std::min<std::size_t>(kSectors - 1, static_cast<std::size_t>(turn * kSectors))] +=
              w - expected;
        }
      }
      weight += w;
      moment += w * from;
    }
  }
  if (inner == 0 || outer == 0 || !(weight > 1.0)) {
    look.stained_share = 1.0;
    return look;
  }
  look.centroid = centre + moment / weight;
  look.area_px = weight;
  look.levels = levels;
  look.levels.ink = ink_sum / inner;
  if (board_count > 0) {
    look.levels.board = board_sum / board_count;
    // What the slope leaves of the board's light is more slope: a lamp beside would draw the disc to itself.
    const Eigen::Vector2d place = board_place / board_count;
    const Eigen::Matrix2d spread = board_spread - board_count * place * place.transpose();
    const Eigen::Vector2d lean = board_moment - board_sum * place;
    if (spread.determinant() > 0.0) look.levels.slope += spread.inverse() * lean / look.levels.board;
  }
  look.stained_share = static_cast<double>(stained) / inner;
  look.darkened_share = static_cast<double>(darkened) / outer;
  if (check_edge) {
    look.sigma_px = centroidNoise(sector, radius_px, weight);
    if (board_count > 0) {
      const double pixel = std::sqrt(board_squares / board_count);
      const double white = pixel / contrast * std::sqrt(edge_spread) / weight;
      const double slope = pixel / look.levels.board / std::sqrt(0.5 * board_spread.trace());
      const double by_slope = slope * edge_spread_light / contrast / weight;
      // Grain that makes the edge worse than white noise makes the slope worse, too.
      look.sigma_px = std::hypot(look.sigma_px, by_slope * std::max(1.0, look.sigma_px / white));
    }
  }
  double mean = 0.0;
  for (const double s : sector) mean += s / kSectors;
  for (const double s : sector) {
    look.worst_sector_px =
        std::max(look.worst_sector_px, std::abs(s - mean) * kSectors / (2.0 * kPi * radius_px));
  }
  return look;
}

std::optional<Eigen::Vector2d> darkCentroid(const GrayImage& image, const PixelBox& box,
                                            const Eigen::Vector2d& centre, double within_px,
                                            double threshold) {
  double n = 0.0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int r = box.top; r <= box.bottom; ++r) {
    for (int c = box.left; c <= box.right; ++c) {
      if (image.gray(c, r) >= threshold) continue;
      const Eigen::Vector2d p(c, r);
      if ((p - centre).squaredNorm() > within_px * within_px) continue;
      n += 1.0;
      sum += p;
    }
  }
  if (n < 4.0) return std::nullopt;
  return sum / n;
}

}  // namespace kerfbench::vision
