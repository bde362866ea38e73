// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/mark_finder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <Eigen/LU>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace kerfbench::hil {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInnerRim = 0.75;  // of the radius: all ink inside
constexpr double kOuterRim = 1.4;   // all board out to here
constexpr double kEdgeSigmaPx = 0.7;
constexpr int kSectors = 12;

struct Levels {
  double board;
  double ink;
};

struct Box {
  int left, top, right, bottom;  // inclusive
};

std::optional<Box> boxAround(const GrayImage& image, const Eigen::Vector2d& centre, double half_px) {
  const Box box{
      static_cast<int>(std::floor(centre.x() - half_px)), static_cast<int>(std::floor(centre.y() - half_px)),
      static_cast<int>(std::ceil(centre.x() + half_px)), static_cast<int>(std::ceil(centre.y() + half_px))};
  const Box cut{std::max(0, box.left), std::max(0, box.top), std::min(image.width - 1, box.right),
                std::min(image.height - 1, box.bottom)};
  if (cut.left >= cut.right || cut.top >= cut.bottom) return std::nullopt;
  return cut;
}

Levels roughLevels(const GrayImage& image, const Box& box, double disc_share) {
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

/// What one look at the disc tells.
struct Look {
  Eigen::Vector2d centroid;
  double area_px;
  Levels levels;
  double stained_share;    ///< Of the inner disc that is not ink.
  double darkened_share;   ///< Of the outer ring that is not board.
  double worst_sector_px;  ///< Farthest that a piece of the edge lies off the circle.
  double sigma_px;         ///< Of the centroid, per axis.
};

/// Noise of the centroid per axis, from what the sectors of the edge hold beside a shift and a growth of the
/// disc: a sector that has s more ink (in pixels) moves it by s * radius / area.
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

/// Distances are measured in the plane, so that a tilted disc stays round. Without check_edge,
/// worst_sector_px is not told.
Look lookAt(const GrayImage& image, const Box& box, const Eigen::Vector2d& centre,
            const Eigen::Matrix2d& mm_per_pixel, double radius_mm, double edge_half_px, const Levels& levels,
            bool check_edge) {
  const double pitch_mm = std::sqrt(std::abs(mm_per_pixel.determinant()));
  const double radius_px = radius_mm / pitch_mm;
  const double contrast = levels.board - levels.ink;
  Look look{};
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
      const double value = image.gray(c, r);
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
          ++board_count;
        }
        continue;
      }
      double w = 1.0;
      if (distance2 > edge_begin2) {
        w = std::clamp(darkness, -0.15, 1.15);
        if (check_edge) {
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
  look.levels = {board_count > 0 ? board_sum / board_count : levels.board, ink_sum / inner};
  look.stained_share = static_cast<double>(stained) / inner;
  look.darkened_share = static_cast<double>(darkened) / outer;
  if (check_edge) look.sigma_px = centroidNoise(sector, radius_px, weight);
  double mean = 0.0;
  for (const double s : sector) mean += s / kSectors;
  for (const double s : sector) {
    look.worst_sector_px =
        std::max(look.worst_sector_px, std::abs(s - mean) * kSectors / (2.0 * kPi * radius_px));
  }
  return look;
}

/// Centroid of everything dark in the box, to come near enough to look.
std::optional<Eigen::Vector2d> darkCentroid(const GrayImage& image, const Box& box,
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

/// The point of the plane whose disc has its centroid at the pixel. Seven points with weights exact to the
/// fifth degree stand for the disc; each counts by the area that it has in the picture.
Eigen::Vector2d centreFromCentroid(const CameraCalibration& calibration, const Eigen::Vector2d& centroid,
                                   double radius_mm) {
  Eigen::Vector2d p_mm = calibration.planeFromPixel(centroid);
  for (int round = 0; round < 2; ++round) {
    const LocalPixelMap middle = calibration.localMap(p_mm);
    double weight = 0.25 * std::abs(middle.pixel_per_mm.determinant());
    Eigen::Vector2d moment = weight * middle.pixel;
    for (int k = 0; k < 6; ++k) {
      const double angle = k * kPi / 3.0;
      const Eigen::Vector2d rim(std::cos(angle), std::sin(angle));
      const LocalPixelMap map = calibration.localMap(p_mm + radius_mm * std::sqrt(2.0 / 3.0) * rim);
      const double w = 0.125 * std::abs(map.pixel_per_mm.determinant());
      weight += w;
      moment += w * map.pixel;
    }
    p_mm += middle.pixel_per_mm.inverse() * (centroid - moment / weight);
  }
  return p_mm;
}

}  // namespace

double markBorderPx(double radius_px) { return kOuterRim * radius_px + 3.0; }

std::optional<FoundMark> measureMark(const GrayImage& image, const CameraCalibration& calibration,
                                     const Eigen::Vector2d& near_mm, double diameter_mm, double search_mm) {
  const LocalPixelMap map = calibration.localMap(near_mm);
  const Eigen::Matrix2d mm_per_pixel = map.pixel_per_mm.inverse();
  const double px_per_mm = std::sqrt(std::abs(map.pixel_per_mm.determinant()));
  const double radius_mm = 0.5 * diameter_mm;
  const double radius_px = radius_mm * px_per_mm;
  const double search_px = search_mm * px_per_mm;
  const double half_px = kOuterRim * radius_px + search_px + 2.0;
  const std::optional<Box> wide = boxAround(image, map.pixel, half_px);
  if (!wide) return std::nullopt;
  const double box_area = static_cast<double>(wide->right - wide->left + 1) * (wide->bottom - wide->top + 1);
  Levels levels = roughLevels(image, *wide, std::min(0.5, kPi * radius_px * radius_px / box_area));
  const auto enough_contrast = [](const Levels& l) {
    return l.board - l.ink > std::max(8.0, 0.35 * l.board);
  };
  if (!enough_contrast(levels)) return std::nullopt;

  Eigen::Vector2d centre = map.pixel;
  const double middle_gray = 0.5 * (levels.board + levels.ink);
  double within = radius_px + search_px + 2.0;
  for (int round = 0; round < 2; ++round) {
    const std::optional<Eigen::Vector2d> dark = darkCentroid(image, *wide, centre, within, middle_gray);
    if (!dark) return std::nullopt;
    centre = *dark;
    within = 1.35 * radius_px;
  }

  const double edge_half_px = std::clamp(0.06 * radius_px, 2.5, 0.2 * radius_px + 2.0);
  Look look{};
  for (int round = 0, last = 7; round <= last; ++round) {
    const double border = markBorderPx(radius_px) - 2.0;
    if (centre.x() < border || centre.y() < border || centre.x() > image.width - 1 - border ||
        centre.y() > image.height - 1 - border) {
      return std::nullopt;
    }
    const std::optional<Box> box = boxAround(image, centre, kOuterRim * radius_px + 1.0);
    if (!box) return std::nullopt;
    look = lookAt(image, *box, centre, mm_per_pixel, radius_mm, edge_half_px, levels, round == last);
    if (look.stained_share > 0.02 || look.darkened_share > 0.06) return std::nullopt;
    levels = look.levels;
    if (!enough_contrast(levels)) return std::nullopt;
    const Eigen::Vector2d step = look.centroid - centre;
    centre = look.centroid;
    if (round >= 1 && step.norm() < 5e-3) last = std::min(last, round + 1);
  }
  const double area_ratio = look.area_px / (kPi * radius_px * radius_px);
  if (std::abs(area_ratio - 1.0) > 0.15) return std::nullopt;
  if (look.worst_sector_px > std::max(0.25, 0.02 * radius_px)) return std::nullopt;

  FoundMark found;
  found.pixel = centre;
  found.diameter_mm = diameter_mm;
  found.contrast_gray = levels.board - levels.ink;
  found.sigma_mm = look.sigma_px / px_per_mm;
  found.p_mm = centreFromCentroid(calibration, centre, radius_mm);
  if ((found.p_mm - near_mm).norm() > search_mm + 0.5 * radius_mm) return std::nullopt;
  return found;
}

std::vector<FoundMark> findMarks(const GrayImage& image, const CameraCalibration& calibration,
                                 const Background& background, std::span<const double> diameters_mm) {
  if (diameters_mm.empty()) return {};
  const double pitch_mm = calibration.pitchMm();
  const double smallest_px = *std::min_element(diameters_mm.begin(), diameters_mm.end()) / pitch_mm;
  const int step = std::clamp(static_cast<int>(smallest_px / 7.0), 1, 16);
  const int columns = (image.width + step - 1) / step;
  const int rows = (image.height + step - 1) / step;
  cv::Mat dark(rows, columns, CV_8U);
  for (int j = 0; j < rows; ++j) {
    std::uint8_t* out = dark.ptr<std::uint8_t>(j);
    for (int i = 0; i < columns; ++i) {
      const int c = i * step;
      const int r = j * step;
      out[i] = image.at(c, r) * 10 < background.at(c, r) * 6 ? 255 : 0;
    }
  }
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centroids;
  const int count = cv::connectedComponentsWithStats(dark, labels, stats, centroids, 8, CV_32S);
  std::vector<FoundMark> marks;
  for (int label = 1; label < count; ++label) {
    const double area_px = static_cast<double>(stats.at<int>(label, cv::CC_STAT_AREA)) * step * step;
    const Eigen::Vector2d pixel(centroids.at<double>(label, 0) * step, centroids.at<double>(label, 1) * step);
    const double diameter_px = std::sqrt(4.0 * area_px / kPi);
    const int longest =
        std::max(stats.at<int>(label, cv::CC_STAT_WIDTH), stats.at<int>(label, cv::CC_STAT_HEIGHT)) * step;
    if (longest > 1.7 * diameter_px + 2 * step) continue;
    Eigen::Vector2d p_mm;
    double px_per_mm = 0.0;
    try {
      p_mm = calibration.planeFromPixel(pixel);
      px_per_mm = std::sqrt(std::abs(calibration.localMap(p_mm).pixel_per_mm.determinant()));
    } catch (const std::domain_error&) {
      continue;  // Above the horizon of a wide lens.
    }
    const auto off = [&](double diameter_mm) {
      return std::abs(std::log(diameter_px / (diameter_mm * px_per_mm)));
    };
    const double nearest = *std::min_element(diameters_mm.begin(), diameters_mm.end(),
                                             [&](double a, double b) { return off(a) < off(b); });
    if (off(nearest) > 0.35) continue;
    if (const auto mark = measureMark(image, calibration, p_mm, nearest, 1.5 * step / px_per_mm)) {
      marks.push_back(*mark);
    }
  }
  return marks;
}

}  // namespace kerfbench::hil
