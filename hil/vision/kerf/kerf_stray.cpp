// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/kerf/kerf_stray.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "hil/vision/kerf/bright_places.h"
#include "twin/base/image.h"

namespace kerfbench::vision {
namespace {

constexpr double kOffDielineMm = 0.35;
constexpr double kStrayContrast = 0.035;  // Least contrast of a stray cut over that of board and open kerf.
constexpr double kTouchMm = 0.15;
constexpr int kShiftBits = 4;  // Fraction bits of the coordinates in which OpenCV draws: 1/16 px.

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

}  // namespace

std::vector<StrayBox> findStrays(const TileView& view, std::size_t tile, const CameraCalibration& calibration,
                                 const PlaneMotion& X_TS, const std::vector<EntityPlan>& plans,
                                 double open_gray) {
  GrayImage places = brightPlaces(view, open_gray, kStrayContrast);
  cv::Mat mask(places.height, places.width, CV_8U, places.pixels.data());
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

}  // namespace kerfbench::vision
