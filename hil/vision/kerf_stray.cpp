// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf_stray.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace kerfbench::hil {
namespace {

constexpr double kOffDielineMm = 0.35;
constexpr double kStrayContrast = 0.035;  // of board to open kerf
constexpr double kNoiseSigmas = 3.0;      // of one pixel: nine of a mean of nine, where no grain binds them
constexpr double kTouchMm = 0.15;
constexpr int kShiftBits = 4;  // OpenCV draws in 1/16 px

/// Paints the dieline out of a mask.
void eraseDieline(cv::Mat& mask, const TileView& view, const CameraCalibration& calibration,
                  const PlaneMotion& X_TS, const std::vector<EntityPlan>& plans) {
  const double px_per_mm = 1.0 / calibration.pitchMm();
  const int thickness = static_cast<int>(std::lround(2.0 * kOffDielineMm * px_per_mm));
  for (const EntityPlan& plan : plans) {
    std::vector<cv::Point> line;
    const auto draw = [&] {
      if (line.size() > 1) {
        cv::polylines(mask, std::vector<std::vector<cv::Point>>{line}, false, cv::Scalar(0), thickness,
                      cv::LINE_8, kShiftBits);
      }
      line.clear();
    };
    for (const Station& station : plan.stations) {
      const Eigen::Vector2d p_V_mm = X_TS * station.p_S_mm - view.tile.p_TV_mm;
      const auto pixel = calibration.pixelIfSeen(p_V_mm, -2.0 * thickness - 20.0);
      if (!pixel) {
        draw();
        continue;
      }
      line.emplace_back(static_cast<int>(std::lround(pixel->x() * (1 << kShiftBits))),
                        static_cast<int>(std::lround(pixel->y() * (1 << kShiftBits))));
    }
    draw();
  }
}

/// What is brighter than the board of its surroundings. The mean of nine pixels finds a cut that is thinner
/// than a pixel, or not through.
cv::Mat brightPlaces(const cv::Mat& picture, const TileView& view, double open_gray) {
  constexpr int kCell = Background::kCellPx;
  cv::Mat smooth;
  cv::boxFilter(picture, smooth, CV_8U, cv::Size(3, 3), cv::Point(-1, -1), true, cv::BORDER_REPLICATE);
  cv::Mat mask(picture.size(), CV_8U);
  for (int top = 0; top < picture.rows; top += kCell) {
    for (int left = 0; left < picture.cols; left += kCell) {
      const cv::Rect cell(left, top, std::min(kCell, picture.cols - left),
                          std::min(kCell, picture.rows - top));
      const double board = view.background->at(left, top);
      const Eigen::Vector2d middle(left + 0.5 * cell.width, top + 0.5 * cell.height);
      const double open = open_gray * view.light.at(middle);
      const double above = std::max(kNoiseSigmas * view.noise_gray, kStrayContrast * (open - board));
      cv::Mat part = mask(cell);
      cv::threshold(smooth(cell), part, board + above, 255, cv::THRESH_BINARY);
    }
  }
  return mask;
}

}  // namespace

std::vector<StrayBox> findStrays(const TileView& view, std::size_t tile, const CameraCalibration& calibration,
                                 const PlaneMotion& X_TS, const std::vector<EntityPlan>& plans,
                                 double open_gray) {
  const GrayImage& image = view.tile.image;
  // Only read: OpenCV has no view of constant memory.
  const cv::Mat picture(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  cv::Mat mask = brightPlaces(picture, view, open_gray);
  eraseDieline(mask, view, calibration, X_TS, plans);
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_SIMPLE);
  std::vector<StrayBox> boxes;
  for (const auto& contour : contours) {
    if (contour.size() < 2) continue;
    StrayBox found;
    found.tile = tile;
    std::vector<Eigen::Vector2d> pixels;
    for (const cv::Point& p : contour) pixels.emplace_back(p.x, p.y);
    std::vector<Eigen::Vector2d> plane(pixels.size());
    calibration.planeFromPixels(pixels, plane);
    for (const Eigen::Vector2d& p_V_mm : plane)
      found.box_S_mm.extend(X_TS.inverse(view.tile.p_TV_mm + p_V_mm));
    boxes.push_back(found);
  }
  return boxes;
}

std::vector<StrayCut> mergeStrays(std::vector<StrayBox> boxes, int unit, double least_mm) {
  for (bool merged = true; merged;) {
    merged = false;
    for (std::size_t i = 0; i < boxes.size() && !merged; ++i) {
      for (std::size_t j = i + 1; j < boxes.size() && !merged; ++j) {
        if (boxes[i].tile == boxes[j].tile) continue;
        if (boxes[i].box_S_mm.exteriorDistance(boxes[j].box_S_mm) > kTouchMm) continue;
        boxes[i].box_S_mm.extend(boxes[j].box_S_mm);
        boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(j));
        merged = true;
      }
    }
  }
  std::vector<StrayCut> strays;
  for (const StrayBox& b : boxes) {
    const double extent_mm = b.box_S_mm.sizes().maxCoeff();
    if (extent_mm >= least_mm) strays.push_back({unit, b.box_S_mm.center(), extent_mm});
  }
  std::sort(strays.begin(), strays.end(), [](const StrayCut& a, const StrayCut& b) {
    return a.p_S_mm.x() != b.p_S_mm.x() ? a.p_S_mm.x() < b.p_S_mm.x() : a.p_S_mm.y() < b.p_S_mm.y();
  });
  return strays;
}

}  // namespace kerfbench::hil
