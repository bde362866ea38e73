// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/marks/mark_strokes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "hil/vision/kerf/bright_places.h"
#include "twin/base/image.h"
#include "twin/base/symmetric_eigen.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kMarkedShare = 0.3;  // Least brightness of a stroke between board (0) and open kerf (1).
constexpr int kLeastPixels = 6;       // Least pixels of a stroke; smaller blobs are noise.
/// Largest distance of one stroke in two pictures; lens and table place it within micrometres.
constexpr double kSame_mm = 0.2;

struct Moments {
  double count{};
  Vector2d mean_px{Vector2d::Zero()};
  Matrix2d covariance_px2{Matrix2d::Zero()};
};

Moments momentsOf(const cv::Mat& labels, int label, const cv::Rect& box) {
  double n = 0.0;
  Vector2d sum = Vector2d::Zero();
  Matrix2d squares = Matrix2d::Zero();
  for (int r = box.y; r < box.y + box.height; ++r) {
    const int* row = labels.ptr<int>(r);
    for (int c = box.x; c < box.x + box.width; ++c) {
      if (row[c] != label) continue;
      const Vector2d p(c - box.x, r - box.y);
      n += 1.0;
      sum += p;
      squares += p * p.transpose();
    }
  }
  const Vector2d mean = sum / n;
  // A pixel is a square, no point.
  const Matrix2d covariance = squares / n - mean * mean.transpose() + Matrix2d::Identity() / 12.0;
  return {n, mean + Vector2d(box.x, box.y), covariance};
}

Stroke strokeOf(const Moments& moments, const vision::TileView& view,
                const vision::CameraCalibration& calibration) {
  const Vector2d p_V_mm = calibration.planeFromPixel(moments.mean_px);
  const Matrix2d mm_per_pixel = calibration.localMap(p_V_mm).pixel_per_mm.inverse();
  const SymmetricEigen<2> axes(mm_per_pixel * moments.covariance_px2 * mm_per_pixel.transpose());
  Stroke stroke;
  stroke.p_T_mm = view.tile.p_TV_mm + p_V_mm;
  stroke.half_mm = std::sqrt(3.0 * axes.values[1]) * axes.vectors.col(1);
  stroke.width_mm = std::sqrt(12.0 * std::max(0.0, axes.values[0]));
  stroke.from_middle_mm = (stroke.p_T_mm - view.centre_T_mm).norm();
  return stroke;
}

}  // namespace

std::vector<Stroke> findStrokes(const vision::TileView& view, const vision::CameraCalibration& calibration,
                                double open_gray) {
  GrayImage places = vision::brightPlaces(view, open_gray, kMarkedShare);
  const cv::Mat mask(places.height, places.width, CV_8U, places.pixels.data());
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centroids;
  const int count = cv::connectedComponentsWithStats(mask, labels, stats, centroids, 8, CV_32S);
  std::vector<Stroke> strokes;
  for (int label = 1; label < count; ++label) {
    const cv::Rect box(stats.at<int>(label, cv::CC_STAT_LEFT), stats.at<int>(label, cv::CC_STAT_TOP),
                       stats.at<int>(label, cv::CC_STAT_WIDTH), stats.at<int>(label, cv::CC_STAT_HEIGHT));
    const bool clipped =
        box.x == 0 || box.y == 0 || box.x + box.width == places.width || box.y + box.height == places.height;
    if (clipped || stats.at<int>(label, cv::CC_STAT_AREA) < kLeastPixels) continue;
    try {
      strokes.push_back(strokeOf(momentsOf(labels, label, box), view, calibration));
    } catch (const std::domain_error&) {
      continue;  // Above the horizon of a wide lens.
    }
  }
  return strokes;
}

std::vector<Stroke> uniqueStrokes(const std::vector<Stroke>& strokes) {
  std::vector<Stroke> sorted = strokes;
  std::ranges::sort(sorted, [](const Stroke& a, const Stroke& b) {
    return a.p_T_mm.x() != b.p_T_mm.x() ? a.p_T_mm.x() < b.p_T_mm.x() : a.p_T_mm.y() < b.p_T_mm.y();
  });
  std::vector<Stroke> unique;
  for (const Stroke& stroke : sorted) {
    // Earlier strokes of the same x, which are the last ones of the list.
    auto same = unique.rbegin();
    while (same != unique.rend() && (same->p_T_mm - stroke.p_T_mm).norm() >= kSame_mm &&
           stroke.p_T_mm.x() - same->p_T_mm.x() < kSame_mm)
      ++same;
    const bool seen = same != unique.rend() && (same->p_T_mm - stroke.p_T_mm).norm() < kSame_mm;
    if (!seen) {
      unique.push_back(stroke);
    } else if (stroke.from_middle_mm < same->from_middle_mm) {
      *same = stroke;
    }
  }
  return unique;
}

}  // namespace kerfbench::calibrate
