// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/marks/mark_finder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <Eigen/LU>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "hil/vision/marks/mark_look.h"
#include "twin/base/constants.h"
#include "twin/base/image.h"

namespace kerfbench::vision {
namespace {

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
  const std::optional<PixelBox> wide = boxAround(image, map.pixel, half_px);
  if (!wide) return std::nullopt;
  const double box_area = static_cast<double>(wide->right - wide->left + 1) * (wide->bottom - wide->top + 1);
  MarkLevels levels = roughLevels(image, *wide, std::min(0.5, kPi * radius_px * radius_px / box_area));
  const auto enough_contrast = [](const MarkLevels& l) {
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
  MarkLook look{};
  constexpr int kMostRounds = 8;
  for (int round = 0; round < kMostRounds; ++round) {
    const double border = markBorderPx(radius_px) - 2.0;
    if (centre.x() < image.left + border || centre.y() < image.top + border ||
        centre.x() > image.right() - border || centre.y() > image.bottom() - border) {
      return std::nullopt;
    }
    const std::optional<PixelBox> box = boxAround(image, centre, kOuterRim * radius_px + 1.0);
    if (!box) return std::nullopt;
    look = lookAtMark(image, *box, {centre, mm_per_pixel, radius_mm, edge_half_px}, levels, round > 0);
    if (look.stained_share > 0.02 || look.darkened_share > 0.06) return std::nullopt;
    levels = look.levels;
    if (!enough_contrast(levels)) return std::nullopt;
    const Eigen::Vector2d step = look.centroid - centre;
    centre = look.centroid;
    if (round > 0 && step.norm() < 5e-3) break;
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
      const int c = image.left + i * step;
      const int r = image.top + j * step;
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
    const Eigen::Vector2d pixel(image.left + centroids.at<double>(label, 0) * step,
                                image.top + centroids.at<double>(label, 1) * step);
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

}  // namespace kerfbench::vision
