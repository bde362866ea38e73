// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/calibrate/scanner/scanner_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "hil/calibrate/camera/target_print.h"
#include "hil/calibrate/marks/mark_pattern.h"
#include "twin/base/random.h"

namespace kerfbench::calibrate::test {
namespace {

using Eigen::Vector2d;

/// A kerf or a disc (both ends at one place) that is darker or lighter than the board.
struct Shape {
  Vector2d from_mm, to_mm;
  double radius_mm;
  double gray;

  [[nodiscard]] double distance_mm(const Vector2d& p) const {
    const Vector2d way = to_mm - from_mm;
    const double t =
        way.squaredNorm() > 0.0 ? std::clamp((p - from_mm).dot(way) / way.squaredNorm(), 0.0, 1.0) : 0.0;
    return (p - from_mm - t * way).norm() - radius_mm;
  }
};

/// Share of a pixel on the inner side of an edge at this distance.
double inside(double distance_px, double blur_px) {
  return 0.5 * std::erfc(distance_px / (std::numbers::sqrt2 * blur_px));
}

}  // namespace

Vector2d ScannerModel::glassAt(const Vector2d& pixel) const {
  const double t = 2.0 * pixel.x() / (width_px - 1) - 1.0, v_mm = pitch_mm * pixel.y();
  const double slow = std::sin(2.0 * std::numbers::pi * v_mm / 41.0 + 0.4);
  const double quick = std::sin(2.0 * std::numbers::pi * v_mm / 23.0 + 1.9);
  const Vector2d wobble = wobble_mm * Vector2d(0.6 * slow + 0.25 * quick, 0.7 * quick - 0.5 * slow);
  return {pitch_mm * (scale.x() * pixel.x() + skew_rad * pixel.y()) + wobble.x(),
          -pitch_mm * scale.y() * pixel.y() + bow_mm * t * t + wobble.y()};
}

Vector2d ScannerModel::onSheet(const Vector2d& pixel) const {
  return Eigen::Rotation2Dd(-turn_rad) * (glassAt(pixel) - p_GS_mm);
}

std::uint8_t ScannerModel::shown(double gray, std::size_t pixel) const {
  const double noise = noise_gray * CounterRandom(seed, 7).normal(pixel);
  return static_cast<std::uint8_t>(std::lround(std::clamp(gray + noise, 0.0, 255.0)));
}

GrayImage ScannerModel::sheet(const MarkJob& job, double kerf_mm,
                              const std::function<Vector2d(const Vector2d&)>& head) const {
  std::vector<Shape> shapes;
  for (const RegistrationMark& mark : job.print)
    shapes.push_back({mark.p_SM_mm, mark.p_SM_mm, 0.5 * mark.diameter_mm, ink_gray});
  for (const WantedMark& mark : job.marks) {
    std::vector<MarkStroke> strokes = markTicks(mark.number, job.size_mm);
    for (const MarkStroke& arm : markArms(job.size_mm)) strokes.push_back(arm);
    const Vector2d centre = job.wanted_S_mm(mark);
    for (const MarkStroke& stroke : strokes)
      shapes.push_back({head(centre + stroke.from_mm), head(centre + stroke.to_mm), 0.5 * kerf_mm, lid_gray});
  }
  GrayImage image(width_px, height_px);
  std::vector<double> gray(image.pixels.size(), board_gray);
  const Eigen::Rotation2Dd turn(turn_rad);
  for (const Shape& shape : shapes) {
    // Where it is seen, but for bar and carriage: their tenths of a millimetre are within the border.
    const auto pixelOf = [&](const Vector2d& p_S) -> Vector2d {
      const Vector2d p_G = p_GS_mm + turn * p_S;
      return {p_G.x() / pitch_mm, -p_G.y() / pitch_mm};
    };
    Eigen::AlignedBox2d box(pixelOf(shape.from_mm));
    box.extend(pixelOf(shape.to_mm));
    const int border = static_cast<int>(shape.radius_mm / pitch_mm) + 12;
    for (int row = std::max(0, static_cast<int>(box.min().y()) - border);
         row <= std::min(height_px - 1, static_cast<int>(box.max().y()) + border); ++row) {
      for (int column = std::max(0, static_cast<int>(box.min().x()) - border);
           column <= std::min(width_px - 1, static_cast<int>(box.max().x()) + border); ++column) {
        const double share = inside(shape.distance_mm(onSheet(Vector2d(column, row))) / pitch_mm, blur_px);
        double& at = gray[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_px) +
                          static_cast<std::size_t>(column)];
        at += share * (shape.gray - at);
      }
    }
  }
  for (std::size_t i = 0; i < gray.size(); ++i) image.pixels[i] = shown(gray[i], i);
  return image;
}

GrayImage ScannerModel::target(const CalibrationTarget& target) const {
  constexpr int kOver = 3;
  std::vector<std::vector<std::uint8_t>> cells;
  for (int marker = 0; marker < target.markers(); ++marker) cells.push_back(markerCells(marker));
  const auto grayOf = [&](const Vector2d& p_B) {
    const int column = static_cast<int>(std::floor(p_B.x() / target.square_mm));
    const int row = static_cast<int>(std::floor(p_B.y() / target.square_mm));
    if (column < 0 || row < 0 || column >= target.columns || row >= target.rows) return 235.0;
    if ((column + row) % 2 == 0) return 20.0;
    const Vector2d in_marker = p_B - target.square_mm * Vector2d(column + 0.5, row + 0.5) +
                               Vector2d::Constant(0.5 * target.marker_mm);
    const double cell_mm = target.marker_mm / CalibrationTarget::kMarkerCells;
    const int i = static_cast<int>(std::floor(in_marker.x() / cell_mm)),
              j = static_cast<int>(std::floor(in_marker.y() / cell_mm));
    if (i < 0 || j < 0 || i >= CalibrationTarget::kMarkerCells || j >= CalibrationTarget::kMarkerCells)
      return 235.0;
    const auto& marker = cells.at(static_cast<std::size_t>(target.markerIn(column, row)));
    return marker.at(static_cast<std::size_t>(j * CalibrationTarget::kMarkerCells + i)) != 0 ? 235.0 : 20.0;
  };
  GrayImage image(width_px, height_px);
  const Vector2d half = 0.5 * target.size_mm();
  for (int row = 0; row < height_px; ++row) {
    for (int column = 0; column < width_px; ++column) {
      double sum = 0.0;
      for (int k = 0; k < kOver * kOver; ++k) {
        const Vector2d part((k % kOver + 0.5) / kOver - 0.5, (k / kOver + 0.5) / kOver - 0.5);
        // The samples reach over their pixel's rim: the optics' blur.
        const Vector2d p_S = onSheet(Vector2d(column, row) + 1.6 * part);
        sum += grayOf({p_S.x() + half.x(), half.y() - p_S.y()});
      }
      image.at(column, row) =
          shown(sum / (kOver * kOver), static_cast<std::size_t>(row) * static_cast<std::size_t>(width_px) +
                                           static_cast<std::size_t>(column));
    }
  }
  return image;
}

}  // namespace kerfbench::calibrate::test
