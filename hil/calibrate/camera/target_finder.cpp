// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/camera/target_finder.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "hil/calibrate/camera/corner_fit.h"
#include "hil/calibrate/camera/picture_check.h"
#include "twin/base/image.h"
#include "twin/base/statistics.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;
constexpr int kLeastRadius_px = 4;
constexpr int kMostRadius_px = 12;
constexpr double kLeastSquareContrast = 30.0;

using Quad = std::vector<cv::Point2f>;

cv::Mat matOf(const GrayImage& image) {
  return {image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data())};
}

/// Corners of each marker of the target, clockwise from its upper left as printed.
std::map<int, Quad> findMarkers(const cv::Mat& picture, const CalibrationTarget& target) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_1000);
  const auto parameters = cv::aruco::DetectorParameters::create();
  const int side = std::max(picture.cols, picture.rows);
  // A marker is read down to some 14 px a side; the default asks for a share of the picture.
  parameters->minMarkerPerimeterRate = std::min(0.03, 50.0 / side);
  parameters->minMarkerDistanceRate = 0.01;
  parameters->adaptiveThreshWinSizeMin = 13;
  parameters->adaptiveThreshWinSizeMax = 53;
  parameters->adaptiveThreshWinSizeStep = 20;
  std::vector<Quad> quads;
  std::vector<int> ids;
  cv::aruco::detectMarkers(picture, dictionary, quads, ids, parameters);
  std::map<int, Quad> markers;
  std::map<int, int> times;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] >= target.markers()) continue;
    ++times[ids[i]];
    markers[ids[i]] = quads[i];
  }
  std::erase_if(markers, [&](const auto& marker) { return times.at(marker.first) > 1; });
  return markers;
}

struct Prediction {
  TargetCorner corner;
  Vector2d along_x, along_y;  ///< Picture of one square's sides there.
};

/// Corner by the homography of the nearest markers.
std::optional<Prediction> predict(int column, int row, const std::map<int, Quad>& markers,
                                  const CalibrationTarget& target) {
  std::vector<cv::Point2f> board;
  std::vector<cv::Point2f> picture;
  const double side = target.marker_mm / target.square_mm;
  const double border = 0.5 * (1.0 - side);
  for (const int r : {row - 1, row}) {
    for (const int c : {column - 1, column}) {
      const int id = target.markerIn(c, r);
      const auto found = id < 0 ? markers.end() : markers.find(id);
      if (found == markers.end()) continue;
      // In squares from the corner.
      const double left = c - column + border;
      const double top = r - row + border;
      for (const auto& [x, y] : {std::pair(left, top), std::pair(left + side, top),
                                 std::pair(left + side, top + side), std::pair(left, top + side)})
        board.emplace_back(static_cast<float>(x), static_cast<float>(y));
      picture.insert(picture.end(), found->second.begin(), found->second.end());
    }
  }
  if (board.empty()) return std::nullopt;
  const cv::Mat h = cv::findHomography(board, picture);
  if (h.empty()) return std::nullopt;
  const auto at = [&h](double x, double y) {
    const double w = h.at<double>(2, 0) * x + h.at<double>(2, 1) * y + h.at<double>(2, 2);
    return Vector2d((h.at<double>(0, 0) * x + h.at<double>(0, 1) * y + h.at<double>(0, 2)) / w,
                    (h.at<double>(1, 0) * x + h.at<double>(1, 1) * y + h.at<double>(1, 2)) / w);
  };
  Prediction prediction;
  prediction.corner = {column, row, at(0.0, 0.0)};
  prediction.along_x = at(0.5, 0.0) - at(-0.5, 0.0);
  prediction.along_y = at(0.0, 0.5) - at(0.0, -0.5);
  const bool sound =
      prediction.corner.pixel.allFinite() && prediction.along_x.allFinite() && prediction.along_y.allFinite();
  return sound ? std::optional(prediction) : std::nullopt;
}

/// How far a window may reach before it meets a marker: its nearest edge lies this far from the edges that
/// cross in the corner.
int radiusFor(const Prediction& p, const CalibrationTarget& target) {
  const double cross = std::abs(p.along_x.x() * p.along_y.y() - p.along_x.y() * p.along_y.x());
  const double height_px = cross / std::max(p.along_x.norm(), p.along_y.norm());
  const double border = 0.5 * (1.0 - target.marker_mm / target.square_mm);
  // The nearest point of the marker is its corner, `border` along both sides: sqrt(2) as far, in a square.
  const double free_px =
      std::min((border * (p.along_x + p.along_y)).norm(), (border * (p.along_x - p.along_y)).norm());
  // Margin of three pixels for the blur. Edges of other squares lie farther away than any marker.
  return std::min(kMostRadius_px, static_cast<int>(std::floor(std::min(free_px, 0.8 * height_px) - 3.0)));
}

/// Refinement of the predicted corners, accurate enough to start the fit.
void sharpen(const cv::Mat& picture, std::vector<Prediction>& predictions) {
  for (Prediction& p : predictions) {
    std::vector<cv::Point2f> point{
        {static_cast<float>(p.corner.pixel.x()), static_cast<float>(p.corner.pixel.y())}};
    cv::cornerSubPix(picture, point, {4, 4}, {-1, -1},
                     cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 30, 0.01));
    const Vector2d refined(point[0].x, point[0].y);
    if ((refined - p.corner.pixel).norm() < 4.0) p.corner.pixel = refined;
  }
}

}  // namespace

TargetView findTarget(const GrayImage& image, const CalibrationTarget& target) {
  TargetView view;
  view.fault = pictureFault(image);
  if (!view.fault.empty()) return view;
  const cv::Mat picture = matOf(image);
  const std::map<int, Quad> markers = findMarkers(picture, target);
  view.markers = static_cast<int>(markers.size());

  std::vector<Prediction> predictions;
  std::vector<int> radii;
  for (int row = 1; row < target.rows; ++row) {
    for (int column = 1; column < target.columns; ++column) {
      const std::optional<Prediction> p = predict(column, row, markers, target);
      if (!p) continue;
      const int radius = radiusFor(*p, target);
      const Vector2d& at = p->corner.pixel;
      if (radius < kLeastRadius_px || at.x() < radius + 2 || at.y() < radius + 2 ||
          at.x() > image.width - radius - 3 || at.y() > image.height - radius - 3)
        continue;
      predictions.push_back(*p);
      radii.push_back(radius);
    }
  }
  sharpen(picture, predictions);
  std::vector<double> blurs;
  std::vector<double> contrasts;
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    const Prediction& p = predictions[i];
    const auto fit = fitCorner(image, {p.corner.pixel, p.along_x, p.along_y, radii[i]});
    if (!fit) continue;
    view.corners.push_back({p.corner.column, p.corner.row, fit->pixel, fit->covariance_px2});
    blurs.push_back(fit->blur_px);
    contrasts.push_back(fit->contrast);
  }
  if (!blurs.empty()) {
    view.blur_px = upperMedianOf(blurs);
    view.contrast = upperMedianOf(contrasts);
  }
  if (static_cast<int>(view.corners.size()) < kLeastCorners) {
    view.fault = fmt::format("the target is not found: {} of its {} markers, {} corners, at least {}",
                             view.markers, target.markers(), view.corners.size(), kLeastCorners);
  } else if (view.blur_px > kMostBlur_px) {
    view.fault =
        fmt::format("blurred: its edges are {:.1f} px wide (sigma), at most {}", view.blur_px, kMostBlur_px);
  } else if (view.contrast < kLeastSquareContrast) {
    view.fault = fmt::format("dim: black and white differ by {:.0f} grey levels, at least {}", view.contrast,
                             kLeastSquareContrast);
  }
  return view;
}

}  // namespace kerfbench::calibrate
