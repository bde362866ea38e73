// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/scanner/scan_discs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "twin/base/image.h"

namespace kerfbench::calibrate {
namespace {

constexpr double kDarkShare = 0.5;
constexpr double kMostAspect = 1.25;
constexpr double kLeastFill = 0.9, kMostFill = 1.1;  // Area over that of the ellipse in its box.

std::uint8_t medianOfMiddle(const GrayImage& scan) {
  std::array<std::size_t, 256> histogram{};
  std::size_t count = 0;
  for (int row = scan.height / 4; row < 3 * scan.height / 4; row += 2) {
    for (int column = scan.width / 4; column < 3 * scan.width / 4; column += 2, ++count)
      ++histogram[scan.at(column, row)];
  }
  std::size_t below = 0;
  for (std::size_t gray = 0; gray < histogram.size(); ++gray) {
    below += histogram[gray];
    if (2 * below >= count) return static_cast<std::uint8_t>(gray);
  }
  return 255;
}

}  // namespace

std::vector<ScanDisc> findScanDiscs(const GrayImage& scan, double least_radius_px, double most_radius_px) {
  const cv::Mat picture(scan.height, scan.width, CV_8U, const_cast<std::uint8_t*>(scan.pixels.data()));
  cv::Mat dark, labels, stats, centroids;
  cv::compare(picture, kDarkShare * medianOfMiddle(scan), dark, cv::CMP_LT);
  const int count = cv::connectedComponentsWithStats(dark, labels, stats, centroids, 8);
  std::vector<ScanDisc> discs;
  for (int label = 1; label < count; ++label) {
    const double width = stats.at<int>(label, cv::CC_STAT_WIDTH),
                 height = stats.at<int>(label, cv::CC_STAT_HEIGHT);
    const double area = stats.at<int>(label, cv::CC_STAT_AREA);
    const double radius = std::sqrt(area / std::numbers::pi);
    if (radius < least_radius_px || radius > most_radius_px) continue;
    const double fill = area / (0.25 * std::numbers::pi * width * height);
    if (std::max(width, height) > kMostAspect * std::min(width, height) || fill < kLeastFill ||
        fill > kMostFill)
      continue;
    discs.push_back({{centroids.at<double>(label, 0), centroids.at<double>(label, 1)}, radius});
  }
  return discs;
}

ScanLevels levelsAt(const GrayImage& scan, const std::vector<ScanDisc>& discs) {
  double ink = 0.0, board = 0.0;
  int inside = 0, around = 0;
  for (const ScanDisc& disc : discs) {
    const int reach = static_cast<int>(std::ceil(1.8 * disc.radius_px));
    const int column0 = static_cast<int>(std::lround(disc.pixel.x())),
              row0 = static_cast<int>(std::lround(disc.pixel.y()));
    for (int row = std::max(0, row0 - reach); row <= std::min(scan.height - 1, row0 + reach); ++row) {
      for (int column = std::max(0, column0 - reach); column <= std::min(scan.width - 1, column0 + reach);
           ++column) {
        const double share = (Eigen::Vector2d(column, row) - disc.pixel).norm() / disc.radius_px;
        if (share < 0.7) {
          ink += scan.at(column, row);
          ++inside;
        } else if (share > 1.4 && share < 1.8) {
          board += scan.at(column, row);
          ++around;
        }
      }
    }
  }
  return {board / std::max(1, around), ink / std::max(1, inside)};
}

}  // namespace kerfbench::calibrate
