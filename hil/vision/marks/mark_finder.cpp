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

bool enoughContrast(const MarkLevels& l) { return l.contrast() > std::max(8.0, 0.35 * l.board); }

/// Where a disc may be, and from which levels on it is looked at.
struct Start {
  Eigen::Vector2d centre;
  MarkLevels levels;
  bool known;  ///< Known by the picture before, so that the first look may be the only one.
};

/// One disc in one picture.
class DiscSearch {
 public:
  DiscSearch(const GrayImage& image, const LocalPixelMap& map, double radius_mm, double search_mm)
      : image_(image),
        place_(map.pixel),
        mm_per_pixel_(map.pixel_per_mm.inverse()),
        radius_mm_(radius_mm),
        radius_px_(radius_mm * map.pxPerMm()),
        search_px_(search_mm * map.pxPerMm()) {}

  /// Centroid of what is dark about the place.
  [[nodiscard]] std::optional<Start> search() const {
    const std::optional<PixelBox> wide = boxAround(image_, place_, kOuterRim * radius_px_ + search_px_ + 2.0);
    if (!wide) return std::nullopt;
    const double area = static_cast<double>(wide->right - wide->left + 1) * (wide->bottom - wide->top + 1);
    Start start{place_, roughLevels(image_, *wide, std::min(0.5, kPi * radius_px_ * radius_px_ / area)),
                false};
    if (!enoughContrast(start.levels)) return std::nullopt;
    const double middle_gray = 0.5 * (start.levels.board + start.levels.ink);
    double within = radius_px_ + search_px_ + 2.0;
    for (int round = 0; round < 2; ++round) {
      const std::optional<Eigen::Vector2d> dark =
          darkCentroid(image_, *wide, start.centre, within, middle_gray);
      if (!dark) return std::nullopt;
      start.centre = *dark;
      within = 1.35 * radius_px_;
    }
    return start;
  }

  /// Looks again and again, each time from where the disc was found to be.
  [[nodiscard]] std::optional<MarkLook> lookFrom(const Start& start) const {
    // The edge's pixels are weighed by where they lie to the circle: a circle that is off by so little weighs
    // all of them, and levels that are off by so little weigh both sides of it alike.
    constexpr double kNearPx = 0.02;
    constexpr double kSettledPx = 5e-3;
    constexpr int kMostRounds = 8;
    const double edge_half_px = std::clamp(0.06 * radius_px_, 2.5, 0.2 * radius_px_ + 2.0);
    Eigen::Vector2d centre = start.centre;
    MarkLevels levels = start.levels;
    MarkLook look{};
    for (int round = 0; round < kMostRounds; ++round) {
      if (!hasRoomAround(centre)) return std::nullopt;
      const std::optional<PixelBox> box = boxAround(image_, centre, kOuterRim * radius_px_ + 1.0);
      if (!box) return std::nullopt;
      const bool first = round == 0;
      look = lookAtMark(image_, *box, {centre, mm_per_pixel_, radius_mm_, edge_half_px}, levels,
                        !first || start.known);
      if (look.stained_share > 0.02 || look.darkened_share > 0.06) return std::nullopt;
      if (!enoughContrast(look.levels)) return std::nullopt;
      const double step_px = (look.centroid - centre).norm();
      if (first && start.known && !isAsKnown(look, levels, step_px)) return std::nullopt;
      centre = look.centroid;
      // Levels of many pictures have less noise than those of this one.
      if (!(levels.pictures > 1.0)) levels = look.levels;
      if (first ? start.known && step_px < kNearPx : step_px < kSettledPx) break;
    }
    const double area_ratio = look.area_px / (kPi * radius_px_ * radius_px_);
    if (std::abs(area_ratio - 1.0) > 0.15) return std::nullopt;
    if (look.worst_sector_px > std::max(0.25, 0.02 * radius_px_)) return std::nullopt;
    return look;
  }

 private:
  /// Where the levels are others than what they were, the look has taken board for something else.
  static bool isAsKnown(const MarkLook& look, const MarkLevels& known, double step_px) {
    constexpr double kNearLevels = 0.03;
    constexpr double kMostPx = 1.0;
    constexpr double kLeastBoard = 0.9;
    const double changed =
        std::max(std::abs(look.levels.board - known.board), std::abs(look.levels.ink - known.ink));
    return step_px < kMostPx && look.board_share > kLeastBoard && changed < kNearLevels * known.contrast();
  }

  [[nodiscard]] bool hasRoomAround(const Eigen::Vector2d& centre) const {
    const double border = markBorderPx(radius_px_) - 2.0;
    return centre.x() >= image_.left + border && centre.y() >= image_.top + border &&
           centre.x() <= image_.right() - border && centre.y() <= image_.bottom() - border;
  }

  const GrayImage& image_;
  Eigen::Vector2d place_;
  Eigen::Matrix2d mm_per_pixel_;
  double radius_mm_, radius_px_, search_px_;
};

}  // namespace

double markBorderPx(double radius_px) { return kOuterRim * radius_px + 3.0; }

std::optional<FoundMark> measureMark(const GrayImage& image, const CameraCalibration& calibration,
                                     const Eigen::Vector2d& near_mm, double diameter_mm, double search_mm,
                                     const std::optional<MarkLevels>& known) {
  const LocalPixelMap map = calibration.localMap(near_mm);
  const double radius_mm = 0.5 * diameter_mm;
  const DiscSearch disc(image, map, radius_mm, search_mm);
  std::optional<MarkLook> look;
  if (known) look = disc.lookFrom({map.pixel, *known, true});
  if (!look) {
    const std::optional<Start> start = disc.search();
    if (start) look = disc.lookFrom(*start);
  }
  if (!look) return std::nullopt;

  FoundMark found;
  found.pixel = look->centroid;
  found.diameter_mm = diameter_mm;
  found.levels = look->levels;
  found.sigma_mm = look->sigma_px / map.pxPerMm();
  found.p_mm = centreFromCentroid(calibration, look->centroid, radius_mm);
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
      px_per_mm = calibration.localMap(p_mm).pxPerMm();
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
