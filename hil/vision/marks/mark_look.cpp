// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/marks/mark_look.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "twin/base/constants.h"
#include "twin/base/image.h"

namespace kerfbench::vision {
namespace {

constexpr double kInnerRim = 0.75;  // Share of the radius within which all is ink.
constexpr double kEdgeSigmaPx = 0.7;
constexpr int kSectors = 12;

/// Noise of the centroid per axis but for the light's slope, from what the sectors of the edge show beyond a
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

/// Sums over the pixels of one look at a printed disc.
class MarkSums {
 public:
  MarkSums(const DiscPlace& disc, const MarkLevels& levels, bool check_edge)
      : disc_(disc),
        levels_(levels),
        check_edge_(check_edge),
        contrast_(levels.board - levels.ink),
        radius_px_(disc.radius_px()),
        inner2_(squared(kInnerRim * radius_px_)),
        outer2_(squared(kOuterRim * radius_px_)),
        edge_begin2_(squared(std::max(0.0, radius_px_ - disc.edge_half_px))),
        edge_end2_(squared(radius_px_ + disc.edge_half_px)),
        circle_(disc.mm_per_pixel / disc.pitch_mm()) {}

  void add(const GrayImage& image, int c, int r) {
    const Eigen::Vector2d from(c - disc_.centre.x(), r - disc_.centre.y());
    const Eigen::Vector2d d = circle_ * from;
    const double distance2 = d.squaredNorm();
    if (distance2 > outer2_) return;
    const double value = image.gray(c, r) / (1.0 + levels_.slope.dot(from));
    const double darkness = (levels_.board - value) / contrast_;
    if (distance2 < inner2_) {
      ++inner_;
      ink_sum_ += value;
      if (darkness < 0.65) ++stained_;
    }
    if (distance2 > edge_end2_) {
      addBoard(from, value, darkness);
      return;
    }
    double w = 1.0;
    if (distance2 > edge_begin2_) {
      w = std::clamp(darkness, -0.15, 1.15);
      if (check_edge_) addEdge(from, d, value, w);
    }
    weight_ += w;
    moment_ += w * from;
  }

  [[nodiscard]] MarkLook look() const {
    MarkLook look{};
    if (inner_ == 0 || outer_ == 0 || !(weight_ > 1.0)) {
      look.stained_share = 1.0;
      return look;
    }
    look.centroid = disc_.centre + moment_ / weight_;
    look.area_px = weight_;
    look.levels = measuredLevels();
    look.stained_share = static_cast<double>(stained_) / inner_;
    look.darkened_share = static_cast<double>(darkened_) / outer_;
    if (check_edge_) look.sigma_px = noise(look.levels.board);
    double mean = 0.0;
    for (const double s : sector_) mean += s / kSectors;
    for (const double s : sector_) {
      look.worst_sector_px =
          std::max(look.worst_sector_px, std::abs(s - mean) * kSectors / (2.0 * kPi * radius_px_));
    }
    return look;
  }

 private:
  static double squared(double x) { return x * x; }

  void addBoard(const Eigen::Vector2d& from, double value, double darkness) {
    ++outer_;
    if (darkness > 0.35) ++darkened_;
    if (!(std::abs(darkness) < 0.35)) return;
    board_sum_ += value;
    board_squares_ += (value - levels_.board) * (value - levels_.board);
    ++board_count_;
    board_moment_ += value * from;
    board_place_ += from;
    board_spread_ += from * from.transpose();
  }

  void addEdge(const Eigen::Vector2d& from, const Eigen::Vector2d& d, double value, double w) {
    edge_spread_ += 0.5 * from.squaredNorm();
    edge_spread_light_ += 0.5 * from.squaredNorm() * value;
    const double outside_px = std::sqrt(d.squaredNorm()) - radius_px_;
    const double expected = 0.5 * std::erfc(outside_px / (std::sqrt(2.0) * kEdgeSigmaPx));
    const double turn = (std::atan2(d.y(), d.x()) + kPi) / (2.0 * kPi);
    sector_[std::min<std::size_t>(kSectors - 1, static_cast<std::size_t>(turn * kSectors))] += w - expected;
  }

  [[nodiscard]] MarkLevels measuredLevels() const {
    MarkLevels levels = levels_;
    levels.ink = ink_sum_ / inner_;
    if (board_count_ == 0) return levels;
    levels.board = board_sum_ / board_count_;
    // What the slope leaves of the board's light is more slope: a lamp at one side would pull the disc to
    // itself.
    const Eigen::Vector2d place = board_place_ / board_count_;
    const Eigen::Matrix2d spread = board_spread_ - board_count_ * place * place.transpose();
    const Eigen::Vector2d lean = board_moment_ - board_sum_ * place;
    if (spread.determinant() > 0.0) levels.slope += spread.inverse() * lean / levels.board;
    return levels;
  }

  /// Standard uncertainty of the centroid per axis, px.
  [[nodiscard]] double noise(double board_gray) const {
    const double by_edge = centroidNoise(sector_, radius_px_, weight_);
    if (board_count_ == 0) return by_edge;
    const double pixel = std::sqrt(board_squares_ / board_count_);
    const double white = pixel / contrast_ * std::sqrt(edge_spread_) / weight_;
    const double slope = pixel / board_gray / std::sqrt(0.5 * board_spread_.trace());
    const double by_slope = slope * edge_spread_light_ / contrast_ / weight_;
    // Grain that makes the edge worse than white noise makes the slope worse, too.
    return std::hypot(by_edge, by_slope * std::max(1.0, by_edge / white));
  }

  const DiscPlace& disc_;
  const MarkLevels& levels_;
  bool check_edge_;
  double contrast_;
  double radius_px_;
  double inner2_, outer2_, edge_begin2_, edge_end2_;
  Eigen::Matrix2d circle_;  // Turns the ellipse in the picture into a circle.
  double weight_{0.0};
  Eigen::Vector2d moment_{Eigen::Vector2d::Zero()};
  std::array<double, kSectors> sector_{};
  int inner_{0}, stained_{0}, outer_{0}, darkened_{0};
  double ink_sum_{0.0}, board_sum_{0.0};
  int board_count_{0};
  double board_squares_{0.0};
  double edge_spread_{0.0};        // Sum of squares of an axis over the edge.
  double edge_spread_light_{0.0};  // Sum of squares of an axis over the edge, weighted by grey.
  Eigen::Vector2d board_moment_{Eigen::Vector2d::Zero()};
  Eigen::Vector2d board_place_{Eigen::Vector2d::Zero()};
  Eigen::Matrix2d board_spread_{Eigen::Matrix2d::Zero()};
};

}  // namespace

double DiscPlace::pitch_mm() const { return std::sqrt(std::abs(mm_per_pixel.determinant())); }

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

MarkLook lookAtMark(const GrayImage& image, const PixelBox& box, const DiscPlace& disc,
                    const MarkLevels& levels, bool check_edge) {
  MarkSums sums(disc, levels, check_edge);
  for (int r = box.top; r <= box.bottom; ++r) {
    for (int c = box.left; c <= box.right; ++c) sums.add(image, c, r);
  }
  return sums.look();
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
