// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/spot/spot_windows.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace kerfbench::vision {
namespace {

/// How far the spot may lie from where the pins lead it: an uncalibrated head, a lag of the axes.
constexpr double kAimMm = 2.0;
/// Board around the spot, px: what its fit and the noise of the board are taken from.
constexpr double kBoardPx = 24.0;
/// Path of a mark across the belt from what the search before has seen.
constexpr double kWanderMm = 1.0;
constexpr double kRoundingPx = 2.0;

PixelWindow windowOf(const Eigen::AlignedBox2d& box_px) {
  const int left = static_cast<int>(std::floor(box_px.min().x()));
  const int top = static_cast<int>(std::floor(box_px.min().y()));
  return {left, top, static_cast<int>(std::ceil(box_px.max().x())) - left + 1,
          static_cast<int>(std::ceil(box_px.max().y())) - top + 1};
}

PixelWindow wholeOf(const CameraCalibration& calibration) {
  return {0, 0, calibration.width_px, calibration.height_px};
}

/// Row in which a place so far across the belt is seen, in a column of the picture; beyond it, roughly.
double rowOf(const CameraCalibration& calibration, double across_mm, double column) {
  const double height = calibration.height_px;
  Eigen::Vector2d pixel(column, 0.5 * height);
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d p_mm = calibration.planeFromPixel(pixel);
    const Eigen::Matrix2d mm_per_pixel = calibration.localMap(p_mm).pixel_per_mm.inverse();
    pixel.y() = std::clamp(pixel.y() + (across_mm - p_mm.y()) / mm_per_pixel(1, 1), -height, 2.0 * height);
  }
  return pixel.y();
}

}  // namespace

PixelWindow spotWindow(const CameraCalibration& calibration, const Eigen::AlignedBox2d& box_W_mm) {
  Eigen::AlignedBox2d box_px;
  for (const auto corner : {Eigen::AlignedBox2d::BottomLeft, Eigen::AlignedBox2d::BottomRight,
                            Eigen::AlignedBox2d::TopLeft, Eigen::AlignedBox2d::TopRight}) {
    try {
      box_px.extend(calibration.pixelFromPlane(box_W_mm.corner(corner)));
    } catch (const std::domain_error&) {
      return {};
    }
  }
  const double around_px = std::max(kBoardPx, kAimMm / calibration.pitchMm() + kRoundingPx);
  box_px.min().array() -= around_px;
  box_px.max().array() += around_px;
  const PixelWindow window = windowOf(box_px).within(wholeOf(calibration));
  return window.empty() ? PixelWindow{} : window;
}

std::vector<PixelWindow> markWindows(const CameraCalibration& calibration,
                                     std::span<const SheetTracker::MarkPlace> places) {
  std::vector<PixelWindow> windows;
  for (const SheetTracker::MarkPlace& place : places) {
    const Eigen::Vector2d pixel = calibration.pixelFromPlane(place.p_mm);
    // measureMark() looks no farther.
    const double reach_px = markBorderPx(0.55 * place.diameter_mm / calibration.pitchMm()) +
                            1.1 * place.search_mm / calibration.pitchMm();
    const Eigen::AlignedBox2d box_px(pixel.array() - reach_px, pixel.array() + reach_px);
    windows.push_back(windowOf(box_px).within(wholeOf(calibration)));
  }
  return windows;
}

std::vector<PixelWindow> markBands(const CameraCalibration& calibration,
                                   std::span<const SheetTracker::MarkPlace> places) {
  const PixelWindow whole = wholeOf(calibration);
  std::vector<PixelWindow> bands;
  for (const SheetTracker::MarkPlace& place : places) {
    const double reach_px = markBorderPx(0.55 * place.diameter_mm / calibration.pitchMm()) +
                            (kWanderMm + place.search_mm) / calibration.pitchMm();
    Eigen::AlignedBox2d box_px;
    try {
      for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        const double column = share * whole.right();
        const double row = rowOf(calibration, place.p_mm.y(), column);
        box_px.extend(Eigen::Vector2d(column, row - reach_px));
        box_px.extend(Eigen::Vector2d(column, row + reach_px));
      }
    } catch (const std::domain_error&) {
      continue;  // Beyond what the lens shows.
    }
    const PixelWindow band = windowOf(box_px).within(whole);
    if (!band.empty()) bands.push_back(band);
  }
  std::ranges::sort(bands, {}, &PixelWindow::top);
  std::vector<PixelWindow> merged;
  for (const PixelWindow& band : bands) {
    if (merged.empty() || band.top > merged.back().bottom()) {
      merged.push_back(band);
    } else {
      merged.back().height = std::max(merged.back().bottom(), band.bottom()) - merged.back().top + 1;
    }
  }
  return merged;
}

}  // namespace kerfbench::vision
